#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace ink::bench {

struct NamedScene {
    std::string name;
    std::vector<Object> objects;
};

/// Spheres at random places of a cube, of one size, such that they fill a fifth of it.
NamedScene random_spheres(std::size_t count);

/// Boxes at random places of a cube, each of its own shape and shear, as particles under their
/// deformation gradients are.
NamedScene random_boxes(std::size_t count);

/// Spheres, boxes, ellipsoids, cylinders, cones, discs, hexahedra and a mesh in one place.
NamedScene mixed_shapes();

/// A sphere with bumps, of 20 * 4^`levels` triangles, with smooth normals.
NamedScene bumpy_sphere(int levels);

}  // namespace ink::bench

#pragma once

#include <cstddef>
#include <vector>

#include "base/image.h"
#include "base/lanes.h"
#include "base/vec.h"
#include "scene/ids.h"

namespace ink {

/// Samples at the nodes of a regular grid on the screen, plane by plane: what ridges are found
/// from. Not initialised: threads write disjoint parts of it.
struct RidgeGrid {
    RidgeGrid(int columns, int rows, Vec2f first_node, float node_spacing)
        : width(columns), height(rows), first(first_node), spacing(node_spacing) {
        // Loops over a row may read a vector beyond its end.
        const auto size =
            static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + kLanes;
        id.resize(size);
        for (auto* plane : {&px, &py, &pz, &nx, &ny, &nz, &t}) plane->resize(size);
    }

    template <class T>
    using Plane = std::vector<T, UninitializedAllocator<T>>;

    int width, height;
    Vec2f first;    ///< where node (0, 0) is, pixels
    float spacing;  ///< pixels

    Plane<GeometryId> id;     ///< kBackground also for what shall have no ridges
    Plane<float> px, py, pz;  ///< position, scene frame; of no meaning on the background
    Plane<float> nx, ny, nz;  ///< shading normal, unit, likewise
    Plane<float> t;           ///< distance along the ray, likewise

    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(i);
    }
    Vec2f point(int i, int j) const {
        return {first.x + static_cast<float>(i) * spacing,
                first.y + static_cast<float>(j) * spacing};
    }
};

}  // namespace ink

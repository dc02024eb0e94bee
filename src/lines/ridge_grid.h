#pragma once

#include <array>
#include <cstddef>
#include <span>

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
        const std::array planes{&nx, &ny, &nz, &t};
        values_.resize(planes.size() * size);
        for (std::size_t k = 0; k < planes.size(); ++k) {
            *planes[k] = std::span(values_).subspan(k * size, size);
        }
    }
    RidgeGrid(RidgeGrid&&) = default;

    int width, height;
    Vec2f first;    ///< where node (0, 0) is, pixels
    float spacing;  ///< pixels

    Plane<GeometryId> id;         ///< kBackground also for what shall have no ridges
    std::span<float> nx, ny, nz;  ///< shading normal, unit; of no meaning on the background
    std::span<float> t;           ///< distance along the ray, likewise

    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(i);
    }
    Vec2f point(int i, int j) const {
        return {first.x + static_cast<float>(i) * spacing,
                first.y + static_cast<float>(j) * spacing};
    }

  private:
    Plane<float> values_;  ///< of all planes
};

}  // namespace ink

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/lanes.h"
#include "base/vec.h"

namespace ink {

/// For each of 4 x 4 pixels, the nearest edge of the face that it sees.
struct NearestEdges {
    Lanes<float> distance;  ///< from the pixel's centre, pixels; infinite where there is none
    Lanes<float> nx, ny;    ///< unit, across the edge
    Lanes<float> t;         ///< of the edge's middle, distance along the ray
    Lanes<std::uint32_t> triangle;  ///< that the pixel sees: see FaceMap
};

/// An edge on the screen: start, unit direction and length, pixels.
struct ScreenEdge {
    Vec2f a, along;
    float length;
    float t;  ///< of its middle, distance along the ray
};

/// One of the edges of the face that has triangles `begin` to `end` - 1.
struct FaceEdge {
    ScreenEdge edge;
    std::uint32_t begin, end;
};

/// The values among sixteen, but `none`, each once and in the order in which they come first.
/// Returns how many.
std::size_t find_distinct(const Lanes<std::uint32_t>& values, std::uint32_t none,
                          Lanes<std::uint32_t>& distinct);

/// From the centres of 4 x 4 pixels, the upper left one's at (x, y), to the nearest of those edges
/// that bound the face which has the pixel's triangle, up to `reach`: all of `nearest` but its
/// triangles, by which faces are told, and the vectors from the nearest points of the edges.
void find_nearest(std::span<const FaceEdge> edges, float x, float y, float reach,
                  NearestEdges& nearest, Lanes<float>& vx, Lanes<float>& vy);

}  // namespace ink

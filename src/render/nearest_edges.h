#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/lanes.h"
#include "base/vec.h"
#include "lines/ink.h"

namespace ink {

/// For each of 4 x 4 pixels, the nearest edge of the face that it sees.
struct NearestEdges : NearestLines {
    Lanes<std::uint32_t> triangle;  ///< that the pixel sees: see FaceMap
};

/// An edge on the screen: start, unit direction and length, pixels.
struct ScreenEdge {
    Vec2f a, along;
    float length;
    float t;  ///< of its middle, distance along the ray
};

/// A face that has triangles `begin` to `end` - 1, and its edges among those of many.
struct SeenFace {
    std::uint32_t begin, end;
    std::uint32_t first, count;
};

/// A bit for each of 4 x 4 values that is neither `none` nor equal to the one before it in its row
/// or column. So every value has a bit where it comes first, and few have another.
std::uint32_t find_starts(const Lanes<std::uint32_t>& values, std::uint32_t none);

/// How many of 4 x 4 points see another primitive of their object than the next one in their row
/// and the next one in their column.
int count_changes(const Lanes<std::uint32_t>& objects, const Lanes<std::uint32_t>& primitives);

/// From the centres of 4 x 4 pixels, the upper left one's at (x, y), to the nearest edge of that
/// one of the faces which has the pixel's triangle, up to `reach`: all of `nearest` but its
/// triangles, by which faces are told, and the vectors from the nearest points of the edges.
void find_nearest(std::span<const ScreenEdge> edges, std::span<const SeenFace> faces, float x,
                  float y, float reach, NearestEdges& nearest, Lanes<float>& vx, Lanes<float>& vy);

}  // namespace ink

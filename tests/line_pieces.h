#pragma once

#include <cstddef>
#include <vector>

#include "lines/bridges.h"
#include "lines/segment.h"

/// Straight lines as the lattice cuts them.
namespace ink::test {

/// A straight line in pieces from cell to cell.
inline std::vector<Segment> straight(Vec2f a, Vec2f b, LineType type = LineType::crease) {
    const std::vector<Vec2f> points = plane::cut_by_cells(a, b, 1.0F);
    std::vector<Segment> line;
    for (std::size_t n = 1; n < points.size(); ++n) {
        Segment piece;
        piece.a = points[n - 1];
        piece.b = points[n];
        piece.type = piece.type_at_b = type;
        piece.left = piece.right = piece.owner = 1;
        piece.spans_cell = true;
        line.push_back(piece);
    }
    return line;
}

inline std::vector<Segment> operator+(std::vector<Segment> a, const std::vector<Segment>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

inline std::vector<Segment> fold(Vec2f a, Vec2f b) {
    return straight(a, b, LineType::self_occlusion);
}

}  // namespace ink::test

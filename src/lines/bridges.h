#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lines/segment_squares.h"

/// What pieces that join lines have in common.
namespace ink::plane {

/// A cubic from `a` to `b` that leaves both as they point, in steps of about the lattice's spacing;
/// without its first point.
inline std::vector<Vec2f> curve_between(Vec2f a, Vec2f way_a, Vec2f b, Vec2f way_b, float spacing) {
    const float apart = length(b - a);
    const int steps = std::max(static_cast<int>(apart / spacing), 1);
    const Vec2f p = a + way_a * (apart / 3.0F);
    const Vec2f q = b + way_b * (apart / 3.0F);
    std::vector<Vec2f> path;
    for (int k = 1; k < steps; ++k) {
        const float s = static_cast<float>(k) / static_cast<float>(steps);
        const float r = 1.0F - s;
        path.push_back(a * (r * r * r) + p * (3.0F * r * r * s) + q * (3.0F * r * s * s) +
                       b * (s * s * s));
    }
    path.push_back(b);
    return path;
}

/// Cuts the way from `a` to `b` where it crosses the sides of lattice cells: its points, both ends
/// included, without repeats.
inline std::vector<Vec2f> cut_by_cells(Vec2f a, Vec2f b, float spacing) {
    std::vector<float> cuts{0.0F, 1.0F};
    const auto add_cuts = [&](float from, float to) {
        const float low = std::min(from, to) / spacing - 0.5F;
        const float high = std::max(from, to) / spacing - 0.5F;
        for (float side = std::floor(low) + 1.0F; side < high; side += 1.0F) {
            cuts.push_back(((side + 0.5F) * spacing - from) / (to - from));
        }
    };
    add_cuts(a.x, b.x);
    add_cuts(a.y, b.y);
    std::ranges::sort(cuts);
    std::vector<Vec2f> points{a};
    for (std::size_t n = 1; n < cuts.size(); ++n) {
        const Vec2f to = n + 1 == cuts.size() ? b : a + (b - a) * cuts[n];
        if (to != points.back()) points.push_back(to);
    }
    return points;
}

/// A piece of a line from `a` to `b`, of the kind of another that goes on towards its own end b, or
/// towards a.
inline Segment piece_like(const Segment& line, bool towards_b, Vec2f a, Vec2f b) {
    Segment piece = line;
    if (!towards_b) piece.left_in_front = !piece.left_in_front;
    piece.left_in_front_at_b = piece.left_in_front;
    piece.a = a;
    piece.b = b;
    piece.type_at_b = piece.type;
    piece.left_at_b = piece.left;
    piece.right_at_b = piece.right;
    piece.spans_cell = true;
    return piece;
}

}  // namespace ink::plane

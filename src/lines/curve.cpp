#include "lines/curve.h"

#include <algorithm>
#include <cmath>

namespace ink {

namespace {

Vec2f mix(Vec2f a, Vec2f b, double u) {
    return to_float(to_double(a) * (1.0 - u) + to_double(b) * u);
}

Vec2f start_of(const Curve& curve, std::size_t piece) {
    return piece == 0 ? curve.start : curve.pieces[piece - 1].end;
}

/// What is left of a piece before the parameter u, and after it (de Casteljau).
struct Halves {
    CurvePiece before, after;
};

Halves cut(Vec2f start, const CurvePiece& piece, double u) {
    const Vec2f a = mix(start, piece.control1, u);
    const Vec2f b = mix(piece.control1, piece.control2, u);
    const Vec2f c = mix(piece.control2, piece.end, u);
    const Vec2f ab = mix(a, b, u);
    const Vec2f bc = mix(b, c, u);
    const Vec2f middle = mix(ab, bc, u);
    return {{a, ab, middle, piece.straight}, {bc, c, piece.end, piece.straight}};
}

/// From the straight line through a and b; from a if they are one.
double distance_from_line(Vec2d p, Vec2d a, Vec2d b) {
    const double size = length(b - a);
    return size == 0.0 ? length(p - a) : std::abs(cross(b - a, p - a)) / size;
}

}  // namespace

CurvePiece straight_piece(Vec2f from, Vec2f to) {
    const Vec2f third = (to - from) * (1.0F / 3.0F);
    return {from + third, from + third * 2.0F, to, true};
}

bool is_straight(Vec2f start, const CurvePiece& piece) {
    constexpr double kInvisible = 0.01;  // pixels
    const Vec2d a = to_double(start);
    const Vec2d b = to_double(piece.end);
    const Vec2d first = to_double(piece.control1);
    const Vec2d second = to_double(piece.control2);
    const double first_on_way = dot(first - a, b - a);
    const double second_on_way = dot(second - a, b - a);
    return first_on_way >= 0.0 && second_on_way <= dot(b - a, b - a) &&
           first_on_way <= second_on_way && distance_from_line(first, a, b) < kInvisible &&
           distance_from_line(second, a, b) < kInvisible;
}

Vec2d point_at(Vec2f start, const CurvePiece& piece, double u) {
    const double v = 1.0 - u;
    return to_double(start) * (v * v * v) + to_double(piece.control1) * (3.0 * u * v * v) +
           to_double(piece.control2) * (3.0 * u * u * v) + to_double(piece.end) * (u * u * u);
}

Curve reversed(const Curve& curve) {
    Curve back{curve.end(), {}};
    for (std::size_t k = curve.pieces.size(); k-- > 0;) {
        const CurvePiece& piece = curve.pieces[k];
        back.pieces.push_back({piece.control2, piece.control1, start_of(curve, k), piece.straight});
    }
    return back;
}

MeasuredCurve::MeasuredCurve(const Curve& curve) : curve_(curve), marks_{{0.0, 0.0}} {
    constexpr int kSteps = 16;  // a piece turns by little between them
    for (std::size_t k = 0; k < curve.pieces.size(); ++k) {
        const Vec2f start = start_of(curve, k);
        Vec2d at = to_double(start);
        for (int step = 1; step <= kSteps; ++step) {
            const double u = static_cast<double>(step) / kSteps;
            const Vec2d next = point_at(start, curve.pieces[k], u);
            marks_.push_back(
                {marks_.back().length + ink::length(next - at), static_cast<double>(k) + u});
            at = next;
        }
    }
}

double MeasuredCurve::place_of(double share) const {
    const double goal = share * length();
    const auto after = std::ranges::lower_bound(marks_, goal, {}, &Mark::length);
    if (after == marks_.begin()) return 0.0;
    if (after == marks_.end()) return marks_.back().place;
    const Mark& before = *(after - 1);
    const double step = after->length - before.length;
    return before.place + (after->place - before.place) * (goal - before.length) / step;
}

Curve MeasuredCurve::part(double from, double to) const {
    const double begin = place_of(from);
    const double end = place_of(to);
    const auto first = std::min(static_cast<std::size_t>(begin), curve_.pieces.size() - 1);
    const auto last = std::min(static_cast<std::size_t>(end), curve_.pieces.size() - 1);
    Curve part;
    for (std::size_t k = first; k <= last; ++k) {
        const Vec2f start = start_of(curve_, k);
        CurvePiece piece = curve_.pieces[k];
        const double u1 = begin - static_cast<double>(k);
        const double u2 = end - static_cast<double>(k);
        if (u2 <= 0.0) break;  // ends where the piece before ends
        if (u2 < 1.0) piece = cut(start, piece, u2).before;
        Vec2f piece_start = start;
        if (u1 > 0.0) {
            const Halves halves = cut(start, curve_.pieces[k], u1);
            piece_start = halves.before.end;
            piece = u2 < 1.0 ? cut(piece_start, halves.after, (u2 - u1) / (1.0 - u1)).before
                             : halves.after;
            if (u2 < 1.0) piece.end = cut(start, curve_.pieces[k], u2).before.end;
        }
        if (part.pieces.empty()) part.start = piece_start;
        part.pieces.push_back(piece);
    }
    return part;
}

}  // namespace ink

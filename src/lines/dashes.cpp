#include "lines/dashes.h"

#include <algorithm>
#include <cmath>

namespace ink {

Dashes fit_dashes(const Dashes& usual, double length, bool closed) {
    const double period = usual.stroke + usual.gap;
    const double last_gap = closed ? 0.0 : usual.gap;
    const double count = std::round((length + last_gap) / period);
    if (count < 2.0) return {length, usual.gap};
    const double scale = length / (count * period - last_gap);
    return {usual.stroke * scale, usual.gap * scale};
}

namespace {

Segment piece_of(const Chain& chain, std::size_t k, Vec2f a, Vec2f b) {
    Segment piece;
    piece.a = a;
    piece.b = b;
    piece.type = piece.type_at_b = chain.type;
    piece.strength = chain.strength;
    piece.t = chain.t[k];
    piece.left = piece.left_at_b = chain.left;
    piece.right = piece.right_at_b = chain.right;
    piece.left_in_front = piece.left_in_front_at_b = chain.left_in_front;
    const GeometryId near = chain.left_in_front ? chain.left : chain.right;
    piece.owner = near != kBackground ? near : chain.left_in_front ? chain.right : chain.left;
    piece.hidden = chain.hidden;
    return piece;
}

}  // namespace

void cut_into_strokes(const Chain& chain, const Dashes* dashes, std::vector<Segment>& strokes) {
    const std::size_t count = chain.points.size();
    const Dashes pattern = dashes != nullptr ? *dashes : Dashes{};
    const double period = pattern.stroke + pattern.gap;
    double begin = 0.0;  // of the piece at hand, along the chain
    for (std::size_t k = 0; k + (chain.closed ? 0 : 1) < count; ++k) {
        const Vec2f a = chain.points[k];
        const Vec2f b = chain.points[(k + 1) % count];
        const auto size = static_cast<double>(length(b - a));
        if (size == 0.0) continue;
        const double end = begin + size;
        const auto point = [&](double s) {
            return s >= end ? b : a + (b - a) * static_cast<float>((s - begin) / size);
        };
        if (dashes == nullptr) {
            strokes.push_back(piece_of(chain, k, a, b));
        } else {
            for (double from = std::floor(begin / period) * period; from < end; from += period) {
                const double first = std::max(from, begin);
                const double last = std::min(from + pattern.stroke, end);
                if (first >= last) continue;
                strokes.push_back(piece_of(chain, k, point(first), point(last)));
            }
        }
        begin = end;
    }
}

}  // namespace ink

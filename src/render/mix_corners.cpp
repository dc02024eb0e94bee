#include "render/mix_corners.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/mix_corners.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

using Weights = std::array<Number, 4>;

/// The first of the heaviest corners.
HWY_INLINE Integer heaviest(const Weights& weights) {
    Number most = weights[0];
    auto corner = hn::Zero(kIntegers);
    for (std::size_t k = 1; k < 4; ++k) {
        const auto heavier = hn::Gt(weights[k], most);
        corner = hn::IfThenElse(hn::RebindMask(kIntegers, heavier),
                                hn::Set(kIntegers, static_cast<std::int32_t>(k)), corner);
        most = hn::Max(weights[k], most);
    }
    return corner;
}

/// Adds to each corner what divides it from a point.
HWY_INLINE void add_divided(const DividingLine& line, Number x, Number y, Weights& divided) {
    const Number side = hn::Sub(hn::Mul(set(line.way.x), hn::Sub(y, set(line.start.y))),
                                hn::Mul(set(line.way.y), hn::Sub(x, set(line.start.x))));
    for (std::size_t k = 0; k < 4; ++k) {
        const auto beyond = hn::Lt(hn::Mul(side, set(line.sides[k])), hn::Zero(kFloats));
        divided[k] = hn::Add(divided[k], hn::IfThenElseZero(beyond, set(line.weight)));
    }
}

/// Leaves the least divided corners.
HWY_INLINE void drop_divided(const Weights& divided, Weights& weights) {
    const Number least = hn::Min(hn::Min(divided[0], divided[1]), hn::Min(divided[2], divided[3]));
    for (std::size_t k = 0; k < 4; ++k) {
        weights[k] = hn::IfThenZeroElse(hn::Gt(divided[k], least), weights[k]);
    }
}

HWY_INLINE float byte_of(std::uint32_t pixel, std::size_t channel) {
    return static_cast<float>((pixel >> (8U * channel)) & 0xFFU);
}

/// Of straight alpha: colours count by their alpha. `all` is the sum of the weights.
HWY_INLINE Word mix(const std::array<std::uint32_t, 4>& corners, const Weights& weights,
                    Number all) {
    std::array<Number, 4> sums{set(0.0F), set(0.0F), set(0.0F), set(0.0F)};
    for (std::size_t k = 0; k < 4; ++k) {
        const Number weight = hn::Mul(weights[k], set(byte_of(corners[k], 3)));
        for (std::size_t c = 0; c < 3; ++c) {
            sums[c] = hn::Add(sums[c], hn::Mul(weight, set(byte_of(corners[k], c))));
        }
        sums[3] = hn::Add(sums[3], weight);
    }
    const auto rounded = [](Number value) HWY_ATTR {
        return hn::BitCast(kWords, hn::ConvertTo(kIntegers, hn::Add(value, set(0.5F))));
    };
    auto pixels = hn::ShiftLeft<24>(rounded(hn::Div(sums[3], all)));
    const auto seen = hn::RebindMask(kWords, hn::Gt(sums[3], set(0.0F)));
    const Number divisor = hn::IfThenElse(hn::Gt(sums[3], set(0.0F)), sums[3], set(1.0F));
    const auto color = [&](std::size_t c) HWY_ATTR {
        return hn::IfThenElseZero(seen, rounded(hn::Div(sums[c], divisor)));
    };
    pixels = hn::Or(pixels, color(0));
    pixels = hn::Or(pixels, hn::ShiftLeft<8>(color(1)));
    return hn::Or(pixels, hn::ShiftLeft<16>(color(2)));
}

void mix_all(const CellCorners& corners, std::span<const DividingLine> lines,
             const Lanes<float>& all_x, const Lanes<float>& all_y, MixedPixels& mixed) {
    mixed.known = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const Number x = load(all_x, i);
        const Number y = load(all_y, i);
        const Number right = hn::Sub(x, set(corners.places[0].x));
        const Number below = hn::Sub(y, set(corners.places[0].y));
        const Number left = hn::Sub(set(1.0F), right);
        const Number above = hn::Sub(set(1.0F), below);
        Weights weights{hn::Mul(left, above), hn::Mul(right, above), hn::Mul(left, below),
                        hn::Mul(right, below)};
        store(heaviest(weights), mixed.nearest, i);
        Weights divided{set(0.0F), set(0.0F), set(0.0F), set(0.0F)};
        for (const DividingLine& line : lines) add_divided(line, x, y, divided);
        drop_divided(divided, weights);
        store(heaviest(weights), mixed.seen, i);
        const Number all =
            hn::Add(hn::Add(hn::Add(weights[0], weights[1]), weights[2]), weights[3]);
        constexpr float kLeast = 1e-3F;
        const auto known = hn::Ge(all, set(kLeast));
        mixed.known |= bits_of(known) << i;
        const Number sum = hn::IfThenElse(known, all, set(1.0F));
        store(mix(corners.pixels, weights, sum), mixed.pixels, i);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(mix_all);

namespace {

/// Beyond an outline lies another thing, beyond a fold the same one farther back, beyond a crease
/// the same one beside it. Each counts more than two of the next.
float weight_of(LineType type) {
    switch (type) {
        case LineType::silhouette:
        case LineType::boundary: return 9.0F;
        case LineType::intersection:
        case LineType::self_occlusion: return 3.0F;
        default: return 1.0F;
    }
}

}  // namespace

DividingLine::DividingLine(const Segment& line, const CellCorners& corners)
    : start(line.a), way(line.b - line.a), weight(weight_of(line.type)) {
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec2f v = corners.places[k] - start;
        sides[k] = way.x * v.y - way.y * v.x;
    }
}

void mix_corners(const CellCorners& corners, std::span<const DividingLine> lines,
                 const Lanes<float>& x, const Lanes<float>& y, MixedPixels& mixed) {
    HWY_DYNAMIC_DISPATCH(mix_all)(corners, lines, x, y, mixed);
}

}  // namespace ink

#endif

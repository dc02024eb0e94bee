#include "render/nearest_edges.h"

#include <bit>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/nearest_edges.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Numbers = hn::Rebind<std::uint32_t, Floats>;
using Indices = hn::Rebind<std::int32_t, Floats>;
constexpr Floats kFloats;
constexpr Numbers kNumbers;
constexpr Indices kIndices;
using Number = hn::Vec<Floats>;

HWY_INLINE Number set(float value) { return hn::Set(kFloats, value); }

/// From a pixel to an edge.
struct Approach {
    Number vx, vy, squared;
    hn::Mask<Floats> inside;  ///< not to one of its ends
};

HWY_INLINE Approach approach(Number px, Number py, Number ax, Number ay, Number ux, Number uy,
                             Number length) {
    const Number rx = hn::Sub(px, ax);
    const Number ry = hn::Sub(py, ay);
    const Number s = hn::Add(hn::Mul(rx, ux), hn::Mul(ry, uy));
    const Number nearest = hn::Min(hn::Max(s, hn::Zero(kFloats)), length);
    const Number vx = hn::Sub(rx, hn::Mul(nearest, ux));
    const Number vy = hn::Sub(ry, hn::Mul(nearest, uy));
    return {vx, vy, hn::Add(hn::Mul(vx, vx), hn::Mul(vy, vy)), hn::Eq(nearest, s)};
}

/// Which of sixteen values are this one: a bit each.
HWY_INLINE std::uint32_t bits_of(const Lanes<std::uint32_t>& values, std::uint32_t value) {
    std::uint32_t all = 0;
    for (int i = 0; i < kLanes; i += static_cast<int>(hn::MaxLanes(kFloats))) {
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(kNumbers,
                          hn::Eq(hn::Load(kNumbers, values.data() + i), hn::Set(kNumbers, value)),
                          bytes);
        all |= (static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U)
               << i;
    }
    return all;
}

std::size_t find_distinct_lanes(const Lanes<std::uint32_t>& values, std::uint32_t none,
                                Lanes<std::uint32_t>& distinct) {
    constexpr std::uint32_t kAll = (1U << kLanes) - 1;
    int count = 0;
    for (std::uint32_t rest = kAll & ~bits_of(values, none); rest != 0;) {
        const std::uint32_t value = values[std::countr_zero(rest)];
        distinct[count++] = value;
        rest &= ~bits_of(values, value);
    }
    return static_cast<std::size_t>(count);
}

void find_nearest_lanes(std::span<const FaceEdge> edges, float x, float y, float reach,
                        NearestEdges& nearest, Lanes<float>& vx, Lanes<float>& vy) {
    static_assert(sizeof(FaceEdge) == 8 * sizeof(float));
    alignas(64) float offset_x[kLanes];
    alignas(64) float offset_y[kLanes];
    for (int i = 0; i < kLanes; ++i) {
        offset_x[i] = x + static_cast<float>(i % kBlockSide);
        offset_y[i] = y + static_cast<float>(i / kBlockSide);
    }
    for (int i = 0; i < kLanes; i += static_cast<int>(hn::MaxLanes(kFloats))) {
        const Number px = hn::Load(kFloats, offset_x + i);
        const Number py = hn::Load(kFloats, offset_y + i);
        const auto triangle = hn::Load(kNumbers, nearest.triangle.data() + i);
        Number least = set(kInfinity);
        auto winner = hn::Zero(kIndices);
        std::int32_t offset = 0;
        for (const FaceEdge& face : edges) {
            const ScreenEdge& e = face.edge;
            const Approach to = approach(px, py, set(e.a.x), set(e.a.y), set(e.along.x),
                                         set(e.along.y), set(e.length));
            const auto own = hn::Lt(hn::Sub(triangle, hn::Set(kNumbers, face.begin)),
                                    hn::Set(kNumbers, face.end - face.begin));
            const auto better = hn::And(hn::RebindMask(kFloats, own), hn::Lt(to.squared, least));
            least = hn::IfThenElse(better, to.squared, least);
            winner =
                hn::IfThenElse(hn::RebindMask(kIndices, better), hn::Set(kIndices, offset), winner);
            offset += 8;
        }
        const auto* base = reinterpret_cast<const float*>(edges.data());
        const auto pick = [&](int field)
                              HWY_ATTR { return hn::GatherIndex(kFloats, base + field, winner); };
        const Number ux = pick(2);
        const Number uy = pick(3);
        const Approach to = approach(px, py, pick(0), pick(1), ux, uy, pick(4));
        const Number distance = hn::Sqrt(least);
        const Number inverse = hn::Div(set(1.0F), hn::Max(distance, set(1e-6F)));
        const auto store = [i](Number value, Lanes<float>& lanes)
                               HWY_ATTR { hn::Store(value, kFloats, lanes.data() + i); };
        store(hn::IfThenElse(to.inside, hn::Neg(uy), hn::Mul(to.vx, inverse)), nearest.nx);
        store(hn::IfThenElse(to.inside, ux, hn::Mul(to.vy, inverse)), nearest.ny);
        store(pick(5), nearest.t);
        store(hn::IfThenElse(hn::Lt(distance, set(reach)), distance, set(kInfinity)),
              nearest.distance);
        store(to.vx, vx);
        store(to.vy, vy);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_distinct_lanes);
HWY_EXPORT(find_nearest_lanes);

std::size_t find_distinct(const Lanes<std::uint32_t>& values, std::uint32_t none,
                          Lanes<std::uint32_t>& distinct) {
    return HWY_DYNAMIC_DISPATCH(find_distinct_lanes)(values, none, distinct);
}

void find_nearest(std::span<const FaceEdge> edges, float x, float y, float reach,
                  NearestEdges& nearest, Lanes<float>& vx, Lanes<float>& vy) {
    HWY_DYNAMIC_DISPATCH(find_nearest_lanes)(edges, x, y, reach, nearest, vx, vy);
}

}  // namespace ink

#endif

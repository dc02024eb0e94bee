#include "render/nearest_edges.h"

#include "accel/tracer.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/nearest_edges.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// From a pixel to an edge.
struct Approach {
    Number vx, vy, squared;
    Mask inside;  ///< not to one of its ends
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

using Row = hn::FixedTag<std::uint32_t, kBlockSide>;
constexpr Row kRow;

std::uint32_t find_starts_lanes(const Lanes<std::uint32_t>& values, std::uint32_t none) {
    const auto nothing = hn::Set(kRow, none);
    const auto first = hn::FirstN(kRow, 1);
    auto above = nothing;
    std::uint32_t starts = 0;
    for (int i = 0; i < kLanes; i += kBlockSide) {
        const auto row = hn::Load(kRow, values.data() + i);
        const auto before = hn::IfThenElse(first, nothing, hn::Shuffle2103(row));
        const auto repeats =
            hn::Or(hn::Or(hn::Eq(row, before), hn::Eq(row, above)), hn::Eq(row, nothing));
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(kRow, repeats, bits);
        starts |= (~static_cast<std::uint32_t>(bits[0]) & 0xFU) << i;
        above = row;
    }
    return starts;
}

/// The values of the row above from the i-th on; of the first row itself.
HWY_INLINE Word row_above(const Lanes<std::uint32_t>& values, int i) {
    if (i > 0) return hn::LoadU(kWords, values.data() + i - kBlockSide);
    const auto above = hn::Sub(hn::Iota(kIntegers, 0), hn::Set(kIntegers, kBlockSide));
    const auto places =
        hn::Max(above, hn::And(hn::Iota(kIntegers, 0), hn::Set(kIntegers, kBlockSide - 1)));
    return hn::TableLookupLanes(hn::Load(kWords, values.data()),
                                hn::IndicesFromVec(kWords, places));
}

int count_changes_lanes(const Lanes<std::uint32_t>& objects,
                        const Lanes<std::uint32_t>& primitives) {
    const auto none = hn::Set(kWords, kNoObject);
    const auto column = hn::And(hn::Iota(kWords, 0), hn::Set(kWords, kBlockSide - 1));
    const auto is_first = hn::Eq(column, hn::Zero(kWords));
    std::size_t changes = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto object = load(objects, i);
        const auto primitive = load(primitives, i);
        const auto is_hit = hn::Ne(object, none);
        const auto differ = [&](auto other_object, auto other_primitive) HWY_ATTR {
            return hn::And(hn::And(hn::Eq(object, other_object), is_hit),
                           hn::Ne(primitive, other_primitive));
        };
        // The first of each row is compared with the last one, which does not count.
        const auto beside = differ(hn::Shuffle2103(object), hn::Shuffle2103(primitive));
        changes += hn::CountTrue(kWords, hn::AndNot(is_first, beside));
        changes += hn::CountTrue(kWords, differ(row_above(objects, i), row_above(primitives, i)));
    }
    return static_cast<int>(changes);
}

void find_nearest_lanes(std::span<const ScreenEdge> edges, std::span<const SeenFace> faces, float x,
                        float y, float reach, NearestEdges& nearest, Lanes<float>& vx,
                        Lanes<float>& vy) {
    alignas(64) float offset_x[kLanes];
    alignas(64) float offset_y[kLanes];
    for (int i = 0; i < kLanes; ++i) {
        offset_x[i] = x + static_cast<float>(i % kBlockSide);
        offset_y[i] = y + static_cast<float>(i / kBlockSide);
    }
    for (int i = 0; i < kLanes; i += kStep) {
        const Number px = hn::Load(kFloats, offset_x + i);
        const Number py = hn::Load(kFloats, offset_y + i);
        const auto triangle = load(nearest.triangle, i);
        Number least = set(kInfinity);
        Number to_x = hn::Zero(kFloats);
        Number to_y = to_x;
        Number along_x = set(1.0F);  // any normal will do where there is no edge
        Number along_y = to_x;
        Number t = to_x;
        auto inside = hn::Eq(least, least);
        for (const SeenFace& face : faces) {
            const auto own =
                hn::RebindMask(kFloats, hn::Lt(hn::Sub(triangle, hn::Set(kWords, face.begin)),
                                               hn::Set(kWords, face.end - face.begin)));
            for (std::uint32_t k = face.first; k < face.first + face.count; ++k) {
                const ScreenEdge& e = edges[k];
                const Number ux = set(e.along.x);
                const Number uy = set(e.along.y);
                const Approach to = approach(px, py, set(e.a.x), set(e.a.y), ux, uy, set(e.length));
                const auto better = hn::And(own, hn::Lt(to.squared, least));
                least = hn::IfThenElse(better, to.squared, least);
                to_x = hn::IfThenElse(better, to.vx, to_x);
                to_y = hn::IfThenElse(better, to.vy, to_y);
                along_x = hn::IfThenElse(better, ux, along_x);
                along_y = hn::IfThenElse(better, uy, along_y);
                t = hn::IfThenElse(better, set(e.t), t);
                inside = hn::Or(hn::And(better, to.inside), hn::AndNot(better, inside));
            }
        }
        const Number distance = hn::Sqrt(least);
        const Number inverse = hn::Div(set(1.0F), hn::Max(distance, set(1e-6F)));
        store(hn::IfThenElse(inside, hn::Neg(along_y), hn::Mul(to_x, inverse)), nearest.nx, i);
        store(hn::IfThenElse(inside, along_x, hn::Mul(to_y, inverse)), nearest.ny, i);
        store(t, nearest.t, i);
        store(hn::IfThenElse(hn::Lt(distance, set(reach)), distance, set(kInfinity)),
              nearest.distance, i);
        store(to_x, vx, i);
        store(to_y, vy, i);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_starts_lanes);
HWY_EXPORT(count_changes_lanes);
HWY_EXPORT(find_nearest_lanes);

std::uint32_t find_starts(const Lanes<std::uint32_t>& values, std::uint32_t none) {
    return HWY_DYNAMIC_DISPATCH(find_starts_lanes)(values, none);
}

int count_changes(const Lanes<std::uint32_t>& objects, const Lanes<std::uint32_t>& primitives) {
    return HWY_DYNAMIC_DISPATCH(count_changes_lanes)(objects, primitives);
}

void find_nearest(std::span<const ScreenEdge> edges, std::span<const SeenFace> faces, float x,
                  float y, float reach, NearestEdges& nearest, Lanes<float>& vx, Lanes<float>& vy) {
    HWY_DYNAMIC_DISPATCH(find_nearest_lanes)(edges, faces, x, y, reach, nearest, vx, vy);
}

}  // namespace ink

#endif

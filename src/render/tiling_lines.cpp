#include "render/tiling_lines.h"

#include <bit>
#include <cstddef>

#include "base/vec.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/tiling_lines.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "lines/coverage_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

using Four = hn::FixedTag<float, 4>;
constexpr Four kFour;

/// How far sixteen points, from the i-th on, are from the nearest line. Calls `take(k, nearer)` for
/// each family: which of them are nearer to it than to those before.
template <class Take>
HWY_INLINE Number for_each_family(const TilingLines& lines, const Lanes<float>& x,
                                  const Lanes<float>& y, int i, const Take& take) {
    const Number qx = load(x, i);
    const Number qy = load(y, i);
    Number least = set(kInfinity);
    for (std::size_t k = 0; k < 3; ++k) {
        if ((lines.without >> k & 1U) != 0) continue;
        const Number across = hn::Add(hn::Mul(set(lines.dx[k]), qx), hn::Mul(set(lines.dy[k]), qy));
        const Number at = hn::Add(set(lines.at[k]), across);
        const Number distance = hn::Mul(hn::Abs(hn::Sub(at, hn::Round(at))), set(lines.apart[k]));
        take(k, hn::Lt(distance, least));
        least = hn::Min(distance, least);
    }
    return least;
}

TilingLines find_lines_about(const TilingSpot& spot, float factor) {
    static_assert(offsetof(TriangleSides, dx) == 2 * sizeof(float));
    static_assert(offsetof(TilingSpot, t) == sizeof(TriangleSides));
    const auto inside_dx = hn::LoadU(kFour, spot.sides.inside.data());
    const auto dy_rest = hn::LoadU(kFour, spot.sides.dy.data());
    // What is left of one, and of nothing.
    alignas(16) constexpr std::array kWhole{1.0F, 1.0F, 0.0F, 0.0F};
    const auto whole = hn::Load(kFour, kWhole.data());
    const auto third = hn::Sub(hn::Sub(whole, inside_dx), hn::Shuffle2301(inside_dx));
    const auto third_dy = hn::Sub(hn::Neg(dy_rest), hn::Shuffle2301(dy_rest));
    const auto inside = hn::ConcatLowerLower(kFour, third, inside_dx);
    const auto dx = hn::ConcatUpperUpper(kFour, third, inside_dx);
    const auto dy = hn::ConcatLowerLower(kFour, third_dy, dy_rest);
    const auto steep = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
    const auto height = hn::Div(hn::Set(kFour, 1.0F), hn::Max(steep, hn::Set(kFour, 1e-20F)));
    const auto shrink = hn::Set(kFour, 1.0F / factor);
    TilingLines lines;
    hn::StoreU(inside, kFour, lines.at.data());
    hn::StoreU(hn::Mul(dx, shrink), kFour, lines.dx.data());
    hn::StoreU(hn::Mul(dy, shrink), kFour, lines.dy.data());
    hn::StoreU(hn::Mul(dx, height), kFour, lines.nx.data());
    hn::StoreU(hn::Mul(dy, height), kFour, lines.ny.data());
    hn::StoreU(hn::Mul(height, hn::Set(kFour, factor)), kFour, lines.apart.data());
    lines.without = spot.object & 7U;
    return lines;
}

void find_nearest_tiling(const TilingLines& lines, const Lanes<float>& x, const Lanes<float>& y,
                         NearestEdges& nearest) {
    for (int i = 0; i < kLanes; i += kStep) {
        Number nx = set(1.0F);
        Number ny = hn::Zero(kFloats);
        const Number distance =
            for_each_family(lines, x, y, i, [&](std::size_t k, auto nearer) HWY_ATTR {
                nx = hn::IfThenElse(nearer, set(lines.nx[k]), nx);
                ny = hn::IfThenElse(nearer, set(lines.ny[k]), ny);
            });
        hn::Store(distance, kFloats, nearest.distance.data() + i);
        hn::Store(nx, kFloats, nearest.nx.data() + i);
        hn::Store(ny, kFloats, nearest.ny.data() + i);
    }
}

/// The families about some spots, from the i-th on.
HWY_INLINE void find_families(const TilingSpot* spots, const Lanes<std::int32_t>& indices,
                              float factor, int i, std::array<TilingFamily, 3>& families) {
    static_assert(sizeof(TilingSpot) == 8 * sizeof(float));
    const Integer first = hn::ShiftLeft<3>(load(indices, i));
    const auto* const numbers = reinterpret_cast<const float*>(spots);
    const auto field = [&](std::size_t offset) HWY_ATTR {
        return hn::GatherIndex(kFloats, numbers + offset / sizeof(float), first);
    };
    constexpr std::size_t kNext = sizeof(float);
    const auto three = [&](std::size_t offset, float sum) HWY_ATTR {
        const Number a = field(offset);
        const Number b = field(offset + kNext);
        return std::array<Number, 3>{a, b, hn::Sub(hn::Sub(set(sum), a), b)};
    };
    const auto inside = three(offsetof(TriangleSides, inside), 1.0F);
    const auto all_dx = three(offsetof(TriangleSides, dx), 0.0F);
    const auto all_dy = three(offsetof(TriangleSides, dy), 0.0F);
    const auto without = hn::BitCast(kIntegers, field(offsetof(TilingSpot, object)));
    const Number half = set(0.5F);
    const Number least = set(1e-6F);
    const Number shrink = set(1.0F / factor);
    for (std::size_t k = 0; k < 3; ++k) {
        const Number dx = all_dx[k];
        const Number dy = all_dy[k];
        const Number steep = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        const Number height = hn::Div(set(1.0F), hn::Max(steep, set(1e-20F)));
        const Number nx = hn::Abs(hn::Mul(dx, height));
        const Number ny = hn::Abs(hn::Mul(dy, height));
        const Number wide = hn::Max(nx, ny);
        const Number narrow = hn::Min(nx, ny);
        // Lines that are not there are everywhere without end away.
        const auto bit = hn::Set(kIntegers, 1 << k);
        const auto none = hn::RebindMask(kFloats, hn::Eq(hn::And(without, bit), bit));
        TilingFamily& family = families[k];
        store(hn::IfThenElse(none, half, inside[k]), family.at, i);
        store(hn::IfThenZeroElse(none, hn::Mul(dx, shrink)), family.dx, i);
        store(hn::IfThenZeroElse(none, hn::Mul(dy, shrink)), family.dy, i);
        store(hn::IfThenElse(none, set(kInfinity), hn::Mul(height, set(factor))), family.apart, i);
        store(hn::Mul(half, hn::Add(wide, narrow)), family.reach, i);
        store(hn::Mul(half, hn::Sub(wide, narrow)), family.flat, i);
        store(hn::Div(set(1.0F), hn::Max(wide, least)), family.slope, i);
        store(hn::Div(half, hn::Max(hn::Mul(wide, narrow), least)), family.corner, i);
    }
}

/// Inks a block by the families in one lane.
HWY_INLINE void ink_block(const std::array<TilingFamily, 3>& families, int lane,
                          const Lanes<float>& x, const Lanes<float>& y, float half, float opacity,
                          Lanes<float>& alpha) {
    for (int i = 0; i < kLanes; i += kStep) {
        const Number qx = load(x, i);
        const Number qy = load(y, i);
        const auto distance_from = [&](const TilingFamily& lines) HWY_ATTR {
            const Number across =
                hn::Add(hn::Mul(set(lines.dx[lane]), qx), hn::Mul(set(lines.dy[lane]), qy));
            const Number at = hn::Add(set(lines.at[lane]), across);
            return hn::Mul(hn::Abs(hn::Sub(at, hn::Round(at))), set(lines.apart[lane]));
        };
        Number distance = distance_from(families[0]);
        Number reach = set(families[0].reach[lane]);
        Number flat = set(families[0].flat[lane]);
        Number slope = set(families[0].slope[lane]);
        Number corner = set(families[0].corner[lane]);
        for (std::size_t k = 1; k < 3; ++k) {
            const TilingFamily& lines = families[k];
            const Number own = distance_from(lines);
            const auto nearer = hn::Lt(own, distance);
            reach = hn::IfThenElse(nearer, set(lines.reach[lane]), reach);
            flat = hn::IfThenElse(nearer, set(lines.flat[lane]), flat);
            slope = hn::IfThenElse(nearer, set(lines.slope[lane]), slope);
            corner = hn::IfThenElse(nearer, set(lines.corner[lane]), corner);
            distance = hn::Min(own, distance);
        }
        const SquareCoverage area(reach, flat, slope, corner);
        const Number ink =
            hn::Sub(area(hn::Sub(set(half), distance)), area(hn::Sub(set(-half), distance)));
        store(hn::Max(hn::Mul(ink, set(opacity)), load(alpha, i)), alpha, i);
    }
}

void ink_tiling(const TilingBlocks& blocks, const TilingSpot* spots, float factor,
                const RowBands& bands, std::span<Lanes<float>> alphas) {
    std::array<TilingFamily, 3> families;
    for (int i = 0; i < kLanes; i += kStep) {
        if ((blocks.which >> i & ((1U << kStep) - 1U)) == 0) continue;
        find_families(spots, blocks.spots, factor, i, families);
    }
    for (LaneBits left = blocks.which; left != 0; left &= left - 1) {
        const int lane = std::countr_zero(left);
        const auto k = static_cast<std::size_t>(lane);
        ink_block(families, lane, *blocks.off_x[k], *blocks.off_y, bands.half[lane], bands.opacity,
                  alphas[k]);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_lines_about);
HWY_EXPORT(find_nearest_tiling);
HWY_EXPORT(ink_tiling);

TilingLines lines_about(const TilingSpot& spot, float factor) {
    return HWY_DYNAMIC_DISPATCH(find_lines_about)(spot, factor);
}

void find_nearest(const TilingLines& lines, const Lanes<float>& x, const Lanes<float>& y,
                  NearestEdges& nearest) {
    HWY_DYNAMIC_DISPATCH(find_nearest_tiling)(lines, x, y, nearest);
}

void ink(const TilingBlocks& blocks, const TilingSpot* spots, float factor, const RowBands& bands,
         std::span<Lanes<float>> alphas) {
    HWY_DYNAMIC_DISPATCH(ink_tiling)(blocks, spots, factor, bands, alphas);
}

}  // namespace ink

#endif

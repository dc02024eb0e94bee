#include "render/tiling_lines.h"

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

/// What depends on the normals of the families alone, see SquareCoverage.
struct FamilyShapes {
    std::array<float, 4> reach, flat, slope, corner;

    HWY_INLINE explicit FamilyShapes(const TilingLines& lines) {
        const auto nx = hn::Abs(hn::LoadU(kFour, lines.nx.data()));
        const auto ny = hn::Abs(hn::LoadU(kFour, lines.ny.data()));
        const auto half = hn::Set(kFour, 0.5F);
        const auto wide = hn::Max(nx, ny);
        const auto narrow = hn::Min(nx, ny);
        const auto least = hn::Set(kFour, 1e-6F);
        hn::StoreU(hn::Mul(half, hn::Add(wide, narrow)), kFour, reach.data());
        hn::StoreU(hn::Mul(half, hn::Sub(wide, narrow)), kFour, flat.data());
        hn::StoreU(hn::Div(hn::Set(kFour, 1.0F), hn::Max(wide, least)), kFour, slope.data());
        hn::StoreU(hn::Div(half, hn::Max(hn::Mul(wide, narrow), least)), kFour, corner.data());
    }
};

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

void ink_tiling(const TilingSpot& spot, float factor, const Lanes<float>& x, const Lanes<float>& y,
                FaceBand band, Lanes<float>& alpha) {
    const TilingLines lines = find_lines_about(spot, factor);
    const FamilyShapes shapes(lines);
    const float half = band.half;
    for (int i = 0; i < kLanes; i += kStep) {
        Number reach = set(0.5F);
        Number flat = set(0.5F);
        Number slope = set(1.0F);
        Number corner = hn::Zero(kFloats);
        const Number distance =
            for_each_family(lines, x, y, i, [&](std::size_t k, auto nearer) HWY_ATTR {
                reach = hn::IfThenElse(nearer, set(shapes.reach[k]), reach);
                flat = hn::IfThenElse(nearer, set(shapes.flat[k]), flat);
                slope = hn::IfThenElse(nearer, set(shapes.slope[k]), slope);
                corner = hn::IfThenElse(nearer, set(shapes.corner[k]), corner);
            });
        const SquareCoverage area(reach, flat, slope, corner);
        const Number ink =
            hn::Sub(area(hn::Sub(set(half), distance)), area(hn::Sub(set(-half), distance)));
        float* const most = alpha.data() + i;
        hn::Store(hn::Max(hn::Mul(ink, set(band.opacity)), hn::Load(kFloats, most)), kFloats, most);
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

void ink(const TilingSpot& spot, float factor, const Lanes<float>& x, const Lanes<float>& y,
         FaceBand band, Lanes<float>& alpha) {
    HWY_DYNAMIC_DISPATCH(ink_tiling)(spot, factor, x, y, band, alpha);
}

}  // namespace ink

#endif

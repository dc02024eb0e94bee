#include "lines/density_lanes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/density_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Places in one direction: the squares before them, and how far they are on the way to the next.
struct Between {
    Integer square;
    Number share;

    HWY_INLINE Between(Number at, float shrink, float shift, float per_square, int first,
                       int last) {
        const Number shrunk = hn::Add(hn::Mul(at, set(shrink)), set(shift));
        const Number place = hn::Sub(hn::Mul(shrunk, set(per_square)), set(0.5F));
        const Integer before = hn::ConvertTo(kIntegers, hn::Floor(place));
        square = hn::Min(hn::Max(before, hn::Set(kIntegers, first)), hn::Set(kIntegers, last));
        const Number beyond = hn::Sub(place, hn::ConvertTo(kFloats, square));
        share = hn::Min(hn::Max(beyond, hn::Zero(kFloats)), set(1.0F));
    }
};

HWY_INLINE Number shares_of(const DensityRaster& r, Number x, Number y) {
    const Between right(x, r.shrink, r.shift.x, r.per_square, r.i0, r.i1);
    const Between below(y, r.shrink, r.shift.y, r.per_square, r.j0, r.j1);
    const Integer row =
        hn::Mul(hn::Sub(below.square, hn::Set(kIntegers, r.j0)), hn::Set(kIntegers, r.across));
    const Integer square = hn::Add(row, hn::Sub(right.square, hn::Set(kIntegers, r.i0)));
    const Integer first = hn::ShiftLeft<1>(square);
    // Its two numbers, those of the next one, and the same of the row below.
    const auto* const upper = reinterpret_cast<const float*>(r.squares);
    const float* const lower = upper + 2 * r.across;
    const auto mix = [&](std::size_t number) HWY_ATTR {
        const auto along = [&](const float* from) HWY_ATTR {
            const Number here = hn::GatherIndex(kFloats, from + number, first);
            const Number next = hn::GatherIndex(kFloats, from + number + 2, first);
            return hn::Add(here, hn::Mul(right.share, hn::Sub(next, here)));
        };
        const Number above = along(upper);
        const Number under = along(lower);
        return hn::Add(above, hn::Mul(below.share, hn::Sub(under, above)));
    };
    const Number inked = mix(0);
    const Number searched = mix(1);
    const auto any = hn::Gt(searched, hn::Zero(kFloats));
    return hn::IfThenElseZero(any, hn::Div(inked, hn::IfThenElse(any, searched, set(1.0F))));
}

void find_shares_lanes(const DensityRaster& all, std::span<const Vec2f> places,
                       std::span<float> shares) {
    static_assert(sizeof(DensityRaster::Square) == 2 * sizeof(float));
    const DensityRaster raster = all;
    Number x;
    Number y;
    std::size_t k = 0;
    for (; k + kStep <= places.size(); k += kStep) {
        hn::LoadInterleaved2(kFloats, &places[k].x, x, y);
        hn::StoreU(shares_of(raster, x, y), kFloats, &shares[k]);
    }
    if (k == places.size()) return;
    const std::span<const Vec2f> rest = places.subspan(k);
    std::array<Vec2f, kStep> last{};
    std::array<float, kStep> found{};
    std::ranges::copy(rest, last.begin());
    hn::LoadInterleaved2(kFloats, &last[0].x, x, y);
    hn::StoreU(shares_of(raster, x, y), kFloats, found.data());
    std::copy_n(found.begin(), rest.size(), shares.begin() + static_cast<std::ptrdiff_t>(k));
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_shares_lanes);

void find_shares(const DensityRaster& raster, std::span<const Vec2f> places,
                 std::span<float> shares) {
    HWY_DYNAMIC_DISPATCH(find_shares_lanes)(raster, places, shares);
}

}  // namespace ink

#endif

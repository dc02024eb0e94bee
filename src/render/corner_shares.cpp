#include "render/corner_shares.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/corner_shares.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "lines/coverage_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

HWY_INLINE void find_shares(const SegmentEnds& segments, float q, int i, CornerShares& shares) {
    const Number zero = hn::Zero(kFloats);
    const Number half = set(0.5F);
    const Number ax = load(segments.ax, i);
    const Number ay = load(segments.ay, i);
    const Number bx = load(segments.bx, i);
    const Number by = load(segments.by, i);
    const Number dx = hn::Sub(bx, ax);
    const Number dy = hn::Sub(by, ay);
    const Number length = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
    const auto is_segment = hn::Gt(length, zero);
    const Number divisor = hn::IfThenElse(is_segment, length, set(1.0F));
    // Towards the segment's left: see Segment.
    const Number nx = hn::Div(dy, divisor);
    const Number ny = hn::Neg(hn::Div(dx, divisor));
    const auto cell = [&](Number a, Number b) {
        return hn::Floor(hn::Sub(hn::Mul(hn::Mul(hn::Add(a, b), half), set(q)), half));
    };
    const Number cell_x = cell(ax, bx);
    const Number cell_y = cell(ay, by);
    hn::Store(hn::ConvertTo(kIntegers, cell_x), kIntegers, shares.cell_x.data() + i);
    hn::Store(hn::ConvertTo(kIntegers, cell_y), kIntegers, shares.cell_y.data() + i);

    // How far a place in the cell, in spacings from its first corner, lies on the left.
    const Number spacing = set(1.0F / q);
    const auto to_left = [&](float x, float y) {
        const auto place = [&](Number first, float inside) {
            return hn::Mul(hn::Add(hn::Add(first, half), set(inside)), spacing);
        };
        return hn::Add(hn::Mul(hn::Sub(place(cell_x, x), ax), nx),
                       hn::Mul(hn::Sub(place(cell_y, y), ay), ny));
    };
    const SquareCoverage covered(nx, ny);
    const Number quarter = set(0.25F / (q * q));
    for (int corner = 0; corner < 4; ++corner) {
        const auto x = static_cast<float>(corner % 2);
        const auto y = static_cast<float>(corner / 2);
        const auto on_left = hn::Gt(to_left(x, y), zero);
        // From the middle of its quarter, in units of that one's side.
        const Number inside = hn::Mul(to_left(0.5F * x + 0.25F, 0.5F * y + 0.25F), set(2.0F * q));
        const Number beyond = covered(hn::IfThenElse(on_left, hn::Neg(inside), inside));
        const Number area = hn::IfThenElseZero(is_segment, hn::Mul(beyond, quarter));
        hn::Store(hn::IfThenElse(on_left, area, hn::Neg(area)), kFloats,
                  shares.area[static_cast<std::size_t>(corner)].data() + i);
    }
}

void find_all_shares(const SegmentEnds& segments, float q, CornerShares& shares) {
    for (int i = 0; i < kLanes; i += kStep) find_shares(segments, q, i, shares);
}

using FourLanes = hn::FixedTag<float, 4>;
using FourIntegers = hn::RebindToSigned<FourLanes>;
constexpr FourLanes kFour;
constexpr FourIntegers kFourIntegers;

HWY_INLINE void add_share(hn::Vec<FourLanes> change, float share, ColorShift& shift) {
    const auto scaled = hn::Mul(change, hn::Set(kFour, share * kShiftScale));
    const auto rounded = hn::Floor(hn::Add(scaled, hn::Set(kFour, 0.5F)));
    const auto sum =
        hn::Add(hn::LoadU(kFourIntegers, shift.data()), hn::ConvertTo(kFourIntegers, rounded));
    hn::StoreU(sum, kFourIntegers, shift.data());
}

std::uint32_t spread_all_shares(const CornerShares& shares, const PixelColor* changes, int count,
                                const ShiftPlane& plane) {
    std::uint32_t left = 0;
    for (int k = 0; k < count; ++k) {
        const int x = shares.cell_x[k] - plane.x0;
        const int y = shares.cell_y[k] - plane.y0;
        if (x < 0 || y < 0 || x >= plane.width || y >= plane.height) {
            left |= 1U << k;
            continue;
        }
        const auto column = static_cast<std::size_t>(x);
        const auto row = static_cast<std::size_t>(y);
        const auto change = hn::LoadU(kFour, changes[k].data());
        ColorShift* const upper = plane.shifts + row * plane.stride + column;
        ColorShift* const lower = upper + plane.stride;
        add_share(change, shares.area[0][k], upper[0]);
        add_share(change, shares.area[1][k], upper[1]);
        add_share(change, shares.area[2][k], lower[0]);
        add_share(change, shares.area[3][k], lower[1]);
        std::uint8_t* const above = plane.touched + row / kBlockSide * plane.across;
        std::uint8_t* const below = plane.touched + (row + 1) / kBlockSide * plane.across;
        above[column / kBlockSide] = above[(column + 1) / kBlockSide] = 1;
        below[column / kBlockSide] = below[(column + 1) / kBlockSide] = 1;
    }
    return left;
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_all_shares);
HWY_EXPORT(spread_all_shares);

void find_corner_shares(const SegmentEnds& segments, int lattice, CornerShares& shares) {
    HWY_DYNAMIC_DISPATCH(find_all_shares)(segments, static_cast<float>(lattice), shares);
}

std::uint32_t spread_shares(const CornerShares& shares,
                            const std::array<PixelColor, kLanes>& changes, int count,
                            const ShiftPlane& plane) {
    return HWY_DYNAMIC_DISPATCH(spread_all_shares)(shares, changes.data(), count, plane);
}

}  // namespace ink

#endif

// From numbers of sixteen things, lane by lane, to each thing's numbers side by side; included once
// for each instruction set.

#include <array>

#include "base/block_rows-inl.h"
#include "base/lanes.h"

#if defined(INKTRACE_SIDE_BY_SIDE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_SIDE_BY_SIDE_INL_H
#undef INKTRACE_SIDE_BY_SIDE_INL_H
#else
#define INKTRACE_SIDE_BY_SIDE_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Four = hn::FixedTag<float, 4>;
constexpr Four kFour;

/// The first `count` numbers, a multiple of four, lane by lane.
template <std::size_t kNumbers>
HWY_INLINE void lay_side_by_side(const std::array<Lanes<float>, kNumbers>& form, std::size_t count,
                                 std::array<std::array<float, kNumbers>, kLanes>& forms) {
    constexpr hn::CappedTag<float, kLanes> kTag;
    constexpr std::size_t kAtOnce = hn::MaxLanes(kTag);
    for (std::size_t k = 0; k < count; k += 4) {
        for (std::size_t lane = 0; lane < kLanes; lane += kAtOnce) {
            const auto a = hn::Load(kTag, form[k].data() + lane);
            const auto b = hn::Load(kTag, form[k + 1].data() + lane);
            const auto c = hn::Load(kTag, form[k + 2].data() + lane);
            const auto d = hn::Load(kTag, form[k + 3].data() + lane);
            const auto ac_low = hn::InterleaveLower(kTag, a, c);
            const auto ac_high = hn::InterleaveUpper(kTag, a, c);
            const auto bd_low = hn::InterleaveLower(kTag, b, d);
            const auto bd_high = hn::InterleaveUpper(kTag, b, d);
            // A lane, and every fourth one after it.
            const auto put = [&](std::size_t n, auto numbers) {
                store_rows(kTag, numbers, &forms[lane + n][k], 4 * kNumbers);
            };
            put(0, hn::InterleaveLower(kTag, ac_low, bd_low));
            put(1, hn::InterleaveUpper(kTag, ac_low, bd_low));
            put(2, hn::InterleaveLower(kTag, ac_high, bd_high));
            put(3, hn::InterleaveUpper(kTag, ac_high, bd_high));
        }
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

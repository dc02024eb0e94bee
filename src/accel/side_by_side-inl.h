// From numbers of sixteen things, lane by lane, to each thing's numbers side by side; included once
// for each instruction set.

#include <array>

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
    for (std::size_t k = 0; k < count; k += 4) {
        for (std::size_t lane = 0; lane < kLanes; lane += 4) {
            const auto a = hn::Load(kFour, form[k].data() + lane);
            const auto b = hn::Load(kFour, form[k + 1].data() + lane);
            const auto c = hn::Load(kFour, form[k + 2].data() + lane);
            const auto d = hn::Load(kFour, form[k + 3].data() + lane);
            const auto ac_low = hn::InterleaveLower(kFour, a, c);
            const auto ac_high = hn::InterleaveUpper(kFour, a, c);
            const auto bd_low = hn::InterleaveLower(kFour, b, d);
            const auto bd_high = hn::InterleaveUpper(kFour, b, d);
            hn::StoreU(hn::InterleaveLower(kFour, ac_low, bd_low), kFour, &forms[lane][k]);
            hn::StoreU(hn::InterleaveUpper(kFour, ac_low, bd_low), kFour, &forms[lane + 1][k]);
            hn::StoreU(hn::InterleaveLower(kFour, ac_high, bd_high), kFour, &forms[lane + 2][k]);
            hn::StoreU(hn::InterleaveUpper(kFour, ac_high, bd_high), kFour, &forms[lane + 3][k]);
        }
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

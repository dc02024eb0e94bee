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

/// Four vectors turned round, by blocks of four lanes: block n of the k-th one is what the k-th
/// lanes of block n of the four were.
template <class Tag>
struct TurnedRound {
    hn::Vec<Tag> first, second, third, fourth;

    /// `row(k)` is the k-th of the four.
    template <class Row>
    HWY_INLINE TurnedRound(Tag tag, const Row& row) {
        const auto even_low = hn::InterleaveLower(tag, row(0), row(2));
        const auto even_high = hn::InterleaveUpper(tag, row(0), row(2));
        const auto odd_low = hn::InterleaveLower(tag, row(1), row(3));
        const auto odd_high = hn::InterleaveUpper(tag, row(1), row(3));
        first = hn::InterleaveLower(tag, even_low, odd_low);
        second = hn::InterleaveUpper(tag, even_low, odd_low);
        third = hn::InterleaveLower(tag, even_high, odd_high);
        fourth = hn::InterleaveUpper(tag, even_high, odd_high);
    }
};

/// The first `count` numbers, a multiple of four, lane by lane.
template <std::size_t kNumbers>
HWY_INLINE void lay_side_by_side(const std::array<Lanes<float>, kNumbers>& form, std::size_t count,
                                 std::array<std::array<float, kNumbers>, kLanes>& forms) {
    constexpr hn::CappedTag<float, kLanes> kTag;
    constexpr std::size_t kAtOnce = hn::MaxLanes(kTag);
    for (std::size_t k = 0; k < count; k += 4) {
        for (std::size_t lane = 0; lane < kLanes; lane += kAtOnce) {
            const TurnedRound things(kTag, [&](std::size_t n) HWY_ATTR {
                return hn::Load(kTag, form[k + n].data() + lane);
            });
            // A lane, and every fourth one after it.
            const auto put = [&](std::size_t n, auto numbers) {
                store_rows(kTag, numbers, &forms[lane + n][k], 4 * kNumbers);
            };
            put(0, things.first);
            put(1, things.second);
            put(2, things.third);
            put(3, things.fourth);
        }
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

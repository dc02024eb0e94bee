// Lanes of a vector moved together; included once for each instruction set.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "base/lanes-inl.h"
#include "base/packed_lanes.h"

#if defined(INKTRACE_PACK_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_PACK_LANES_INL_H
#undef INKTRACE_PACK_LANES_INL_H
#else
#define INKTRACE_PACK_LANES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Moves the lanes of a mask to the front, in their order; what comes behind them is not defined.
/// As hn::Compress, which Highway 1.0 makes by copying its table to the stack, a kilobyte a call,
/// where there is no instruction for it.
class LanePacker {
  public:
    HWY_INLINE explicit LanePacker(Mask mask) : mask_(mask), bits_(bits_of(mask)) {}

    HWY_INLINE std::size_t count() const { return static_cast<std::size_t>(std::popcount(bits_)); }

    /// Tag: kFloats or kWords.
    template <class Tag>
    HWY_INLINE hn::Vec<Tag> pack(Tag tag, hn::Vec<Tag> lanes) const {
#if HWY_TARGET <= HWY_AVX3
        return hn::Compress(lanes, hn::RebindMask(tag, mask_));
#else
        const auto shifts = hn::ShiftLeft<2>(hn::Iota(kWords, 0));
        const auto order = hn::Shr(hn::Set(kWords, kPackedLanes[bits_]), shifts);
        const auto last = hn::Set(kWords, static_cast<std::uint32_t>(kStep - 1));
        return hn::TableLookupLanes(lanes, hn::IndicesFromVec(tag, hn::And(order, last)));
#endif
    }

  private:
    [[maybe_unused]] Mask mask_;
    LaneBits bits_;
};

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// Rows of 4 or 8 pixels in vectors of any length; included once for each instruction set.

#include <cstddef>

#include "base/lanes.h"

#if defined(INKTRACE_BLOCK_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_BLOCK_ROWS_INL_H
#undef INKTRACE_BLOCK_ROWS_INL_H
#else
#define INKTRACE_BLOCK_ROWS_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// As many rows of `kAcross` pixels, `stride` apart, as make a vector, or what of one row does, and
/// back.
template <std::size_t kAcross = kBlockSide, class Tag>
HWY_INLINE hn::Vec<Tag> load_rows(Tag tag, const hn::TFromD<Tag>* from, std::size_t stride) {
    if constexpr (hn::MaxLanes(Tag()) <= kAcross) {
        return hn::LoadU(tag, from);
    } else {
        const hn::Half<Tag> half;
        const std::size_t next = hn::MaxLanes(Tag()) / (2 * kAcross) * stride;
        return hn::Combine(tag, load_rows<kAcross>(half, from + next, stride),
                           load_rows<kAcross>(half, from, stride));
    }
}

template <std::size_t kAcross = kBlockSide, class Tag>
HWY_INLINE void store_rows(Tag tag, hn::Vec<Tag> value, hn::TFromD<Tag>* to, std::size_t stride) {
    if constexpr (hn::MaxLanes(Tag()) <= kAcross) {
        hn::StoreU(value, tag, to);
    } else {
        const hn::Half<Tag> half;
        const std::size_t next = hn::MaxLanes(Tag()) / (2 * kAcross) * stride;
        store_rows<kAcross>(half, hn::LowerHalf(half, value), to, stride);
        store_rows<kAcross>(half, hn::UpperHalf(half, value), to + next, stride);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

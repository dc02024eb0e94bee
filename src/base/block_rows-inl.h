// Rows of 4 pixels in vectors of any length; included once for each instruction set.

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

/// As many rows of 4 pixels, `stride` apart, as make a vector, and back.
template <class Tag>
HWY_INLINE hn::Vec<Tag> load_rows(Tag tag, const hn::TFromD<Tag>* from, std::size_t stride) {
    if constexpr (hn::MaxLanes(Tag()) <= kBlockSide) {
        return hn::LoadU(tag, from);
    } else {
        const hn::Half<Tag> half;
        const std::size_t next = hn::MaxLanes(Tag()) / (2 * kBlockSide) * stride;
        return hn::Combine(tag, load_rows(half, from + next, stride),
                           load_rows(half, from, stride));
    }
}

template <class Tag>
HWY_INLINE void store_rows(Tag tag, hn::Vec<Tag> value, hn::TFromD<Tag>* to, std::size_t stride) {
    if constexpr (hn::MaxLanes(Tag()) <= kBlockSide) {
        hn::StoreU(value, tag, to);
    } else {
        const hn::Half<Tag> half;
        const std::size_t next = hn::MaxLanes(Tag()) / (2 * kBlockSide) * stride;
        store_rows(half, hn::LowerHalf(half, value), to, stride);
        store_rows(half, hn::UpperHalf(half, value), to + next, stride);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

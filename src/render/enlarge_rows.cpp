#include "render/enlarge_rows.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/enlarge_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

using Bytes = hn::Repartition<std::uint16_t, Words>;
constexpr Bytes kBytes;

/// Every other byte in sixteen bits of its own, so that products fit: below 255 * 256.
HWY_INLINE Word mixed(Word a, Word b, hn::Vec<Bytes> shares) {
    const auto even = hn::Set(kBytes, 0x00FF);
    const auto rest = hn::Sub(hn::Set(kBytes, 256), shares);
    const auto mix = [&](auto first, auto second) HWY_ATTR {
        return hn::Add(hn::Mul(first, rest), hn::Mul(second, shares));
    };
    const auto a16 = hn::BitCast(kBytes, a);
    const auto b16 = hn::BitCast(kBytes, b);
    const auto low = mix(hn::And(a16, even), hn::And(b16, even));
    const auto high = mix(hn::ShiftRight<8>(a16), hn::ShiftRight<8>(b16));
    return hn::BitCast(kWords, hn::Or(hn::ShiftRight<8>(low), hn::AndNot(even, high)));
}

void mix_rows_lanes(const std::uint32_t* a, const std::uint32_t* b, std::uint32_t share,
                    std::size_t count, std::uint32_t* HWY_RESTRICT out) {
    const auto shares = hn::Set(kBytes, static_cast<std::uint16_t>(share));
    std::size_t k = 0;
    for (; k + kStep <= count; k += kStep) {
        hn::StoreU(mixed(hn::LoadU(kWords, a + k), hn::LoadU(kWords, b + k), shares), kWords,
                   out + k);
    }
    for (; k < count; ++k) {
        const auto one = mixed(hn::Set(kWords, a[k]), hn::Set(kWords, b[k]), shares);
        out[k] = hn::GetLane(one);
    }
}

void mix_columns_lanes(const std::uint32_t* row, const std::int32_t* first,
                       const std::uint32_t* shares, std::size_t count,
                       std::uint32_t* HWY_RESTRICT out) {
    const auto most = hn::Set(kIntegers, kStep - 1);
    std::size_t k = 0;
    while (k + kStep <= count) {
        // As many columns lie between no more than as many and two of the row.
        const std::int32_t begin = first[k];
        const std::uint32_t* const from = row + begin;
        const auto low = hn::LoadU(kWords, from);
        const auto within = [&] {
            return k + kStep <= count && first[k + kStep - 1] + 1 < begin + kStep;
        };
        // Much of a picture is background.
        if (within() && hn::AllTrue(kWords, hn::Eq(low, hn::Set(kWords, *from)))) {
            for (; within(); k += kStep) hn::StoreU(low, kWords, out + k);
            continue;
        }
        const auto own = hn::Sub(hn::LoadU(kIntegers, first + k), hn::Set(kIntegers, begin));
        const auto next = hn::Add(own, hn::Set(kIntegers, 1));
        const auto share = hn::BitCast(kBytes, hn::LoadU(kWords, shares + k));
        const auto from_low = [&](auto places) HWY_ATTR {
            return hn::TableLookupLanes(low, hn::IndicesFromVec(kWords, places));
        };
        if (within()) {
            hn::StoreU(mixed(from_low(own), from_low(next), share), kWords, out + k);
            k += kStep;
            continue;
        }
        const auto high = hn::LoadU(kWords, from + kStep);
        const auto look_up = [&](auto places) HWY_ATTR {
            const auto indices = hn::And(places, most);
            return hn::IfThenElse(hn::RebindMask(kWords, hn::Gt(places, most)),
                                  hn::TableLookupLanes(high, hn::IndicesFromVec(kWords, indices)),
                                  from_low(indices));
        };
        hn::StoreU(mixed(look_up(own), look_up(next), share), kWords, out + k);
        k += kStep;
    }
    for (; k < count; ++k) {
        const auto one = mixed(hn::Set(kWords, row[first[k]]), hn::Set(kWords, row[first[k] + 1]),
                               hn::BitCast(kBytes, hn::Set(kWords, shares[k])));
        out[k] = hn::GetLane(one);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(mix_rows_lanes);
HWY_EXPORT(mix_columns_lanes);

void mix_rows(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
              std::uint32_t share, std::uint32_t* out) {
    HWY_DYNAMIC_DISPATCH(mix_rows_lanes)(first.data(), second.data(), share, first.size(), out);
}

void mix_columns(const std::uint32_t* row, std::span<const std::int32_t> first,
                 const std::uint32_t* shares, std::uint32_t* out) {
    HWY_DYNAMIC_DISPATCH(mix_columns_lanes)(row, first.data(), shares, first.size(), out);
}

}  // namespace ink

#endif

#include "shading/primitive_colors.h"

#include <bit>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/primitive_colors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Primitive by primitive: neighbours mostly hit the same one.
void look_up_lanes(const PrimitiveColors& colors, const LinearTable& linear, const HitPacket& hits,
                   ColorLanes& lanes) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto primitives = load(hits.primitive, i);
        LaneBits left = bits_of(hn::Ne(load(hits.object, i), hn::Set(kWords, kNoObject)));
        auto r = hn::Zero(kFloats);
        auto g = r;
        auto b = r;
        while (left != 0) {
            const std::uint32_t primitive = hits.primitive[i + std::countr_zero(left)];
            const Rgb8 color = colors.of(primitive);
            const auto own =
                hn::RebindMask(kFloats, hn::Eq(primitives, hn::Set(kWords, primitive)));
            left &= ~bits_of(own);
            r = hn::IfThenElse(own, set(linear[color.r]), r);
            g = hn::IfThenElse(own, set(linear[color.g]), g);
            b = hn::IfThenElse(own, set(linear[color.b]), b);
        }
        store(r, lanes.r, i);
        store(g, lanes.g, i);
        store(b, lanes.b, i);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(look_up_lanes);

const LinearTable& linear_table() {
    static const LinearTable kTable = [] {
        LinearTable table{};
        for (std::size_t v = 0; v < table.size(); ++v) {
            table[v] = srgb_decode(static_cast<float>(v) / 255.0F);
        }
        return table;
    }();
    return kTable;
}

void look_up(const PrimitiveColors& colors, const HitPacket& hits, ColorLanes& lanes) {
    HWY_DYNAMIC_DISPATCH(look_up_lanes)(colors, linear_table(), hits, lanes);
}

}  // namespace ink

#endif

#include "render/tiling_lines.h"

#include "base/vec.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/tiling_lines.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void find_nearest_tiling(const TilingLines& lines, const Lanes<float>& x, const Lanes<float>& y,
                         NearestEdges& nearest) {
    constexpr hn::CappedTag<float, kLanes> kFloats;
    const auto set = [&](float value) HWY_ATTR { return hn::Set(kFloats, value); };
    for (int i = 0; i < kLanes; i += static_cast<int>(hn::MaxLanes(kFloats))) {
        const auto qx = hn::Load(kFloats, x.data() + i);
        const auto qy = hn::Load(kFloats, y.data() + i);
        auto distance = set(kInfinity);
        auto nx = set(1.0F);
        auto ny = hn::Zero(kFloats);
        for (std::size_t k = 0; k < lines.count; ++k) {
            const TilingLines::Family& family = lines.families[k];
            const auto at = hn::Add(
                set(family.at), hn::Add(hn::Mul(set(family.dx), qx), hn::Mul(set(family.dy), qy)));
            const auto off = hn::Abs(hn::Sub(at, hn::Round(at)));
            const auto away = hn::Mul(off, set(family.apart));
            const auto nearer = hn::Lt(away, distance);
            distance = hn::IfThenElse(nearer, away, distance);
            nx = hn::IfThenElse(nearer, set(family.nx), nx);
            ny = hn::IfThenElse(nearer, set(family.ny), ny);
        }
        hn::Store(distance, kFloats, nearest.distance.data() + i);
        hn::Store(nx, kFloats, nearest.nx.data() + i);
        hn::Store(ny, kFloats, nearest.ny.data() + i);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_nearest_tiling);

void find_nearest(const TilingLines& lines, const Lanes<float>& x, const Lanes<float>& y,
                  NearestEdges& nearest) {
    HWY_DYNAMIC_DISPATCH(find_nearest_tiling)(lines, x, y, nearest);
}

}  // namespace ink

#endif

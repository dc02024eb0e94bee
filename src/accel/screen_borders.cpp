#include "accel/screen_borders.h"

#include <bit>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_borders.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// A triangle's three sides at a time: each lies as x, y, dx, dy.
void find_packet_sides(const ScreenPacket& packet, PacketSides& sides) {
    using Four = hn::FixedTag<float, 4>;
    constexpr Four kFour;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const float* const form = packet.forms[lane].data();
        const auto first = hn::LoadU(kFour, form);
        const auto second = hn::LoadU(kFour, form + 4);
        const auto third = hn::LoadU(kFour, form + 8);
        const auto pair = hn::InterleaveUpper(kFour, first, second);
        const auto last = hn::InterleaveUpper(kFour, third, third);
        const auto dx = hn::ConcatLowerLower(kFour, last, pair);
        const auto dy = hn::ConcatUpperUpper(kFour, last, pair);
        const auto length = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        const auto scale = hn::Div(hn::Set(kFour, 1.0F), hn::Max(length, hn::Set(kFour, 1e-20F)));
        hn::StoreU(hn::Neg(hn::Mul(dy, scale)), kFour, sides[lane].x.data());
        hn::StoreU(hn::Mul(dx, scale), kFour, sides[lane].y.data());
    }
}

void measure_front(const Front& front, const ScreenPacket* packets, const PacketSides* sides,
                   BorderPacket& borders) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto depth = load(front.depth, i);
        const auto hit = hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity)));
        const auto qx = load(front.x, i);
        const auto qy = load(front.y, i);
        const auto winners = load(front.winner, i);
        auto distance = set(kInfinity);
        auto nx = set(1.0F);  // any unit vector will do where there is no side
        auto ny = hn::Zero(kFloats);
        for (LaneBits left = bits(hit); left != 0;) {
            const std::uint32_t winner = front.winner[i + std::countr_zero(left)];
            const auto own = hn::RebindMask(kFloats, hn::Eq(winners, hn::Set(kIndices, winner)));
            left &= ~bits(own);
            const ScreenPacket& packet = packets[winner / kLanes];
            if (packet.kind != ClusterKind::triangles) continue;
            const std::size_t lane = winner % kLanes;
            const float* const form = packet.forms[lane].data();
            const SideNormals& normals = sides[winner / kLanes][lane];
            const auto won = hn::And(own, hit);
            for (std::size_t k = 0; k < 3; ++k) {
                const auto x = set(normals.x[k]);
                const auto y = set(normals.y[k]);
                const auto off = hn::Add(hn::Mul(x, hn::Sub(qx, set(form[4 * k]))),
                                         hn::Mul(y, hn::Sub(qy, set(form[4 * k + 1]))));
                const auto nearer = hn::And(won, hn::Lt(off, distance));
                distance = hn::IfThenElse(nearer, off, distance);
                nx = hn::IfThenElse(nearer, x, nx);
                ny = hn::IfThenElse(nearer, y, ny);
            }
        }
        // A point that is inside may be outside by rounding.
        hn::Store(hn::Max(distance, hn::Zero(kFloats)), kFloats, borders.distance.data() + i);
        hn::Store(nx, kFloats, borders.nx.data() + i);
        hn::Store(ny, kFloats, borders.ny.data() + i);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_packet_sides);
HWY_EXPORT(measure_front);

void find_sides(const ScreenPacket& packet, PacketSides& sides) {
    HWY_DYNAMIC_DISPATCH(find_packet_sides)(packet, sides);
}

void measure(const Front& front, const ScreenPacket* packets, const PacketSides* sides,
             BorderPacket& borders) {
    HWY_DYNAMIC_DISPATCH(measure_front)(front, packets, sides, borders);
}

}  // namespace ink

#endif

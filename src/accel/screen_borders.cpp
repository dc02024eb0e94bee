#include "accel/screen_borders.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_borders.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

void find_packet_sides(const ScreenPacket& packet, PacketSides& sides) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const auto [x, y, dx, dy] = TriangleLines(packet.forms[lane]);
        const auto length = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        const auto scale = hn::Div(hn::Set(kFour, 1.0F), hn::Max(length, hn::Set(kFour, 1e-20F)));
        hn::StoreU(hn::Neg(hn::Mul(dy, scale)), kFour, sides[lane].x.data());
        hn::StoreU(hn::Mul(dx, scale), kFour, sides[lane].y.data());
    }
}

/// Of each side twice the area between it and the point, over twice that of the triangle.
void find_front_sides(const Front& front, const ScreenPacket* packets, SidesPacket& all) {
    for (int i = 0; i < kLanes; ++i) {
        TriangleSides& sides = all[static_cast<std::size_t>(i)];
        const std::uint32_t winner = front.winner[i];
        const bool hit = front.depth[i] < kInfinity && front.depth[i] > -kInfinity;
        if (!hit || packets[winner / kLanes].kind != ClusterKind::triangles) {
            sides = TriangleSides::none();
            continue;
        }
        const TriangleLines sides_of(packets[winner / kLanes].forms[winner % kLanes]);
        const auto areas = sides_of.at(front.x[i], front.y[i]);
        std::array<float, 4> of_sides;
        hn::StoreU(areas, kFour, of_sides.data());
        const float area = of_sides[0] + of_sides[1] + of_sides[2];
        const auto scale = hn::Set(kFour, 1.0F / std::max(area, 1e-20F));
        const auto inside = hn::Mul(areas, scale);
        const auto step_x = hn::Neg(hn::Mul(sides_of.dy, scale));
        static_assert(offsetof(TriangleSides, dx) == sizeof(sides.inside));
        hn::StoreU(hn::ConcatLowerLower(kFour, step_x, inside), kFour, sides.inside.data());
        hn::Store(hn::LowerHalf(hn::Mul(sides_of.dx, scale)), hn::Half<Four>(), sides.dy.data());
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
        for (LaneBits left = bits_of(hit); left != 0;) {
            const std::uint32_t winner = front.winner[i + std::countr_zero(left)];
            const auto own = hn::RebindMask(kFloats, hn::Eq(winners, hn::Set(kWords, winner)));
            left &= ~bits_of(own);
            const ScreenPacket& packet = packets[winner / kLanes];
            if (packet.kind != ClusterKind::triangles) continue;
            const std::size_t lane = winner % kLanes;
            const float* const form = packet.forms[lane].data();
            const SideNormals& normals = sides[winner / kLanes][lane];
            const auto won = hn::And(own, hit);
            for (std::size_t k = 0; k < 3; ++k) {
                const auto x = set(normals.x[k]);
                const auto y = set(normals.y[k]);
                const auto off = hn::Add(hn::Mul(x, hn::Sub(qx, set(form[k]))),
                                         hn::Mul(y, hn::Sub(qy, set(form[4 + k]))));
                const auto nearer = hn::And(won, hn::Lt(off, distance));
                distance = hn::IfThenElse(nearer, off, distance);
                nx = hn::IfThenElse(nearer, x, nx);
                ny = hn::IfThenElse(nearer, y, ny);
            }
        }
        // A point that is inside may be outside by rounding.
        store(hn::Max(distance, hn::Zero(kFloats)), borders.distance, i);
        store(nx, borders.nx, i);
        store(ny, borders.ny, i);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_front_sides);
HWY_EXPORT(find_packet_sides);
HWY_EXPORT(measure_front);

void find_sides(const ScreenPacket& packet, PacketSides& sides) {
    HWY_DYNAMIC_DISPATCH(find_packet_sides)(packet, sides);
}

void find_sides(const Front& front, const ScreenPacket* packets, SidesPacket& sides) {
    HWY_DYNAMIC_DISPATCH(find_front_sides)(front, packets, sides);
}

void measure(const Front& front, const ScreenPacket* packets, const PacketSides* sides,
             BorderPacket& borders) {
    HWY_DYNAMIC_DISPATCH(measure_front)(front, packets, sides, borders);
}

}  // namespace ink

#endif

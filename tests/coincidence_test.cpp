// Which of several surfaces is seen that lie in one place.

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "scenes.h"
#include "seen.h"

namespace ink::test {
namespace {

void expect_first_wins(const std::vector<HitPacket>& packets, std::uint32_t primitives) {
    int hits = 0;
    for (const HitPacket& packet : packets) {
        for (int i = 0; i < kLanes; ++i) {
            if (packet.object[i] == kNoObject) continue;
            ++hits;
            EXPECT_EQ(packet.object[i], 0U);
            EXPECT_LT(packet.primitive[i], primitives);
        }
    }
    EXPECT_GT(hits, 1000);
}

/// Every hit belongs to the lowest object, and there to one of its first `primitives`; by Embree,
/// too.
void expect_first_wins(const Seen& seen, std::uint32_t primitives) {
    const auto points = seen.random_points(7, 2000);
    expect_first_wins(seen.trace(points), primitives);
    for (const PacketWidth width : {PacketWidth::four, PacketWidth::eight, PacketWidth::sixteen}) {
        const auto embree = make_embree_tracer(seen.scene(), width);
        for (const Coherence coherence : {Coherence::coherent, Coherence::incoherent}) {
            expect_first_wins(seen.trace(*embree, points, coherence), primitives);
        }
    }
}

ViewSettings oblique_view() {
    ViewSettings view;
    view.eye = Vec3d{3.1, 2.3, 4.7};
    view.look_at = Vec3d{0.1, 0.05, -0.02};
    return view;
}

TEST(Coincidence, PrefersTheFirstOfTrianglesThatAreThereTwice) {
    const std::vector<Vec3f> corners{
        {-1, -0.9F, 0.1F}, {1, -1, 0.3F}, {0.9F, 1, -0.2F}, {-1, 1.1F, 0.17F}};
    const std::vector<Mesh::Triangle> once{{0, 1, 2}, {0, 2, 3}};
    for (const Mesh::Triangle& order : {Mesh::Triangle{0, 1, 2}, {1, 2, 0}, {2, 1, 0}, {1, 0, 2}}) {
        std::vector<Mesh::Triangle> twice = once;
        for (const Mesh::Triangle& triangle : once) {
            twice.push_back({triangle[order[0]], triangle[order[1]], triangle[order[2]]});
        }
        expect_first_wins(Seen({mesh_object(corners, twice)}, oblique_view(), {512, 512}), 2);
    }
}

TEST(Coincidence, PrefersTheFirstOfObjectsThatShareAFace) {
    const auto square = [](const std::vector<Mesh::Triangle>& triangles) {
        return mesh_object({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, triangles);
    };
    // Cut along the other diagonal.
    expect_first_wins(Seen({square({{0, 1, 2}, {0, 2, 3}}), square({{1, 2, 3}, {1, 3, 0}})},
                           oblique_view(), {512, 512}),
                      2);
    // Twenty of them: more than a depth can be set back by.
    std::vector<Object> stack;
    for (int i = 0; i < 20; ++i) {
        stack.push_back(i % 2 == 0 ? square({{0, 1, 2}, {0, 2, 3}})
                                   : square({{1, 2, 3}, {1, 3, 0}}));
    }
    expect_first_wins(Seen(std::move(stack), oblique_view(), {512, 512}), 2);
}

TEST(Coincidence, PrefersTheFirstOfBoxesThatFillTheSamePlace) {
    Object object;
    object.kind = ObjectKind::shape;
    Placement turned;
    turned.x_axis = {0, 1, 0};
    turned.y_axis = {-1, 0, 0};
    object.shape = Glyphs{{GlyphKind::box}, {Placement{}, turned, Placement{}}, {}, {}};
    expect_first_wins(Seen({object}, oblique_view(), {512, 512}), 1);
    const Object solid = hexahedron_object({box_corners({-1, -1, -1}, {1, 1, 1})});
    expect_first_wins(Seen({object, solid}, oblique_view(), {512, 512}), 1);
    expect_first_wins(Seen({solid, object}, oblique_view(), {512, 512}), 1);
}

}  // namespace
}  // namespace ink::test

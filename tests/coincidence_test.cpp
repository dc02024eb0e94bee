// Which of several surfaces is seen that lie in one place.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "scenes.h"
#include "seen.h"
#include "set_ray.h"

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

Hexahedra::Corners cube_at(Vec3f lower, float side) {
    Hexahedra::Corners corners;
    for (std::size_t k = 0; k < 8; ++k) {
        const bool right = k % 4 == 1 || k % 4 == 2;
        corners[k] =
            lower + Vec3f{right ? side : 0.0F, k % 4 >= 2 ? side : 0.0F, k >= 4 ? side : 0.0F};
    }
    return corners;
}

// Embree's distances to boxes err the more, the flatter a ray meets their sides.
TEST(Coincidence, PrefersTheFirstHoweverFlatTheRay) {
    constexpr Vec3f kLower{0.2F, -0.1F, 0.2525F};
    // About the origin and of a size such that the scene's frame is that of these numbers.
    const Scene scene(
        {hexahedron_object({cube_at(kLower, 0.2F)}),
         hexahedron_object({cube_at(kLower - Vec3f{0.1F, 0.1F, 0.0F}, 0.2F)}),
         sphere_object({{{-0.5F, -0.5F, -0.5F}, 0.01F}, {{0.5F, 0.5F, 0.5F}, 0.01F}})});
    ASSERT_NEAR(scene.bounds().upper.z, 0.51F, 1e-6F);
    std::mt19937 random(3);
    std::vector<RayPacket> rays(2000);
    for (RayPacket& packet : rays) {
        packet.active.fill(-1);
        for (int i = 0; i < kLanes; ++i) {
            const float angle = 6.28F * uniform(random);
            const float rise = std::pow(10.0F, -4.0F + 3.0F * uniform(random));
            const Vec3f dir = normalize(Vec3f{std::cos(angle), std::sin(angle), rise});
            // Where both of them have a face, from up to a tenth before it.
            const Vec3f target = kLower + Vec3f{0.01F + 0.08F * uniform(random),
                                                0.01F + 0.08F * uniform(random), 0.0F};
            const Vec3f from = target - dir * (0.01F + 0.1F * uniform(random));
            set_ray(packet, i, from, dir);
        }
    }
    for (const PacketWidth width : {PacketWidth::four, PacketWidth::eight, PacketWidth::sixteen}) {
        const auto embree = make_embree_tracer(scene, width);
        for (const Coherence coherence : {Coherence::coherent, Coherence::incoherent}) {
            std::vector<HitPacket> hits(rays.size());
            embree->intersect(rays, hits, coherence);
            int seconds = 0;
            int all = 0;
            for (const HitPacket& packet : hits) {
                for (const std::uint32_t object : packet.object) {
                    all += object != kNoObject ? 1 : 0;
                    seconds += object == 1 ? 1 : 0;
                }
            }
            EXPECT_GT(all, 30000);
            EXPECT_EQ(seconds, 0);
        }
    }
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

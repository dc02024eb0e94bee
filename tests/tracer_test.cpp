#include "accel/tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "scenes.h"
#include "set_ray.h"

namespace ink::test {
namespace {

/// Rays from within and around the scene to points in its middle.
std::vector<RayPacket> random_rays(unsigned seed, std::size_t packets) {
    std::mt19937 random(seed);
    std::vector<RayPacket> rays(packets);
    for (RayPacket& packet : rays) {
        for (int lane = 0; lane < kLanes; ++lane) {
            const Vec3f origin = uniform_point(random) * 3.0F - Vec3f{1.5F, 1.5F, 1.5F};
            const Vec3f target = (uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 0.9F;
            set_ray(packet, lane, origin, normalize(target - origin));
        }
    }
    return rays;
}

std::vector<HitPacket> trace(const Tracer& tracer, const std::vector<RayPacket>& rays,
                             Coherence coherence = Coherence::incoherent) {
    std::vector<HitPacket> hits(rays.size());
    tracer.intersect(rays, hits, coherence);
    return hits;
}

struct Agreement {
    int rays = 0, hits = 0, different = 0;
    float t_error = 0.0F, normal_error = 0.0F;
};

Agreement compare(const std::vector<HitPacket>& a, const std::vector<HitPacket>& b) {
    Agreement result;
    for (std::size_t k = 0; k < a.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            ++result.rays;
            if (a[k].object[i] != b[k].object[i] ||
                (a[k].object[i] != kNoObject && a[k].primitive[i] != b[k].primitive[i])) {
                ++result.different;
                continue;
            }
            if (a[k].object[i] == kNoObject) {
                EXPECT_TRUE(std::isinf(a[k].t[i]) && std::isinf(b[k].t[i]));
                continue;
            }
            ++result.hits;
            result.t_error = std::max(result.t_error, std::abs(a[k].t[i] - b[k].t[i]));
            const Vec3f n{a[k].normal_x[i], a[k].normal_y[i], a[k].normal_z[i]};
            const Vec3f m{b[k].normal_x[i], b[k].normal_y[i], b[k].normal_z[i]};
            result.normal_error =
                std::max(result.normal_error, length(normalize(n) - normalize(m)));
        }
    }
    return result;
}

class EveryTracerPath : public testing::TestWithParam<PacketWidth> {};

/// `most`: rays that may pass within rounding of an outline, one in a few thousand.
void expect_hits_of_brute_force(const Scene& scene, PacketWidth width, int most) {
    const auto rays = random_rays(11, 400);
    const auto embree = make_embree_tracer(scene, width);
    const auto oracle = make_brute_force_tracer(scene);
    const Agreement result = compare(trace(*oracle, rays), trace(*embree, rays));
    EXPECT_GT(result.hits, result.rays / 4);
    EXPECT_LE(result.different, most) << "of " << result.rays;
    EXPECT_LT(result.t_error, 2e-5F);
    EXPECT_LT(result.normal_error, 2e-2F);  // at a contour the normal turns by sqrt(2 eps)
}

TEST_P(EveryTracerPath, HitsWhatBruteForceHits) {
    expect_hits_of_brute_force(Scene(random_objects(7, 300, 400)), GetParam(), 3);
}

TEST_P(EveryTracerPath, HitsCopiesWhereBruteForceHitsThem) {
    expect_hits_of_brute_force(Scene(random_copies(7, 100, 200)), GetParam(), 4);
}

/// Copies of sticks, as copies or written out.
Scene many_sticks(bool written_out) {
    Object object = copied_sticks(7, 60);
    if (written_out) {
        auto& sticks = std::get<Glyphs>(object.shape);
        std::vector<Placement> all;
        for (std::size_t i = 0; i < sticks.count(); ++i) all.push_back(sticks.at(i));
        sticks.placements = std::move(all);
        sticks.copies.clear();
    }
    return Scene({std::move(object)});
}

TEST_P(EveryTracerPath, HitsCopiesOfGlyphsAsThoseThatTheyStandFor) {
    const Scene copies = many_sticks(false);
    const Scene written_out = many_sticks(true);
    const auto rays = random_rays(11, 400);
    for (const Coherence coherence : {Coherence::coherent, Coherence::incoherent}) {
        const auto expected = trace(*make_embree_tracer(written_out, GetParam()), rays, coherence);
        const auto seen = trace(*make_embree_tracer(copies, GetParam()), rays, coherence);
        const Agreement result = compare(expected, seen);
        EXPECT_GT(result.hits, result.rays / 4);
        EXPECT_LE(result.different, 4) << "of " << result.rays;
        EXPECT_LT(result.t_error, 2e-5F);
        EXPECT_LT(result.normal_error, 2e-2F);
    }
}

void expect_same_crossings(const Tracer& tracer, const Tracer& oracle) {
    std::size_t crossings = 0;
    for (const RayPacket& rays : random_rays(5, 20)) {
        SurfaceHits hits;
        SurfaceHits expected;
        tracer.cross(rays, hits);
        oracle.cross(rays, expected);
        for (std::size_t i = 0; i < kLanes; ++i) {
            std::vector<std::uint32_t> primitives;
            std::vector<std::uint32_t> wanted;
            for (const SurfaceHit& hit : hits[i]) primitives.push_back(hit.primitive);
            for (const SurfaceHit& hit : expected[i]) wanted.push_back(hit.primitive);
            std::ranges::sort(primitives);
            std::ranges::sort(wanted);
            EXPECT_EQ(primitives, wanted);
            crossings += wanted.size();
        }
    }
    EXPECT_GT(crossings, 400U);
}

TEST(Tracer, CrossesCopiesAsTheSpheresThatTheyStandFor) {
    const Scene scene(random_copies(7, 60, 0));
    expect_same_crossings(*make_embree_tracer(scene), *make_brute_force_tracer(scene));
}

TEST(Tracer, CrossesCopiesAsTheGlyphsThatTheyStandFor) {
    const Scene copies = many_sticks(false);
    const Scene written_out = many_sticks(true);
    expect_same_crossings(*make_embree_tracer(copies), *make_embree_tracer(written_out));
}

TEST_P(EveryTracerPath, IsBlockedWhereBruteForceIs) {
    std::vector<Object> objects = random_objects(7, 300, 400);
    Object glyphs;
    glyphs.name = "boxes";
    Glyphs boxes{.shape = {.kind = GlyphKind::box}, .placements = {}, .colors = {}, .parts = {}};
    for (int i = 0; i < 2; ++i) {
        Placement box{{0.1F, 0, 0}, {0, 0.2F, 0}, {0, 0, 0.1F}, {}};
        box.origin = {0.1F + 0.2F * static_cast<float>(i), 0.1F, 0.1F};
        boxes.placements.push_back(box);
    }
    glyphs.shape = std::move(boxes);
    objects.push_back(std::move(glyphs));
    const Scene scene(std::move(objects));
    auto rays = random_rays(11, 40);
    rays[0].active[3] = 0;
    std::vector<Lanes<float>> reach(rays.size(), Lanes<float>::filled(0.7F));
    reach[1].fill(kInfinity);
    std::vector<Lanes<std::int32_t>> blocked(rays.size());
    std::vector<Lanes<std::int32_t>> expected(rays.size());
    make_embree_tracer(scene, GetParam())->occluded(rays, reach, blocked);
    make_brute_force_tracer(scene)->occluded(rays, reach, expected);
    EXPECT_EQ(blocked[0][3], 0);
    int hits = 0;
    int different = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            hits += expected[k][i] != 0 ? 1 : 0;
            different += blocked[k][i] != expected[k][i] ? 1 : 0;
        }
    }
    EXPECT_GT(hits, 60);
    EXPECT_LE(different, 3);
}

TEST_P(EveryTracerPath, LeavesInactiveRaysAlone) {
    const Scene scene(random_objects(7, 300, 400));
    auto rays = random_rays(12, 20);
    const auto embree = make_embree_tracer(scene, GetParam());
    const auto all = trace(*embree, rays);
    for (RayPacket& packet : rays) {
        for (int i = 0; i < kLanes; i += 3) packet.active[i] = 0;
    }
    const auto some = trace(*embree, rays);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            const bool active = i % 3 != 0;
            EXPECT_EQ(some[k].object[i], active ? all[k].object[i] : kNoObject);
            EXPECT_EQ(some[k].t[i], active ? all[k].t[i] : kInfinity);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Packets, EveryTracerPath,
                         testing::Values(PacketWidth::four, PacketWidth::eight,
                                         PacketWidth::sixteen, PacketWidth::widest),
                         [](const auto& width) {
                             return width.param == PacketWidth::widest
                                        ? std::string("Widest")
                                        : "Of" + std::to_string(static_cast<int>(width.param));
                         });

TEST(TracerPaths, AgreeAmongThemselvesOnCoherentRays) {
    const Scene scene(random_objects(3, 500, 500));
    std::vector<RayPacket> rays(64 * 64);
    for (int k = 0; k < 64 * 64; ++k) {
        for (int i = 0; i < kLanes; ++i) {
            const float x = (static_cast<float>(k % 64 * 4 + i % 4) + 0.5F) / 128.0F - 1.0F;
            const float y = (static_cast<float>(k / 64 * 4 + i / 4) + 0.5F) / 128.0F - 1.0F;
            set_ray(rays[static_cast<std::size_t>(k)], i, {0, 0, 3},
                    normalize(Vec3f{0.2F * x, 0.2F * y, -1.0F}));
        }
    }
    const auto sixteen =
        trace(*make_embree_tracer(scene, PacketWidth::sixteen), rays, Coherence::coherent);
    for (const PacketWidth width : {PacketWidth::eight, PacketWidth::four}) {
        const Agreement result =
            compare(sixteen, trace(*make_embree_tracer(scene, width), rays, Coherence::coherent));
        EXPECT_GT(result.hits, result.rays / 4);
        EXPECT_LE(result.different, 4) << "of " << result.rays;
        EXPECT_LT(result.t_error, 2e-5F);
    }
}

TEST(Tracer, SeesTheFarSideFromInsideASphere) {
    const Scene scene({sphere_object({{{0, 0, 0}, 1}})});
    RayPacket rays{};
    rays.active.fill(-1);
    for (int i = 0; i < kLanes; ++i) set_ray(rays, i, {0.1F, 0, 0}, {1, 0, 0});
    const float radius = std::get<Spheres>(scene.objects()[0].shape).spheres[0].radius;
    for (const auto& tracer : {make_embree_tracer(scene), make_brute_force_tracer(scene)}) {
        const auto hits = trace(*tracer, {rays});
        EXPECT_EQ(hits[0].object[0], 0U);
        EXPECT_NEAR(hits[0].t[0], radius - 0.1F, 1e-6F);
    }
}

}  // namespace
}  // namespace ink::test

#include "accel/candidates.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "accel/bounds_pyramid.h"
#include "accel/cluster_bands.h"
#include "accel/clusters.h"
#include "accel/tracer.h"
#include "camera/camera.h"
#include "scenes.h"

namespace ink::test {
namespace {

TEST(Clusters, OfCopiesShareAllButTheirBounds) {
    std::vector<Object> once = random_objects(7, 1000, 0);
    std::vector<Object> copied = random_copies(7, 1000, 0);
    once.pop_back();
    copied.pop_back();
    const Scene one(std::move(once));
    const Scene four(std::move(copied));
    const Clusters alone(one);
    const Clusters copies(four);
    EXPECT_EQ(copies.spheres.size(), alone.spheres.size());
    EXPECT_EQ(copies.order.size(), alone.order.size());
    EXPECT_EQ(copies.clusters.size(), 4 * alone.clusters.size());
}

TEST(Candidates, AreTheSameInBandsAndInTheTree) {
    const Scene scene(random_objects(11, 3000, 3000));
    const Clusters clusters(scene);
    ViewSettings oblique;
    oblique.eye = Vec3d{3.1, 2.3, 4.7};
    const Camera camera(scene, oblique, {512, 384});
    const Projection& projection = camera.projection();
    const BoundsPyramid pyramid(clusters, Basis(projection));
    const ClusterBands bands(pyramid, clusters.clusters.size(), projection.centre);
    Candidates sorted(pyramid, &bands);
    Candidates searched(pyramid, nullptr);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-300.0F, 300.0F);
    std::exponential_distribution<float> size(1.0F / 30.0F);
    std::size_t met = 0;
    for (int n = 0; n < 500; ++n) {
        Window window{place(random), 0, place(random), 0, kInfinity};
        window.right = window.left + size(random);
        window.bottom = window.top + size(random);
        std::vector<std::uint32_t> found[2];
        for (Candidates* candidates : {&sorted, &searched}) {
            candidates->enter(window);
            while (candidates->find_more(kInfinity)) {
            }
            for (std::size_t i = 0; i < candidates->count(); ++i) {
                found[candidates == &sorted ? 0 : 1].push_back(candidates->cluster(i));
            }
            EXPECT_TRUE(candidates->reach(window) || candidates->count() == 0);
        }
        EXPECT_EQ(found[0], found[1]);
        met += found[0].size();
    }
    EXPECT_GT(met, 5000U);
}

TEST(Candidates, ReachNoBoxBetweenTwoObjects) {
    const Scene scene({sphere_object({{{-1, 0, 0}, 0.1F}}), sphere_object({{{1, 0, 0}, 0.1F}})});
    const Clusters clusters(scene);
    const Camera camera(scene, {}, {256, 256});
    const Projection& projection = camera.projection();
    const BoundsPyramid pyramid(clusters, Basis(projection));
    const ClusterBands bands(pyramid, clusters.clusters.size(), projection.centre);
    const Candidates candidates(pyramid, &bands);
    EXPECT_TRUE(candidates.reach({-128, 0, -2, 2, kInfinity}));
    EXPECT_TRUE(candidates.reach({0, 128, -2, 2, kInfinity}));
    EXPECT_FALSE(candidates.reach({-8, 8, -8, 8, kInfinity}));
}

TEST(ScreenFrame, SeesNothingBetweenTwoObjects) {
    const Scene scene({sphere_object({{{-1, 0, 0}, 0.1F}}), sphere_object({{{1, 0, 0}, 0.1F}})});
    const Camera camera(scene, {}, {256, 256});
    const auto tracer = make_tracer(scene);
    const auto frame = tracer->frame(camera.projection(), 1);
    EXPECT_TRUE(frame->may_see({0, 126, 128, 130}));
    EXPECT_TRUE(frame->may_see({128, 126, 256, 130}));
    EXPECT_FALSE(frame->may_see({120, 120, 136, 136}));
}

TEST(ClusterBands, SayOfARowOfBoxesWhatTheySayOfEach) {
    std::mt19937 random(21);
    std::vector<Sphere> spheres;
    for (int k = 0; k < 60; ++k) {
        spheres.push_back({{uniform(random), uniform(random), uniform(random)}, 0.01F});
    }
    const Scene scene({sphere_object(spheres)});
    const Clusters clusters(scene);
    const Camera camera(scene, {}, {512, 384});
    const Projection& projection = camera.projection();
    const BoundsPyramid pyramid(clusters, Basis(projection));
    const ClusterBands bands(pyramid, clusters.clusters.size(), projection.centre);
    int reached = 0;
    for (const float step : {4.0F, 2.0F, 1.0F}) {
        for (const float wider : {0.0F, 0.5F, 6.0F}) {
            for (int count = 1; count <= 64; count += 7) {
                for (float top = -200.0F; top < 200.0F; top += 12.0F) {
                    const Window first{-264.0F + 8.0F * static_cast<float>(count) - wider,
                                       -264.0F + 8.0F * static_cast<float>(count) + step + wider,
                                       top - wider, top + step + wider, kInfinity};
                    const std::uint64_t bits = bands.reached(first, step, count);
                    for (int k = 0; k < 64; ++k) {
                        const float right = static_cast<float>(k) * step;
                        const Window box{first.left + right, first.right + right, first.top,
                                         first.bottom, kInfinity};
                        const bool in_row = (bits >> k & 1U) != 0;
                        EXPECT_EQ(in_row, k < count && bands.reach(box)) << count << " " << k;
                        reached += in_row ? 1 : 0;
                    }
                }
            }
        }
    }
    EXPECT_GT(reached, 1000);
}

}  // namespace
}  // namespace ink::test

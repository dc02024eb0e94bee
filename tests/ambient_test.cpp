// Ambient occlusion: how far surfaces lie open to the sky, against closed forms and rays.

#include "shading/ambient.h"
#include "base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include "drawing.h"
#include "io/reader.h"
#include "paths.h"
#include "render/render.h"
#include "sampling/sampler.h"
#include "scenes.h"
#include "shading/ball_sky.h"
#include "shading/ray_sky.h"
#include "shading/secondary_rays.h"

namespace ink::test {
namespace {

Settings seen_from_front(int side) {
    Settings settings;
    settings.size = {side, side};
    settings.view.view = View::front;
    settings.threads = 1;
    return settings;
}

/// At random places of a cube of side 1, of radii from `least` on.
std::vector<Sphere> random_balls(unsigned seed, int count, float least, float spread) {
    std::mt19937 random(seed);
    std::vector<Sphere> balls;
    for (int i = 0; i < count; ++i) {
        balls.push_back({uniform_point(random), least + spread * uniform(random)});
    }
    return balls;
}

struct Seen {
    Vec3f point, normal;
    float open;
};

/// What a picture of `side` pixels finds, at one of so many of its pixels.
std::vector<Seen> look_at(const Scene& scene, const Tracer& tracer, const AmbientBake& bake,
                          int side, unsigned one_of, View view = View::front,
                          SmallBalls small = SmallBalls::by_point) {
    Settings settings = seen_from_front(side);
    settings.view.view = view;
    const Camera camera(scene, settings.view, settings.size);
    const auto frame = tracer.frame(camera.projection(), 1);
    const auto ambient = bake.seen_by(camera, small);
    Sampler sampler(*frame, camera);
    std::mt19937 random(7);
    std::vector<Seen> seen;
    std::vector<HitPacket> hits(1);
    for (int y = 0; y < side; y += kBlockSide) {
        for (int x = 0; x < side; x += kBlockSide) {
            sampler.trace_blocks(std::vector{Block{x, y}}, {}, hits);
            const NormalPacket normals{hits[0].normal_x, hits[0].normal_y, hits[0].normal_z};
            const RayPacket& rays = sampler.packets()[0];
            std::vector<int> chosen;
            for (int i = 0; i < kLanes; ++i) {
                if (hits[0].object[i] != kNoObject && random() % one_of == 0) chosen.push_back(i);
            }
            if (chosen.empty()) continue;
            Lanes<float> open;
            ambient->openness({rays, sampler.points()[0], hits[0], normals}, open);
            for (const int i : chosen) {
                const float t = hits[0].t[i];
                seen.push_back(
                    {{rays.origin_x[i] + t * rays.dir_x[i], rays.origin_y[i] + t * rays.dir_y[i],
                      rays.origin_z[i] + t * rays.dir_z[i]},
                     {normals.x[i], normals.y[i], normals.z[i]},
                     open[i]});
            }
        }
    }
    return seen;
}

/// Whether rays that start just above a point start within another ball, which it all but touches:
/// they tell nothing.
bool starts_within_a_ball(const Scene& scene, const Seen& at) {
    const Vec3f start = at.point + at.normal * kLiftOff;
    for (const Object& object : scene.objects()) {
        const auto* shape = std::get_if<Spheres>(&object.shape);
        for (std::size_t k = 0; shape != nullptr && k < shape->count(); ++k) {
            const Sphere ball = shape->at(k);
            if (length(start - ball.centre) < ball.radius) return true;
        }
    }
    return false;
}

/// Openness of a scene as the bake finds it, against 8192 rays at the same points.
class Comparison {
  public:
    Comparison(const Scene& scene, int quality)
        : scene_(scene),
          tracer_(make_tracer(scene)),
          bake_(scene, *tracer_, quality),
          truth_(*tracer_, 8192) {}

    /// Root of the mean square of the difference, at one of so many pixels.
    double error(int side, unsigned one_of, View view = View::front) const {
        std::vector<Seen> seen = look_at(scene_, *tracer_, bake_, side, one_of, view);
        std::erase_if(seen, [this](const Seen& at) { return starts_within_a_ball(scene_, at); });
        EXPECT_GT(seen.size(), 200U);
        double sum = 0.0;
        for (const Seen& at : seen) {
            const double difference = at.open - truth_.openness(at.point, at.normal);
            sum += difference * difference;
        }
        return std::sqrt(sum / static_cast<double>(seen.size()));
    }

  private:
    const Scene& scene_;
    std::unique_ptr<Tracer> tracer_;
    AmbientBake bake_;
    RaySky truth_;
};

TEST(AmbientOcclusion, OfAMoleculeIsWithinOneHundredthOfThatByRays) {
    const std::filesystem::path file = source_dir() / "samples" / "acetaminophen.xyz";
    const Scene scene(read_file(file).objects);
    const Comparison comparison(scene, 3);
    EXPECT_LT(comparison.error(512, 150), 0.01);
    EXPECT_LT(comparison.error(128, 15), 0.01);
}

TEST(AmbientOcclusion, OfAProteinIsWithinOneHundredthOfThatByRays) {
    const std::filesystem::path file = data_dir() / "molecules" / "4hhb.pdb";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    const Scene scene(read_file(file).objects);
    EXPECT_LT(Comparison(scene, 3).error(1024, 900), 0.01);
    EXPECT_LT(Comparison(scene, 4).error(1024, 1200), 0.008);
}

TEST(AmbientOcclusion, OfARibosomeIsWithinOneHundredthOfThatByRays) {
    const std::filesystem::path file = data_dir() / "molecules" / "1ffk_ribosome50S.cif.gz";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    const Scene scene(read_file(file).objects);
    const Comparison comparison(scene, 3);
    for (const View view : {View::front, View::iso, View::top, View::left}) {
        EXPECT_LT(comparison.error(1024, 1500, view), 0.01);
    }
    EXPECT_LT(Comparison(scene, 5).error(1024, 1600), 0.0065);
}

/// Strings of balls stand for the sticks.
TEST(AmbientOcclusion, OfSticksIsNearThatByRays) {
    const std::filesystem::path file = source_dir() / "samples" / "acetaminophen.xyz";
    for (const Representation how : {Representation::sticks, Representation::ball_and_stick}) {
        ReadOptions options;
        options.data.representation = how;
        const Scene scene(read_file(file, options).objects);
        ASSERT_EQ(scene.objects().size(), 2U);
        EXPECT_LT(Comparison(scene, 3).error(256, 25), 0.006);
        EXPECT_LT(Comparison(scene, 5).error(160, 11), 0.006);
    }
}

/// As in drafts.
TEST(AmbientOcclusion, OfSmallBallsByNodesIsNearThatByPoints) {
    const std::vector<Sphere> balls = random_balls(8, 3000, 0.03F, 0.01F);
    const Scene scene({sphere_object(balls)});
    const auto tracer = make_tracer(scene);
    constexpr int kSide = 128;  // radii of 2 to 3 pixels
    const AmbientBake bake(scene, *tracer, 3);
    const auto by_point = look_at(scene, *tracer, bake, kSide, 1);
    look_at(scene, *tracer, bake, kSide, 1, View::iso, SmallBalls::by_nodes);
    const auto by_nodes =
        look_at(scene, *tracer, bake, kSide, 1, View::front, SmallBalls::by_nodes);
    ASSERT_EQ(by_nodes.size(), by_point.size());
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t k = 0; k < by_point.size(); ++k) {
        const double difference = by_nodes[k].open - by_point[k].open;
        sum += difference;
        squares += difference * difference;
    }
    const auto count = static_cast<double>(by_point.size());
    EXPECT_LT(std::abs(sum / count), 0.006);
    EXPECT_LT(std::sqrt(squares / count), 0.025);
    // Whatever was seen before.
    const AmbientBake fresh(scene, *tracer, 3);
    const auto again = look_at(scene, *tracer, fresh, kSide, 1, View::front, SmallBalls::by_nodes);
    for (std::size_t k = 0; k < again.size(); ++k) EXPECT_EQ(again[k].open, by_nodes[k].open);
}

TEST(AmbientOcclusion, GetsBetterWithQuality) {
    const std::vector<Sphere> balls = random_balls(3, 400, 0.02F, 0.08F);
    const Scene scene({sphere_object(balls)});
    const double low = Comparison(scene, 1).error(192, 22);
    const double high = Comparison(scene, 5).error(192, 22);
    EXPECT_LT(high, 0.6 * low);
    EXPECT_LT(high, 0.02);
}

TEST(BallSky, ContactsLeaveTheSameOpenToSixteenPointsAsToEach) {
    std::mt19937 random(11);
    const auto any_way = [&] {
        return normalize(uniform_point(random) * 2.0F - Vec3f{1.0F, 1.0F, 1.0F});
    };
    for (int used = 0; used <= kLanes; ++used) {
        BallPacket contacts{};
        for (int i = 0; i < used; ++i) {
            const Vec3f towards = any_way();
            contacts.radius[i] = 0.2F + uniform(random);
            const float distance = 1.0F + contacts.radius[i] * (0.6F + 0.6F * uniform(random));
            contacts.x[i] = towards.x * distance;
            contacts.y[i] = towards.y * distance;
            contacts.z[i] = towards.z * distance;
        }
        NormalPacket normals{};
        for (int i = 0; i < kLanes; ++i) {
            const Vec3f n = any_way();
            normals.x[i] = n.x;
            normals.y[i] = n.y;
            normals.z[i] = n.z;
        }
        Lanes<float> open;
        BallSky::contact_openness(contacts, 1.0F, normals, open);
        for (int i = 0; i < kLanes; ++i) {
            const Vec3f n{normals.x[i], normals.y[i], normals.z[i]};
            ASSERT_EQ(open[i], BallSky::contact_openness(contacts, 1.0F, n));
        }
    }
}

TEST(AmbientOcclusion, OfOneBallIsNone) {
    const Scene scene({sphere_object({{{0, 0, 0}, 1}})});
    const auto tracer = make_tracer(scene);
    const AmbientBake bake(scene, *tracer, 3);
    for (const Seen& at : look_at(scene, *tracer, bake, 64, 1)) ASSERT_GT(at.open, 0.999F);
}

/// A ball of radius R at distance d from a point hides (R / d)^2 cos of its sky, as long as it is
/// wholly above the horizon.
TEST(AmbientOcclusion, OfAFarBallIsItsFormFactor) {
    const Scene scene({sphere_object({{{0, 0, 0}, 1}, {{0, 0, 6}, 2}})});
    const auto tracer = make_tracer(scene);
    const AmbientBake bake(scene, *tracer, 5);
    Settings settings = seen_from_front(64);
    settings.view.view = View::right;
    const Camera camera(scene, settings.view, settings.size);
    const auto ambient = bake.seen_by(camera);
    const Frame& frame = scene.frame();
    const Vec3f centre = frame.from_world({0, 0, 0});
    const auto radius = static_cast<float>(1.0 / frame.unit);
    for (const double tilt : {0.0, 0.3, 0.6, 0.9}) {
        const Vec3f n{static_cast<float>(std::sin(tilt)), 0.0F, static_cast<float>(std::cos(tilt))};
        const Vec3d to = Vec3d{0, 0, 6} - to_double(n);
        const double d = length(to);
        const double expected = 1.0 - 4.0 / (d * d) * dot(to, to_double(n)) / d;
        RayPacket rays{};
        PointPacket points{};
        HitPacket hits = HitPacket::miss();
        NormalPacket normals{};
        const Vec3f p = centre + n * radius;
        for (int i = 0; i < kLanes; ++i) {
            rays.origin_x[i] = p.x + n.x;
            rays.origin_y[i] = p.y + n.y;
            rays.origin_z[i] = p.z + n.z;
            rays.dir_x[i] = -n.x;
            rays.dir_y[i] = -n.y;
            rays.dir_z[i] = -n.z;
            normals.x[i] = n.x;
            normals.y[i] = n.y;
            normals.z[i] = n.z;
            hits.t[i] = 1.0F;
            hits.object[i] = 0;
            hits.primitive[i] = 0;
        }
        Lanes<float> open;
        ambient->openness({rays, points, hits, normals}, open);
        EXPECT_NEAR(open[0], expected, 0.01) << tilt;
    }
}

/// A floor of triangles below a ball, by rays at the nodes of the floor's grid.
TEST(AmbientOcclusion, OfAMeshIsNearThatByRays) {
    Object floor =
        mesh_object({{-4, -1, -4}, {4, -1, -4}, {4, -1, 4}, {-4, -1, 4}}, {{0, 2, 1}, {0, 3, 2}});
    const Scene scene({std::move(floor), sphere_object({{{0, 0, 0}, 1}})});
    const auto tracer = make_tracer(scene);
    const AmbientBake bake(scene, *tracer, 4);
    const RaySky truth(*tracer, 4096);
    Settings settings = seen_from_front(256);
    double sum = 0.0;
    const std::vector<Seen> seen = look_at(scene, *tracer, bake, 256, 60);
    for (const Seen& at : seen) {
        const double difference = at.open - truth.openness(at.point, at.normal);
        sum += difference * difference;
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(seen.size())), 0.02);
}

TEST(AmbientOcclusion, IsGivenUpWhenToldTo) {
    const std::filesystem::path file = source_dir() / "samples" / "acetaminophen.xyz";
    const Scene scene(read_file(file).objects);
    const auto tracer = make_tracer(scene);
    AmbientCache cache;
    std::atomic<bool> cancel = true;
    EXPECT_THROW(cache.get(scene, *tracer, 3, &cancel), Cancelled);
    cancel = false;
    EXPECT_NE(cache.get(scene, *tracer, 3, &cancel), nullptr);
}

TEST(AmbientOcclusion, IsTheSameWhateverTheThreadsTilesAndWhatWasSeenBefore) {
    const std::vector<Sphere> balls = random_balls(5, 300, 0.03F, 0.06F);
    for (const bool with_mesh : {false, true}) {
        std::vector<Object> objects{sphere_object(balls)};
        if (with_mesh) {
            objects.push_back(
                mesh_object({{-1, -1, 0.5F}, {2, -1, 0.5F}, {0.5F, 2, 0.5F}}, {{0, 1, 2}}));
        }
        const Scene scene(std::move(objects));
        const auto tracer = make_tracer(scene);
        Settings settings = seen_from_front(96);
        settings.shading.ambient = 1.0F;
        settings.tile = 64;
        const auto pixels = [&](AmbientCache* kept) {
            RenderControl control;
            control.ambient = kept;
            return render(scene, *tracer, settings, {}, control).display().pixels;
        };
        const auto expected = pixels(nullptr);
        settings.threads = 3;
        settings.tile = 16;
        EXPECT_EQ(pixels(nullptr), expected);
        AmbientCache kept;
        settings.view.view = View::iso;
        pixels(&kept);
        settings.view.view = View::front;
        EXPECT_EQ(pixels(&kept), expected);
        EXPECT_EQ(pixels(&kept), expected);
    }
}

/// Pixels between others are not all computed: also where a tile ends between them.
TEST(AmbientOcclusion, OfSmallBallsAndSticksIsTheSameWhateverTheTiles) {
    const std::vector<Sphere> balls = random_balls(6, 300, 0.06F, 0.03F);
    ReadOptions options;
    options.data.representation = Representation::sticks;
    const std::filesystem::path file = source_dir() / "samples" / "acetaminophen.xyz";
    for (const auto& objects :
         {std::vector{sphere_object(balls)}, read_file(file, options).objects}) {
        const Scene scene(objects);
        Settings settings = seen_from_front(150);
        settings.shading.ambient = 1.0F;
        settings.tile = 256;
        const auto expected = draw(scene, settings).display().pixels;
        for (const int tile : {4, 12, 36}) {
            settings.tile = tile;
            EXPECT_EQ(draw(scene, settings).display().pixels, expected) << tile;
        }
    }
}

TEST(AmbientOcclusion, AndLinesOfCopiesAreThoseOfSpheresWrittenOut) {
    std::vector<Object> copied = random_copies(3, 60, 0);
    copied.pop_back();
    const auto& shape = std::get<Spheres>(copied[0].shape);
    std::vector<Sphere> all;
    for (std::size_t k = 0; k < shape.count(); ++k) all.push_back(shape.at(k));
    Object written_out = copied[0];
    written_out.shape = Spheres{.spheres = std::move(all), .colors = {}, .parts = {}};
    const auto pixels = [](const Object& object) {
        const Scene scene({object});
        Settings settings = seen_from_front(128);
        settings.shading.ambient = 1.0F;
        return render(scene, *make_tracer(scene), settings).display().pixels;
    };
    const auto seen = pixels(copied[0]);
    const auto expected = pixels(written_out);
    std::size_t differing = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
        for (unsigned shift = 0; shift < 32; shift += 8) {
            const int difference = static_cast<int>(seen[k] >> shift & 255U) -
                                   static_cast<int>(expected[k] >> shift & 255U);
            differing += std::abs(difference) > 3 ? 1 : 0;
        }
    }
    EXPECT_LE(differing, seen.size() / 500);  // centres differ in their last digit
}

TEST(AmbientOcclusion, IsTheDefaultOfParticlesAndNotOfMeshes) {
    const auto same = [](const std::vector<Object>& objects, std::string_view value) {
        const Scene scene(objects);
        const Settings settings = seen_from_front(64);
        Settings changed = settings;
        find_setting("ambient").set(changed, value);
        return draw(scene, settings).display().pixels == draw(scene, changed).display().pixels;
    };
    const std::vector<Object> balls{sphere_object({{{0, 0, 0}, 1}, {{1.5F, 0, 0.5F}, 1}})};
    EXPECT_TRUE(same(balls, "1"));
    EXPECT_FALSE(same(balls, "0"));
    const std::vector<Object> mesh{
        mesh_object({{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 1}}, {{0, 1, 2}, {0, 2, 3}})};
    EXPECT_TRUE(same(mesh, "0"));
}

}  // namespace
}  // namespace ink::test

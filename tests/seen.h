#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "accel/screen_tracer.h"
#include "camera/camera.h"
#include "instruction_sets.h"
#include "scenes.h"

/// What the screen tracer sees, held against other tracers.
namespace ink::test {

constexpr Size kSmall{128, 128};

/// A scene, a camera, and what the screen tracer and brute force see through it.
class Seen {
  public:
    using MakeOracle = std::unique_ptr<Tracer> (*)(const Scene&);

    Seen(std::vector<Object> objects, const ViewSettings& view, Size size,
         MakeOracle make_oracle = make_brute_force_tracer)
        : scene_(std::move(objects)),
          clusters_(scene_),
          camera_(scene_, view, size),
          size_(size),
          frame_(make_screen_tracer(clusters_, camera_.projection())),
          oracle_(make_oracle(scene_)) {
        EXPECT_TRUE(camera_.projection().sees_all());
    }

    const Camera& camera() const { return camera_; }
    const Scene& scene() const { return scene_; }

    /// Pixel centres, or points at random, sixteen a packet.
    std::vector<PointPacket> pixels() const {
        std::vector<PointPacket> points;
        for (int y = 0; y < size_.height; y += kBlockSide) {
            for (int x = 0; x < size_.width; x += kBlockSide) {
                PointPacket packet{};
                for (int i = 0; i < kLanes; ++i) {
                    packet.x[i] = static_cast<float>(x + i % kBlockSide) + 0.5F;
                    packet.y[i] = static_cast<float>(y + i / kBlockSide) + 0.5F;
                }
                points.push_back(packet);
            }
        }
        return points;
    }
    std::vector<PointPacket> random_points(unsigned seed, std::size_t packets) const {
        std::mt19937 random(seed);
        std::vector<PointPacket> points(packets);
        for (PointPacket& packet : points) {
            for (int i = 0; i < kLanes; ++i) {
                packet.x[i] = uniform(random) * static_cast<float>(size_.width);
                packet.y[i] = uniform(random) * static_cast<float>(size_.height);
            }
        }
        return points;
    }

    std::vector<HitPacket> trace(const std::vector<PointPacket>& points) const {
        return trace(points, whole());
    }
    std::vector<HitPacket> trace(const std::vector<PointPacket>& points,
                                 const ScreenBox& area) const {
        const auto tracer = frame_->tile_tracer();
        tracer->enter(area);
        std::vector<HitPacket> hits(points.size());
        tracer->intersect(points, rays(points), hits);
        return hits;
    }
    /// The first packets are the cells of a raster.
    std::vector<HitPacket> trace_raster(const std::vector<PointPacket>& points) const {
        std::vector<HitPacket> hits(points.size());
        find_raster(points)->resolve(0, points, rays(points), hits);
        return hits;
    }
    /// Likewise.
    std::vector<BorderPacket> measure_raster(const std::vector<PointPacket>& points) const {
        EXPECT_TRUE(frame_->measures_borders());
        std::vector<BorderPacket> borders(points.size());
        find_raster(points)->measure(0, borders);
        return borders;
    }
    std::vector<HitPacket> trace_brute_force(const std::vector<PointPacket>& points) const {
        return trace(*oracle_, points, Coherence::incoherent);
    }
    std::vector<HitPacket> trace(const Tracer& tracer, const std::vector<PointPacket>& points,
                                 Coherence coherence) const {
        std::vector<HitPacket> hits(points.size());
        tracer.intersect(rays(points), hits, coherence);
        return hits;
    }
    std::unique_ptr<TileTracer> tile_tracer() const {
        auto tracer = frame_->tile_tracer();
        tracer->enter(whole());
        return tracer;
    }
    ScreenBox whole() const {
        return {0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height)};
    }

    std::unique_ptr<TileTracer> find_raster(const std::vector<PointPacket>& points) const {
        auto tracer = frame_->tile_tracer();
        tracer->want_borders();
        tracer->enter(whole());
        const int across = size_.width / kBlockSide;
        const int down = size_.height / kBlockSide;
        std::vector<std::uint32_t> cells(static_cast<std::size_t>(across * down));
        std::iota(cells.begin(), cells.end(), 0U);
        tracer->find({0, 0, across * kBlockSide, down * kBlockSide, 1.0F, {}, cells, cells.size()},
                     points);
        return tracer;
    }
    std::vector<RayPacket> rays(const std::vector<PointPacket>& points) const {
        std::vector<RayPacket> rays(points.size());
        for (std::size_t k = 0; k < points.size(); ++k) {
            camera_.make_rays(points[k].x, points[k].y, rays[k]);
        }
        return rays;
    }

  private:
    Scene scene_;
    Clusters clusters_;
    Camera camera_;
    Size size_;
    std::unique_ptr<FrameTracer> frame_;
    std::unique_ptr<Tracer> oracle_;
};

inline bool same_primitive(const HitPacket& a, const HitPacket& b, int i) {
    return a.object[i] == b.object[i] &&
           (a.object[i] == kNoObject || a.primitive[i] == b.primitive[i]);
}

/// Whether brute force sees `wanted` through some point within `reach` pixels.
inline bool seen_nearby(const Seen& seen, Vec2f at, float reach, const HitPacket& wanted,
                        int lane) {
    PointPacket around{};
    for (int i = 0; i < kLanes; ++i) {
        const double angle = i * std::numbers::pi / 8.0;
        around.x[i] = at.x + reach * static_cast<float>(std::cos(angle));
        around.y[i] = at.y + reach * static_cast<float>(std::sin(angle));
    }
    const HitPacket hits = seen.trace_brute_force({around})[0];
    for (int i = 0; i < kLanes; ++i) {
        if (hits.object[i] == wanted.object[lane] &&
            (hits.object[i] == kNoObject || hits.primitive[i] == wanted.primitive[lane])) {
            return true;
        }
    }
    return false;
}

struct Tolerance {
    float pixels = 2e-4F;  ///< to an outline, where either answer is right
    float t = 1e-5F;       ///< where the surface faces the viewer
};

/// Every ray hits what brute force hits, unless an outline runs close by.
inline void expect_same_hits(const Seen& seen, const std::vector<PointPacket>& points,
                             Tolerance tolerance = {}) {
    const auto screen = seen.trace(points);
    const auto brute = seen.trace_brute_force(points);
    int hits = 0;
    int different = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            const Vec2f at{points[k].x[i], points[k].y[i]};
            if (!same_primitive(screen[k], brute[k], i)) {
                ++different;
                EXPECT_TRUE(seen_nearby(seen, at, tolerance.pixels, screen[k], i))
                    << at.x << ", " << at.y;
                continue;
            }
            if (brute[k].object[i] == kNoObject) {
                EXPECT_TRUE(std::isinf(screen[k].t[i]));
                continue;
            }
            ++hits;
            const Vec3f n =
                normalize(Vec3f{brute[k].normal_x[i], brute[k].normal_y[i], brute[k].normal_z[i]});
            const float facing = std::abs(dot(n, seen.camera().back()));
            EXPECT_NEAR(screen[k].t[i], brute[k].t[i], tolerance.t / std::max(facing, 1e-2F));
            if (facing < 0.1F) continue;
            const Vec3f m = normalize(
                Vec3f{screen[k].normal_x[i], screen[k].normal_y[i], screen[k].normal_z[i]});
            EXPECT_GT(std::abs(dot(m, n)), 1.0F - 1e-3F);
            EXPECT_NEAR(screen[k].u[i], brute[k].u[i], 2e-3F);
            EXPECT_NEAR(screen[k].v[i], brute[k].v[i], 2e-3F);
        }
    }
    EXPECT_GT(hits, 0);
    EXPECT_LE(different, 5 + hits / 1000);
}

inline void expect_same_bits(const HitPacket& a, int i, const HitPacket& b, int j) {
    EXPECT_EQ(a.t[i], b.t[j]);
    EXPECT_EQ(a.normal_x[i], b.normal_x[j]);
    EXPECT_EQ(a.normal_y[i], b.normal_y[j]);
    EXPECT_EQ(a.normal_z[i], b.normal_z[j]);
    EXPECT_EQ(a.u[i], b.u[j]);
    EXPECT_EQ(a.v[i], b.v[j]);
    EXPECT_EQ(a.primitive[i], b.primitive[j]);
    EXPECT_EQ(a.object[i], b.object[j]);
}

/// At all pixels of the picture.
inline void expect_same_bits_on_every_instruction_set(const Seen& seen) {
    const auto points = seen.pixels();
    const auto native = seen.trace(points);
    on_every_instruction_set([&] {
        const auto hits = seen.trace(points);
        for (std::size_t k = 0; k < points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) expect_same_bits(hits[k], i, native[k], i);
        }
    });
}

}  // namespace ink::test

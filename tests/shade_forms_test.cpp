// Normals that things are shaded by, as camera rays give them without being made.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "accel/screen_tracer.h"
#include "camera/camera.h"
#include "instruction_sets.h"
#include "scenes.h"

namespace ink::test {
namespace {

constexpr int kSide = 128;  // pixels

/// Loose triangles, whose corners have normals of their own within `spread` of the triangle's.
Object random_triangles(unsigned seed, int count, float spread) {
    std::mt19937 random(seed);
    Object object = mesh_object({}, {});
    auto& mesh = std::get<Mesh>(object.shape);
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(count); ++k) {
        const Vec3f middle = uniform_point(random);
        std::array<Vec3f, 3> corners;
        for (Vec3f& corner : corners) corner = middle + uniform_point(random) * 0.3F;
        const Vec3f n = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
        std::array<std::uint32_t, 3> normals{};
        for (std::uint32_t& normal : normals) {
            normal = pack_normal(normalize(n + uniform_point(random) * spread));
        }
        mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
        mesh.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
        mesh.corner_normals.push_back(normals);
    }
    return object;
}

/// Spheres, and glyphs of which some show their back.
std::vector<Object> random_solids(unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Sphere> spheres;
    for (int k = 0; k < 100; ++k) spheres.push_back({uniform_point(random), 0.15F});
    std::vector<Object> objects{sphere_object(std::move(spheres))};
    for (const GlyphKind kind : {GlyphKind::ellipsoid, GlyphKind::frustum, GlyphKind::disc}) {
        objects.push_back(random_glyphs({.kind = kind, .a = 0.5}, 60, 0.3, random));
    }
    return objects;
}

/// Pixel centres, and what their rays see.
struct Shaded {
    std::vector<PointPacket> points;
    std::vector<HitPacket> hits;
    std::vector<NormalPacket> normals;
    std::vector<PlacePacket> places;
};

class View {
  public:
    View(std::vector<Object> objects, const ViewSettings& view)
        : scene_(std::move(objects)),
          clusters_(scene_),
          camera_(scene_, view, {kSide, kSide}),
          frame_(make_screen_tracer(clusters_, camera_.projection())) {}

    const Camera& camera() const { return camera_; }
    const FrameTracer& frame() const { return *frame_; }
    const Mesh& mesh(std::uint32_t object) const {
        return std::get<Mesh>(scene_.objects()[object].shape);
    }

    /// All of the picture packet by packet.
    Shaded shade_packets() const { return shade({}); }
    /// The first columns of its points as a raster.
    Shaded shade_raster(int columns = kSide) const {
        std::vector<std::uint32_t> cells(kPackets);
        std::iota(cells.begin(), cells.end(), 0U);
        return shade({0, 0, columns, kSide, 1.0F, {}, cells, cells.size()});
    }

  private:
    static constexpr std::size_t kPackets = (kSide / kBlockSide) * (kSide / kBlockSide);

    Shaded shade(const BlockRaster& raster) const {
        Shaded seen;
        const int across = kSide / kBlockSide;
        for (int k = 0; k < across * across; ++k) {
            PointPacket packet{};
            for (int i = 0; i < kLanes; ++i) {
                packet.x[i] = static_cast<float>(k % across * kBlockSide + i % kBlockSide) + 0.5F;
                packet.y[i] = static_cast<float>(k / across * kBlockSide + i / kBlockSide) + 0.5F;
            }
            seen.points.push_back(packet);
        }
        // Of a raster it is told where its points lie.
        const std::vector<PointPacket> blank(kPackets);
        const auto tracer = frame_->tile_tracer();
        tracer->want_shades();
        tracer->enter({0, 0, kSide, kSide});
        tracer->find(raster, raster.packets > 0 ? blank : seen.points);
        seen.hits.resize(seen.points.size());
        seen.normals.resize(seen.points.size());
        seen.places.resize(seen.points.size());
        tracer->see(0, seen.hits, seen.normals, seen.places);
        return seen;
    }

    Scene scene_;
    Clusters clusters_;
    Camera camera_;
    std::unique_ptr<FrameTracer> frame_;
};

Vec3d normal_of(const NormalPacket& normals, int i) {
    return {normals.x[i], normals.y[i], normals.z[i]};
}
Vec3d facet_of(const HitPacket& hits, int i) {
    return {hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]};
}
Vec3d place_of(const PlacePacket& places, int i) { return {places.x[i], places.y[i], places.z[i]}; }
double angle(Vec3d a, Vec3d b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

/// The ray through a point of the screen.
struct Ray {
    Vec3d origin, dir;

    Ray(const Projection& p, double x, double y) {
        const Vec3d across = p.right * (x - p.centre.x) + p.down * (y - p.centre.y);
        origin = p.start + across * p.origin_step;
        dir = p.forward + across * p.slope_step;
    }
};

/// A triangle in double precision, and where a ray meets its plane.
struct Exact {
    std::array<Vec3d, 3> corners, normals;
    Vec3d facet;
    double height;  ///< over the longest side

    Exact(const Mesh& mesh, std::uint32_t triangle) {
        double longest = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = to_double(mesh.vertices[mesh.triangles[triangle][k]]);
            if (mesh.corner_normals.empty()) continue;
            // Corners count by their octahedral length.
            const Vec3d n = to_double(unpack_normal(mesh.corner_normals[triangle][k]));
            normals[k] = n / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
        }
        for (std::size_t k = 0; k < 3; ++k) {
            longest = std::max(longest, length(corners[k] - corners[(k + 1) % 3]));
        }
        facet = cross(corners[1] - corners[0], corners[2] - corners[0]);
        height = length(facet) / longest;
    }

    Vec3d normal_at(const Ray& ray) const {
        const double t = dot(facet, corners[0] - ray.origin) / dot(facet, ray.dir);
        const Vec3d p = ray.origin + ray.dir * t;
        Vec3d sum{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d a = corners[(k + 1) % 3];
            const Vec3d b = corners[(k + 2) % 3];
            sum = sum + normals[k] * (dot(cross(a - p, b - p), facet) / dot(facet, facet));
        }
        return sum;
    }
};

/// Views in perspective, from nearby, and in parallel.
std::vector<ViewSettings> views() {
    ViewSettings near;
    near.eye = Vec3d{1.9, 1.2, 2.0};
    near.fov_deg = 70.0;
    ViewSettings parallel;
    parallel.orthographic = 0.0;
    return {{}, near, parallel};
}

TEST(ShadeForms, InterpolateNormalsAsOnTheSurface) {
    for (const ViewSettings& settings : views()) {
        const View view({random_triangles(3, 300, 0.8F)}, settings);
        const Projection projection = view.camera().projection();
        const Shaded seen = view.shade_raster();
        int hits = 0;
        for (std::size_t k = 0; k < seen.points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) {
                if (seen.hits[k].object[i] == kNoObject) continue;
                const Exact exact(view.mesh(0), seen.hits[k].primitive[i]);
                const Ray ray(projection, seen.points[k].x[i], seen.points[k].y[i]);
                const Vec3d facet = facet_of(seen.hits[k], i);
                const double facing = -dot(facet, ray.dir) / length(ray.dir);
                // Corners are rounded on the screen, which a triangle seen at a slant shows most.
                const double tolerance = 2e-6 / (exact.height * facing) + 2e-6;
                if (tolerance > 1e-3) continue;
                ++hits;
                EXPECT_NEAR(length(facet), 1.0, 1e-6);
                EXPECT_LT(length(cross(facet, exact.facet)), 1e-5 * length(exact.facet));
                Vec3d normal = exact.normal_at(ray);
                if (dot(normal, facet) < 0.0) normal = normal * -1.0;
                const double near_edge = std::abs(dot(normal, facet)) / length(normal);
                if (near_edge < 1e-2) continue;  // either side is right
                EXPECT_LT(angle(normal, normal_of(seen.normals[k], i)), tolerance);
                EXPECT_NEAR(length(normal_of(seen.normals[k], i)), 1.0, 1e-6);
            }
        }
        EXPECT_GT(hits, 1000);
    }
}

TEST(ShadeForms, FaceTheViewer) {
    for (const ViewSettings& settings : views()) {
        const View view({random_triangles(4, 300, 0.5F)}, settings);
        const Shaded seen = view.shade_raster();
        for (std::size_t k = 0; k < seen.points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) {
                if (seen.hits[k].object[i] == kNoObject) continue;
                const Ray ray(view.camera().projection(), seen.points[k].x[i], seen.points[k].y[i]);
                EXPECT_LT(dot(facet_of(seen.hits[k], i), ray.dir), 1e-4);
                EXPECT_GE(dot(facet_of(seen.hits[k], i), normal_of(seen.normals[k], i)), -1e-6);
            }
        }
    }
}

TEST(ShadeForms, LieWhereTheRayMeetsTheTriangle) {
    for (const ViewSettings& settings : views()) {
        const View view({random_triangles(9, 300, 0.5F)}, settings);
        const Shaded seen = view.shade_raster();
        int hits = 0;
        for (std::size_t k = 0; k < seen.points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) {
                if (seen.hits[k].object[i] == kNoObject) continue;
                ++hits;
                const Exact exact(view.mesh(0), seen.hits[k].primitive[i]);
                const Ray ray(view.camera().projection(), seen.points[k].x[i], seen.points[k].y[i]);
                const Vec3d way = ray.dir / length(ray.dir);
                const Vec3d place = place_of(seen.places[k], i);
                const double t = seen.hits[k].t[i];
                EXPECT_LT(length(place - (ray.origin + way * t)), 2e-6);
                // On the triangle, whose depth is rounded the more the more it is turned away.
                const double along = dot(exact.facet, way);
                const double off = dot(exact.facet, place - exact.corners[0]) / along;
                EXPECT_LT(std::abs(off), 2e-6 + 1e-7 * length(exact.facet) / std::abs(along));
            }
        }
        EXPECT_GT(hits, 1000);
    }
}

TEST(ShadeForms, OfFlatMeshesAreTheirFacets) {
    Object flat = random_triangles(5, 200, 0.5F);
    std::get<Mesh>(flat.shape).corner_normals.clear();
    const View view({flat, random_triangles(6, 200, 0.5F)}, {});
    const Shaded seen = view.shade_raster();
    int hits = 0;
    for (std::size_t k = 0; k < seen.points.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            if (seen.hits[k].object[i] != 0) continue;
            ++hits;
            EXPECT_EQ(normal_of(seen.normals[k], i), facet_of(seen.hits[k], i));
        }
    }
    EXPECT_GT(hits, 1000);
}

void expect_same_bits(const View& view) {
    const Shaded native = view.shade_raster();
    const auto expect_same = [&](const Shaded& seen) {
        for (std::size_t k = 0; k < seen.points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) {
                EXPECT_EQ(seen.hits[k].object[i], native.hits[k].object[i]);
                if (native.hits[k].object[i] == kNoObject) continue;
                EXPECT_EQ(seen.hits[k].primitive[i], native.hits[k].primitive[i]);
                EXPECT_EQ(seen.hits[k].t[i], native.hits[k].t[i]);
                EXPECT_EQ(facet_of(seen.hits[k], i), facet_of(native.hits[k], i));
                EXPECT_EQ(normal_of(seen.normals[k], i), normal_of(native.normals[k], i));
                EXPECT_EQ(place_of(seen.places[k], i), place_of(native.places[k], i));
            }
        }
    };
    expect_same(view.shade_packets());
    on_every_instruction_set([&] { expect_same(view.shade_raster()); });
}

TEST(ShadeForms, AreTheSameBitsForRastersAndPacketsOnEveryInstructionSet) {
    expect_same_bits(View({random_triangles(7, 300, 0.8F)}, {}));
    expect_same_bits(View(random_solids(7), {}));
}

TEST(ShadeForms, OfARasterEndWithItsPoints) {
    const View view({random_triangles(11, 400, 0.5F)}, {});
    constexpr int kColumns = kSide - 3;
    const Shaded whole = view.shade_raster();
    const Shaded cut = view.shade_raster(kColumns);
    for (std::size_t k = 0; k < whole.points.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            const bool within = whole.points[k].x[i] < static_cast<float>(kColumns);
            EXPECT_EQ(cut.hits[k].object[i], within ? whole.hits[k].object[i] : kNoObject);
        }
    }
}

void expect_seen_as_by_rays(const View& view) {
    const Shaded seen = view.shade_raster();
    const auto tracer = view.frame().tile_tracer();
    tracer->enter({0, 0, kSide, kSide});
    int hits = 0;
    for (std::size_t k = 0; k < seen.points.size(); ++k) {
        RayPacket rays;
        HitPacket by_ray;
        view.camera().make_rays(seen.points[k].x, seen.points[k].y, rays);
        tracer->intersect({&seen.points[k], 1}, {&rays, 1}, {&by_ray, 1});
        for (int i = 0; i < kLanes; ++i) {
            EXPECT_EQ(seen.hits[k].object[i], by_ray.object[i]);
            EXPECT_EQ(seen.hits[k].t[i], by_ray.t[i]);
            const Vec3d normal = normal_of(seen.normals[k], i);
            EXPECT_EQ(facet_of(seen.hits[k], i), normal);
            if (by_ray.object[i] == kNoObject) {
                EXPECT_EQ(length(normal), 0.0);
                continue;
            }
            ++hits;
            EXPECT_EQ(seen.hits[k].primitive[i], by_ray.primitive[i]);
            const Vec3d dir{rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]};
            const Vec3d origin{rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]};
            const double t = by_ray.t[i];
            EXPECT_LT(length(place_of(seen.places[k], i) - (origin + dir * t)), 1e-6);
            const Vec3d own = facet_of(by_ray, i);
            const double side = dot(own, dir) > 0.0 ? -1.0 : 1.0;
            // Of an edge's grazing ray, rounding decides on which side it passes.
            if (std::abs(dot(normalize(own), normalize(dir))) < 1e-5) continue;
            EXPECT_LT(angle(normal, own * side), 1e-5);
            EXPECT_NEAR(length(normal), 1.0, 1e-6);
        }
    }
    EXPECT_GT(hits, 1000);
}

TEST(ShadeForms, OfSpheresAndGlyphsAreWhatTheirRaysSee) {
    expect_seen_as_by_rays(View(random_solids(12), {}));
    ViewSettings parallel;
    parallel.orthographic = 2.0;
    expect_seen_as_by_rays(View(random_solids(13), parallel));
}

TEST(ShadeForms, AreOfTrianglesAloneOrOfNone) {
    EXPECT_TRUE(View({random_triangles(8, 10, 0.5F)}, {}).frame().sees_without_rays());
    EXPECT_TRUE(View(random_solids(8), {}).frame().sees_without_rays());
    const View mixed({random_triangles(8, 10, 0.5F), sphere_object({{{0, 0, 0}, 0.5F}})}, {});
    EXPECT_FALSE(mixed.frame().sees_without_rays());
}

}  // namespace
}  // namespace ink::test

// Where lines cross the way between two points, from the shape of a mesh, against rays and closed
// forms.

#include "sampling/mesh_crosser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "camera/camera.h"
#include "scenes.h"

namespace ink::test {
namespace {

using Kind = MeshCrossing::Kind;

Object prepared(std::vector<Vec3f> vertices, std::vector<Mesh::Triangle> triangles) {
    Object object = mesh_object(std::move(vertices), std::move(triangles));
    auto& mesh = std::get<Mesh>(object.shape);
    weld(mesh);
    smooth_normals(mesh);
    return object;
}

/// A sphere about the origin in rows and columns; `radius_at` for each vertex.
Object globe(int rows, const std::function<float()>& radius_at) {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    const int columns = 2 * rows;
    std::vector<float> radii;
    for (int i = 0; i < (rows + 1) * columns; ++i) radii.push_back(radius_at());
    const auto number = [&](int row, int column) {
        return static_cast<std::uint32_t>(row * columns + column % columns);
    };
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double a = std::numbers::pi * row / rows;
            const double b = std::numbers::pi * column / rows;
            // The poles are one vertex each.
            const bool pole = row == 0 || row == rows;
            const double r = radii[number(row, pole ? 0 : column)];
            const double s = pole ? 0.0 : std::sin(a);
            vertices.push_back(to_float(Vec3d{s * std::cos(b), std::cos(a), s * std::sin(b)} * r));
            if (row == rows) continue;
            triangles.push_back(
                {number(row, column), number(row, column + 1), number(row + 1, column)});
            triangles.push_back(
                {number(row, column + 1), number(row + 1, column + 1), number(row + 1, column)});
        }
    }
    return prepared(std::move(vertices), std::move(triangles));
}

Object box(Vec3d low, Vec3d high) {
    std::vector<Vec3f> vertices;
    for (int k = 0; k < 8; ++k) {
        vertices.push_back(
            to_float(Vec3d{(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                           (k & 4) != 0 ? high.z : low.z}));
    }
    return prepared(std::move(vertices), {{0, 2, 3},
                                          {0, 3, 1},
                                          {4, 5, 7},
                                          {4, 7, 6},
                                          {0, 1, 5},
                                          {0, 5, 4},
                                          {2, 6, 7},
                                          {2, 7, 3},
                                          {0, 4, 6},
                                          {0, 6, 2},
                                          {1, 3, 7},
                                          {1, 7, 5}});
}

/// What one ray sees.
struct Sight {
    SurfaceKey key;
    float t = kInfinity;
};

/// A scene, a camera, and what each point of the screen sees, by brute force.
class Seen {
  public:
    static constexpr int kSide = 96;  ///< of the picture, pixels

    explicit Seen(std::vector<Object> objects, const ViewSettings& view = {})
        : scene_(std::move(objects)),
          camera_(scene_, view, {kSide, kSide}),
          walk_(scene_, camera_.projection(), NormalSource::automatic),
          tracer_(make_brute_force_tracer(scene_)) {}

    Sight at(Vec2f p) const {
        RayPacket ray;
        camera_.make_rays(Lanes<float>::filled(p.x), Lanes<float>::filled(p.y), ray);
        for (int i = 1; i < kLanes; ++i) ray.active[i] = 0;
        HitPacket hits;
        tracer_->intersect({&ray, 1}, {&hits, 1}, Coherence::incoherent);
        if (hits.object[0] == kNoObject) return {};
        return {{hits.object[0], hits.primitive[0]}, hits.t[0]};
    }

    /// In the frame of the world, on the ray through a point of the screen.
    Vec3d world(Vec2f p, float t) const {
        RayPacket ray;
        camera_.make_rays(Lanes<float>::filled(p.x), Lanes<float>::filled(p.y), ray);
        const Vec3f at = Vec3f{ray.origin_x[0], ray.origin_y[0], ray.origin_z[0]} +
                         Vec3f{ray.dir_x[0], ray.dir_y[0], ray.dir_z[0]} * t;
        return scene_.frame().origin + to_double(at) * scene_.frame().unit;
    }

    MeshCrossing cross(Vec2f a, SurfaceKey first, Vec2f b, SurfaceKey second) const {
        expected_.clear();
        const SeenPair pair{a, b, first, second, {1.0F / 64.0F, 0.25F}};
        MeshCrossing crossing;
        MeshCrosser(walk_).cross({&pair, 1}, {&crossing, 1}, expected_);
        return crossing;
    }
    /// Of all pairs together; what they expect to see goes to `expected`.
    std::vector<MeshCrossing> cross(const std::vector<SeenPair>& pairs,
                                    std::vector<SurfaceKey>& expected) const {
        std::vector<MeshCrossing> crossings(pairs.size());
        MeshCrosser(walk_).cross(pairs, crossings, expected);
        return crossings;
    }
    const std::vector<SurfaceKey>& expected() const { return expected_; }
    /// Whether the ray that a crossing asks for sees what it should.
    bool confirmed(const MeshCrossing& crossing) const {
        if (!crossing.needs_check) return true;
        const SurfaceKey seen = at(crossing.checked).key;
        const auto first = expected_.begin() + crossing.first_expected;
        return (crossing.unless_object != SurfaceKey::kNothing &&
                seen.object != crossing.unless_object) ||
               std::find(first, first + crossing.expected, seen) != first + crossing.expected;
    }

    /// Calls `visit(a, what a sees, b, what b sees)` for neighbouring pixels.
    template <class Visit>
    void for_each_pair(Visit visit) const {
        std::vector<Sight> row, above;
        for (int y = 0; y < kSide; ++y) {
            above.swap(row);
            row.clear();
            const auto centre = [&](int i, int j) {
                return Vec2f{static_cast<float>(i) + 0.5F, static_cast<float>(j) + 0.5F};
            };
            for (int x = 0; x < kSide; ++x) row.push_back(at(centre(x, y)));
            for (int x = 0; x < kSide; ++x) {
                const auto k = static_cast<std::size_t>(x);
                if (x > 0) visit(centre(x - 1, y), row[k - 1], centre(x, y), row[k]);
                if (y > 0) visit(centre(x, y - 1), above[k], centre(x, y), row[k]);
            }
        }
    }

    const MeshWalk& walk() const { return walk_; }
    double unit() const { return scene_.frame().unit; }

  private:
    Scene scene_;
    Camera camera_;
    MeshWalk walk_;
    std::unique_ptr<Tracer> tracer_;
    mutable std::vector<SurfaceKey> expected_;
};

bool is_contour(const MeshCrossing& crossing) {
    return crossing.kind == Kind::first_contour || crossing.kind == Kind::second_contour;
}

ViewSettings view_from(Vec3d eye, bool parallel) {
    ViewSettings view;
    view.eye = eye;
    view.look_at = Vec3d{};
    if (parallel) view.orthographic = 2.6;
    return view;
}

TEST(MeshWalk, FindsTheOutlineOfARoundMeshWhereRaysBeginToMiss) {
    for (const bool parallel : {false, true}) {
        const Seen seen({globe(20, [] { return 1.0F; })}, view_from({1.3, 2.1, 4.7}, parallel));
        int outlines = 0;
        seen.for_each_pair([&](Vec2f a, Sight at_a, Vec2f b, Sight at_b) {
            const bool hit_a = at_a.t < kInfinity;
            if (hit_a == (at_b.t < kInfinity)) return;
            ++outlines;
            const MeshCrossing crossing = seen.cross(a, at_a.key, b, at_b.key);
            ASSERT_EQ(crossing.kind, hit_a ? Kind::first_contour : Kind::second_contour);
            EXPECT_FALSE(crossing.at_rim);
            EXPECT_TRUE(std::isinf(crossing.gap));
            EXPECT_TRUE(seen.confirmed(crossing));
            float low = 0.0F;
            float high = 1.0F;
            for (int step = 0; step < 14; ++step) {
                const float middle = 0.5F * (low + high);
                const bool hit = seen.at(a + (b - a) * middle).t < kInfinity;
                (hit == hit_a ? low : high) = middle;
            }
            EXPECT_NEAR(crossing.at, 0.5F * (low + high), 0.002) << a.x << ", " << a.y;
        });
        EXPECT_GT(outlines, 200);
    }
}

TEST(MeshWalk, FindsTheCreasesOfACubeOnItsEdges) {
    for (const bool parallel : {false, true}) {
        const Seen seen({box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5})},
                        view_from({2.3, 1.9, 4.1}, parallel));
        int creases = 0;
        seen.for_each_pair([&](Vec2f a, Sight at_a, Vec2f b, Sight at_b) {
            if (at_a.t == kInfinity || at_b.t == kInfinity) return;
            const MeshCrossing crossing = seen.cross(a, at_a.key, b, at_b.key);
            const std::uint32_t face_a = at_a.key.primitive / 2;
            const std::uint32_t face_b = at_b.key.primitive / 2;
            ASSERT_EQ(crossing.kind, face_a == face_b ? Kind::smooth : Kind::crease);
            if (face_a == face_b) return;
            ++creases;
            EXPECT_NEAR(crossing.turn, std::numbers::sqrt2, 1e-3);
            const Vec3d p = seen.world(a + (b - a) * static_cast<float>(crossing.at), crossing.t);
            int on_faces = 0;
            for (const double x : {p.x, p.y, p.z}) on_faces += std::abs(std::abs(x) - 0.5) < 1e-4;
            // Pixels of a corner may see two faces of three.
            EXPECT_GE(on_faces, 2) << p.x << ", " << p.y << ", " << p.z;
        });
        EXPECT_GT(creases, 80);
    }
}

TEST(MeshWalk, FindsWhereTwoBoxesPassThroughEachOther) {
    const Seen seen({box({-1, -0.3, -0.35}, {1, 0.3, 0.3}), box({-0.3, -1, -0.3}, {0.31, 1, 0.37})},
                    view_from({1.3, 1.7, 4.4}, false));
    int seams = 0;
    seen.for_each_pair([&](Vec2f a, Sight at_a, Vec2f b, Sight at_b) {
        const MeshCrossing crossing = seen.cross(a, at_a.key, b, at_b.key);
        if (crossing.kind != Kind::seam || !seen.confirmed(crossing)) return;
        ++seams;
        const Vec3d p = seen.world(a + (b - a) * static_cast<float>(crossing.at), crossing.t);
        const auto off = [](double x, double low, double high) {
            return std::min(std::abs(x - low), std::abs(x - high));
        };
        EXPECT_LT(std::min(off(p.y, -0.3, 0.3), off(p.z, -0.35, 0.3)), 1e-4);
        EXPECT_LT(std::min(off(p.x, -0.3, 0.31), off(p.z, -0.3, 0.37)), 1e-4);
    });
    EXPECT_GT(seams, 20);
}

TEST(MeshWalk, EndsAtTheRimOfAnOpenSheet) {
    const Seen seen(
        {prepared({{-1, -1, 0}, {1, -1, 0.3F}, {1, 1, 0}, {-1, 1, 0.2F}}, {{0, 1, 2}, {0, 2, 3}})},
        view_from({0.4, 0.9, 4.4}, false));
    int rims = 0;
    seen.for_each_pair([&](Vec2f a, Sight at_a, Vec2f b, Sight at_b) {
        if ((at_a.t < kInfinity) == (at_b.t < kInfinity)) return;
        const MeshCrossing crossing = seen.cross(a, at_a.key, b, at_b.key);
        ASSERT_TRUE(is_contour(crossing));
        EXPECT_TRUE(crossing.at_rim);
        const Vec3d p = seen.world(a + (b - a) * static_cast<float>(crossing.at), crossing.t);
        EXPECT_NEAR(std::max(std::abs(p.x), std::abs(p.y)), 1.0, 1e-4);
        ++rims;
    });
    EXPECT_GT(rims, 200);
}

TEST(MeshWalk, GivesUpWhereThreeTrianglesMeet) {
    // Three leaves of a book, of which two are seen.
    const Seen seen({prepared({{0, -1, 0}, {0, 1, 0}, {1, 0, 0.1F}, {-1, 0, 0.1F}, {0.1F, 0, -1}},
                              {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}})},
                    view_from({0.1, 0.2, 4.4}, false));
    int unknown = 0;
    seen.for_each_pair([&](Vec2f a, Sight at_a, Vec2f b, Sight at_b) {
        if (at_a.t == kInfinity || at_b.t == kInfinity || at_a.key == at_b.key) return;
        EXPECT_EQ(seen.cross(a, at_a.key, b, at_b.key).kind, Kind::unknown);
        ++unknown;
    });
    EXPECT_GT(unknown, 30);
}

TEST(MeshWalk, KnowsNothingOfAMeshWhoseEdgesAreNotPaired) {
    const Seen seen({half_plane(30.0), box({0, 0, 0}, {1, 1, 1})});
    EXPECT_FALSE(seen.walk().knows(0));
    EXPECT_TRUE(seen.walk().knows(1));
}

/// Counts contours that stand well before what is behind them, and how many of these a pair of rays
/// denies.
struct Tally {
    int contours = 0, wrong = 0, unknown = 0, pairs = 0;
};

Tally tally(const Seen& seen) {
    Tally tally;
    seen.for_each_pair([&](Vec2f a, Sight at_a, Vec2f b, Sight at_b) {
        if (at_a.key == at_b.key) return;
        ++tally.pairs;
        const MeshCrossing crossing = seen.cross(a, at_a.key, b, at_b.key);
        tally.unknown += crossing.kind == Kind::unknown;
        constexpr float kDeep = 0.05F;
        if (!is_contour(crossing) || crossing.gap < kDeep || !seen.confirmed(crossing)) return;
        constexpr float kBeside = 0.004F;
        const auto at = static_cast<float>(crossing.at);
        if (at < kBeside || at > 1.0F - kBeside) return;
        ++tally.contours;
        const bool first = crossing.kind == Kind::first_contour;
        const float front = seen.at(a + (b - a) * (at + (first ? -kBeside : kBeside))).t;
        const float behind = seen.at(a + (b - a) * (at + (first ? kBeside : -kBeside))).t;
        // Farther beside it the check may miss something narrow.
        const bool checked_beside = std::abs(crossing.checked_at - at) < 0.02F;
        // The last facet may be all but edge on.
        const bool right = std::abs(front - crossing.t) < kDeep &&
                           (!checked_beside ||
                            (std::isinf(crossing.gap)
                                 ? std::isinf(behind)
                                 : std::abs(behind - front - crossing.gap) < 0.5F * crossing.gap));
        tally.wrong += !right;
    });
    return tally;
}

TEST(MeshWalk, AgreesWithRaysOnMeshesWithManyFolds) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        std::mt19937 random(seed);
        const auto radius = [&] { return 0.75F + 0.35F * uniform(random); };
        const Seen seen({globe(14, radius)}, view_from({1.3, 2.1, 4.7}, seed % 2 == 0));
        const Tally found = tally(seen);
        EXPECT_GT(found.contours, 300);
        EXPECT_LT(found.wrong, 0.01 * found.contours) << found.wrong << " of " << found.contours;
        EXPECT_LT(found.unknown, 0.15 * found.pairs) << found.unknown << " of " << found.pairs;
    }
}

TEST(MeshWalk, FindsOfManyPairsTogetherWhatItFindsOfEach) {
    std::mt19937 random(5);
    const auto radius = [&] { return 0.75F + 0.35F * uniform(random); };
    const Seen seen({globe(14, radius), box({-1, -1, -1}, {0.2, 0.1, 0.3})},
                    view_from({1.3, 2.1, 4.7}, false));
    std::vector<SeenPair> pairs;
    seen.for_each_pair([&](Vec2f a, Sight at_a, Vec2f b, Sight at_b) {
        pairs.push_back({a, b, at_a.key, at_b.key, {1.0F / 64.0F, 0.25F}});
    });
    std::ranges::shuffle(pairs, random);  // so that walks on either mesh take turns
    std::vector<SurfaceKey> expected;
    const std::vector<MeshCrossing> together = seen.cross(pairs, expected);
    int contours = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto& [from, to, first, second, checks] = pairs[k];
        const MeshCrossing alone = seen.cross(from, first, to, second);
        const MeshCrossing& found = together[k];
        ASSERT_EQ(found.kind, alone.kind);
        contours += is_contour(found);
        EXPECT_EQ(found.at, alone.at);
        EXPECT_EQ(found.t, alone.t);
        EXPECT_EQ(found.gap, alone.gap);
        EXPECT_EQ(found.turn, alone.turn);
        EXPECT_EQ(found.checked, alone.checked);
        ASSERT_EQ(found.expected, alone.expected);
        EXPECT_TRUE(std::equal(seen.expected().begin() + alone.first_expected,
                               seen.expected().begin() + alone.first_expected + alone.expected,
                               expected.begin() + found.first_expected));
    }
    EXPECT_GT(contours, 300);
}

TEST(MeshWalk, AgreesWithRaysOnOpenBranchingAndCrossedMeshes) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        std::mt19937 random(seed);
        Object object = globe(12, [&] { return 0.75F + 0.35F * uniform(random); });
        auto& mesh = std::get<Mesh>(object.shape);
        // Holes, triangles on edges that have two already, needles, and corners within edges.
        for (Mesh::Triangle& triangle : mesh.triangles) {
            if (uniform(random) < 0.1F) triangle = mesh.triangles.front();
        }
        const auto vertices = static_cast<std::uint32_t>(mesh.vertices.size());
        const auto any = [&] {
            return static_cast<std::uint32_t>(uniform(random) * static_cast<float>(vertices));
        };
        for (int k = 0; k < 30; ++k) {
            const std::uint32_t a = any();
            const std::uint32_t b = any();
            if (a == b) continue;
            const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
            mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) * 0.5F);
            mesh.vertices.push_back(mesh.vertices[middle] + uniform_point(random) * 0.01F);
            mesh.triangles.push_back({a, middle, middle + 1});
            mesh.triangles.push_back({a, b, middle + 1});
        }
        mesh.corner_normals.clear();
        weld(mesh);
        smooth_normals(mesh);
        const Seen seen({object}, view_from({1.3, 2.1, 4.7}, seed % 2 == 0));
        const Tally found = tally(seen);
        EXPECT_GT(found.contours, 200);
        EXPECT_LT(found.wrong, 0.02 * found.contours) << found.wrong << " of " << found.contours;
    }
}

}  // namespace
}  // namespace ink::test

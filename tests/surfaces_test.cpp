#include "sampling/surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "known_meshes.h"
#include "scenes.h"

namespace ink::test {
namespace {

/// Two hits on the first glyph of a scene.
class OneGlyph : public testing::Test {
  protected:
    struct Hit {
        Vec3f at, normal;  ///< of the unit shape, which is placed as it is
    };

    static bool smooth(const UnitShape& shape, const Hit& a, const Hit& b, bool places = true) {
        // Large enough that the scene's frame is the world's, but for its origin.
        Object object;
        object.kind = ObjectKind::shape;
        Placement placement;
        for (Vec3f* axis : {&placement.x_axis, &placement.y_axis, &placement.z_axis}) {
            *axis = *axis * 0.5F;
        }
        object.shape = Glyphs{shape, {placement}, {}, {}};
        const Scene scene({object});
        const Surfaces surfaces(scene, NormalSource::automatic);
        const auto& glyphs = std::get<Glyphs>(scene.objects()[0].shape);
        HitPacket hits = HitPacket::miss();
        std::vector<Vec3f> at;
        for (const Hit& hit : {a, b}) {
            const auto lane = static_cast<int>(at.size());
            at.push_back(to_float(glyphs.placements[0].point(to_double(hit.at))));
            hits.object[lane] = 0;
            hits.primitive[lane] = 0;
            const Vec3f normal = normalize(hit.normal);
            hits.normal_x[lane] = normal.x;
            hits.normal_y[lane] = normal.y;
            hits.normal_z[lane] = normal.z;
        }
        return places ? surfaces.smooth_between(hits, 0, &at[0], hits, 1, &at[1])
                      : surfaces.smooth_between(hits, 0, hits, 1);
    }
};

constexpr float kRoot = 0.70710678F;

TEST_F(OneGlyph, IsSmoothOnAnEllipsoidAndOnOneFaceOfABox) {
    EXPECT_TRUE(smooth({GlyphKind::ellipsoid}, {{0, 0, 1}, {0, 0, 1}}, {{1, 0, 0}, {1, 0, 0}}));
    EXPECT_TRUE(smooth({GlyphKind::box}, {{0.2F, 0, 1}, {0, 0, 1}}, {{0.9F, 0, 1}, {0, 0, 1}}));
    EXPECT_FALSE(smooth({GlyphKind::box}, {{0.9F, 0, 1}, {0, 0, 1}}, {{1, 0, 0.9F}, {1, 0, 0}}));
}

TEST_F(OneGlyph, IsSmoothAllOverTheSideOfAFrustumButNotAcrossItsRim) {
    for (const bool capped : {true, false}) {
        for (const double a : {1.0, 0.4}) {
            const UnitShape shape{.kind = GlyphKind::frustum, .a = a, .capped = capped};
            const auto radius = static_cast<float>(0.5 * (1.0 + a));
            const auto rise = static_cast<float>(0.5 * (1.0 - a));
            const Hit front{{radius, 0, 0}, {1, 0, rise}};
            const Hit beside{{radius * kRoot, radius * kRoot, 0}, {kRoot, kRoot, rise}};
            EXPECT_TRUE(smooth(shape, front, beside));
            // Seen through the open end.
            const Hit within{{-radius, 0, 0}, {1, 0, -rise}};
            EXPECT_FALSE(smooth(shape, front, within));
            const Hit cap{{0.1F, 0, 1}, {0, 0, 1}};
            if (capped) {
                EXPECT_FALSE(smooth(shape, front, cap));
                EXPECT_TRUE(smooth(shape, cap, cap));
            }
            EXPECT_FALSE(smooth(shape, front, beside, false)) << "where is not known";
        }
    }
}

/// Pairs of triangles of a mesh that comes second in its scene, seen from somewhere.
class TrianglePairs : public testing::TestWithParam<bool> {
  protected:
    TrianglePairs() : scene_({mesh_object(cube_soup()), mesh_object(hollow())}) {
        viewpoint_.parallel = GetParam();
        viewpoint_.dir = normalize(Vec3f{-0.93F, -2.11F, -3.27F});
        viewpoint_.eye = viewpoint_.dir * -3.0F;
    }

    static Object mesh_object(Mesh mesh) {
        weld(mesh);
        smooth_normals(mesh);
        Object object;
        object.kind = ObjectKind::mesh;
        object.shape = std::move(mesh);
        return object;
    }

    /// A sphere with a hole, so that the inner side is seen, too, and a crease.
    static Mesh hollow() {
        Mesh mesh = sphere(3);
        std::erase_if(mesh.triangles, [&](const Mesh::Triangle& corners) {
            return mesh.vertices[corners[0]].z > 0.8F;
        });
        for (Vec3f& vertex : mesh.vertices) vertex.x = std::min(vertex.x, 0.5F);
        return mesh;
    }

    const Mesh& mesh() const { return std::get<Mesh>(scene_.objects()[1].shape); }

    /// As a ray would hit it.
    void put(std::uint32_t triangle, HitPacket& hits, int lane) const {
        const Mesh::Triangle& corners = mesh().triangles[triangle];
        const Vec3f a = mesh().vertices[corners[0]];
        Vec3f normal = cross(mesh().vertices[corners[1]] - a, mesh().vertices[corners[2]] - a);
        normal = normalize(normal);
        if (dot(normal, viewpoint_.ray_direction(a)) > 0.0F) normal = normal * -1.0F;
        hits.object[lane] = 1;
        hits.primitive[lane] = triangle;
        hits.normal_x[lane] = normal.x;
        hits.normal_y[lane] = normal.y;
        hits.normal_z[lane] = normal.z;
    }

    Scene scene_;
    Viewpoint viewpoint_;
};

TEST_P(TrianglePairs, AreSmoothTogetherWhereTheyAreOneByOne) {
    const Surfaces surfaces(scene_, NormalSource::automatic);
    const auto count = static_cast<std::uint32_t>(mesh().triangles.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t edge = 0; edge < 3 * count; ++edge) {
        if (mesh().twins[edge] < Mesh::kManyTwins) {
            pairs.emplace_back(edge / 3, mesh().twins[edge] / 3);
        }
    }
    std::mt19937 random(7);
    for (int k = 0; k < 500; ++k) pairs.emplace_back(random() % count, random() % count);
    std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
    std::ranges::shuffle(pairs, random);

    const std::uint32_t base = 12;  // triangles of the cube
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> second;
    for (const auto& [a, b] : pairs) {
        first.push_back(base + a);
        second.push_back(base + b);
    }
    std::vector<std::uint32_t> edges(pairs.size());
    surfaces.find_smooth_edges(viewpoint_, first, second, edges);

    int smooth = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        HitPacket hits = HitPacket::miss();
        put(pairs[k].first, hits, 0);
        put(pairs[k].second, hits, 1);
        const bool expected = surfaces.smooth_between(hits, 0, hits, 1);
        ASSERT_EQ(edges[k] != Mesh::kNoTwin, expected) << pairs[k].first << " " << pairs[k].second;
        if (!expected) continue;
        ++smooth;
        EXPECT_EQ(edges[k] / 3, pairs[k].first);
        EXPECT_EQ(mesh().twins[edges[k]] / 3, pairs[k].second);
    }
    EXPECT_GT(smooth, 500);
    EXPECT_LT(smooth, static_cast<int>(pairs.size()) - 550) << "creases and contours are none";
}

TEST_P(TrianglePairs, OfDifferentObjectsOrOfUnknownNumbersAreNotKnownToBeSmooth) {
    const Surfaces surfaces(scene_, NormalSource::automatic);
    const std::vector<std::uint32_t> first{3, 14, SampleGrid::kUnknownSurface + 4, 12};
    const std::vector<std::uint32_t> second{14, 3, SampleGrid::kUnknownSurface + 5,
                                            SampleGrid::kUnknownSurface};
    std::vector<std::uint32_t> edges(first.size());
    surfaces.find_smooth_edges(viewpoint_, first, second, edges);
    EXPECT_EQ(edges, std::vector<std::uint32_t>(first.size(), Mesh::kNoTwin));
}

INSTANTIATE_TEST_SUITE_P(Views, TrianglePairs, testing::Bool(), [](const auto& view) {
    return view.param ? "Orthographic" : "Perspective";
});

}  // namespace
}  // namespace ink::test

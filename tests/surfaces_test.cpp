#include "sampling/surfaces.h"

#include <gtest/gtest.h>

#include <vector>

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

}  // namespace
}  // namespace ink::test

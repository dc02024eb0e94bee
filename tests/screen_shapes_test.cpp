// Glyphs and hexahedra, as the screen tracer sees them. They are met by closed forms in double
// precision (shape_intersection.h), which tests of their own compare with brute force.

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "scenes.h"
#include "seen.h"

namespace ink::test {
namespace {

std::unique_ptr<Tracer> make_double_tracer(const Scene& scene) { return make_embree_tracer(scene); }

struct NamedShape {
    std::string name;
    UnitShape shape;
};

class EveryScreenShape : public testing::TestWithParam<NamedShape> {};

INSTANTIATE_TEST_SUITE_P(
    Shapes, EveryScreenShape, testing::ValuesIn([] {
        using enum GlyphKind;
        return std::vector<NamedShape>{
            {"Ellipsoid", {ellipsoid}},   {"Box", {box}},
            {"Cylinder", {frustum, 1.0}}, {"Tube", {frustum, 1.0, 1.0, false}},
            {"Cone", {frustum, 0.0}},     {"OpenCone", {frustum, 0.3, 1.0, false}},
            {"Frustum", {frustum, 0.4}},  {"Disc", {disc}},
            {"Rectangle", {rectangle}}};
    }()),
    [](const auto& shape) { return shape.param.name; });

TEST_P(EveryScreenShape, IsHitWhereItsEquationSays) {
    std::mt19937 random(11);
    for (const double fov : {0.0, 2.0, 30.0, 70.0}) {
        ViewSettings view;
        if (fov == 0.0) view.orthographic = 0.0;
        if (fov != 0.0) view.fov_deg = fov;
        const Seen seen({random_glyphs(GetParam().shape, 100, 0.4, random)}, view, {192, 160},
                        make_double_tracer);
        expect_same_hits(seen, seen.random_points(3, 2000));
    }
}

TEST_P(EveryScreenShape, IsHitInAllItsCopies) {
    std::mt19937 random(13);
    Object original = random_glyphs(GetParam().shape, 40, 0.4, random);
    std::get<Glyphs>(original.shape).copies = four_copies();
    const Seen seen({std::move(original)}, {}, {192, 160}, make_double_tracer);
    expect_same_hits(seen, seen.random_points(3, 2000));
}

TEST_P(EveryScreenShape, IsHitWhereItsEquationSaysAtAnySize) {
    std::mt19937 random(12);
    std::vector<Object> objects;
    for (const double size : {1.0, 0.1, 1e-2, 1e-3}) {
        objects.push_back(random_glyphs(GetParam().shape, 60, size, random));
    }
    const Seen seen(std::move(objects), {}, {512, 512}, make_double_tracer);
    expect_same_hits(seen, seen.random_points(4, 4000));
}

/// Rays along an axis or a face, which some of the equations lose a term for.
TEST_P(EveryScreenShape, IsHitWhereItsEquationSaysAlongItsAxes) {
    Glyphs glyphs{GetParam().shape, {}, {}, {}};
    for (const Placement& placement :
         {Placement{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-3, 0, 0.2F}},
          Placement{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0.3F, 0}},
          Placement{{0, 0, -0.7F}, {1.2F, 0, 0}, {0, 1.4F, 0}, {3, 0, -0.1F}}}) {
        glyphs.placements.push_back(placement);
    }
    for (const View side : {View::front, View::right, View::top}) {
        for (const bool parallel : {true, false}) {
            ViewSettings view;
            view.view = side;
            if (parallel) view.orthographic = 0.0;
            Object object;
            object.kind = ObjectKind::shape;
            object.shape = glyphs;
            const Seen seen({std::move(object)}, view, kSmall, make_double_tracer);
            expect_same_hits(seen, seen.pixels());
            expect_same_hits(seen, seen.random_points(6, 500));
        }
    }
}

TEST_P(EveryScreenShape, IsSeenFromJustBeforeItAndFromFar) {
    for (const double distance : {2.2, 1e4}) {
        ViewSettings view;
        view.eye = Vec3d{0.3 * distance, 0.2 * distance, distance};
        view.look_at = Vec3d{0, 0, 0};
        view.fov_deg = distance < 10.0 ? 70.0 : 0.015;
        Object object;
        object.kind = ObjectKind::shape;
        object.shape = Glyphs{GetParam().shape, {Placement{}}, {}, {}};
        const Seen seen({std::move(object)}, view, kSmall, make_double_tracer);
        expect_same_hits(seen, seen.random_points(5, 1000));
    }
}

TEST(ScreenShapes, HitsHexahedraWhereTheirFacesAre) {
    std::mt19937 random(13);
    std::vector<Hexahedra::Corners> solids;
    for (int i = 0; i < 100; ++i) {
        const Vec3f at = random_vector(random);
        auto corners = box_corners(at, at + Vec3f{0.2F, 0.3F, 0.15F});
        const Vec3f shear = random_vector(random) * 0.4F;
        for (Vec3f& corner : corners) corner = corner + shear * (corner.z - at.z);
        solids.push_back(corners);
    }
    const Seen seen({hexahedron_object(std::move(solids))}, {}, kSmall, make_double_tracer);
    expect_same_hits(seen, seen.random_points(6, 2000));
}

TEST(ScreenShapes, GivesGlyphsTheSameBitsOnEveryInstructionSet) {
    std::mt19937 random(14);
    std::vector<Object> objects;
    for (const GlyphKind kind : {GlyphKind::ellipsoid, GlyphKind::box, GlyphKind::frustum,
                                 GlyphKind::disc, GlyphKind::rectangle}) {
        objects.push_back(random_glyphs({.kind = kind, .a = 0.5}, 60, 0.3, random));
    }
    expect_same_bits_on_every_instruction_set(Seen(std::move(objects), {}, kSmall));
}

}  // namespace
}  // namespace ink::test

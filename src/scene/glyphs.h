#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/bounds.h"
#include "base/color.h"
#include "base/vec.h"
#include "scene/copies.h"

namespace ink {

/// Surfaces that are traced as their equations say, not as triangles. Each is described in its own
/// coordinates, about the origin; a Placement puts it into the scene.
enum class GlyphKind : std::uint8_t {
    ellipsoid,       ///< unit ball
    box,             ///< cube [-1, 1]^3
    frustum,         ///< about z from -1 to 1, radius 1 below and `a` above: cylinder, cone
    disc,            ///< z = 0, x^2 + y^2 <= 1
    rectangle,       ///< z = 0, |x| <= 1, |y| <= 1
    torus,           ///< about z, a tube of radius `a` round the unit circle, 0 < a < 1
    superellipsoid,  ///< (|x|^(2/b) + |y|^(2/b))^(b/a) + |z|^(2/a) = 1, Barr 1981
    gaussian,        ///< z = exp(-(x^2 + y^2) / (2 a^2)) over |x| <= 1, |y| <= 1
    waves            ///< z = cos(pi a x) cos(pi b y) over |x| <= 1, |y| <= 1
};

/// A shape in its own coordinates, shared by all glyphs of an object.
struct UnitShape {
    GlyphKind kind = GlyphKind::ellipsoid;
    double a = 1.0;      ///< frustum: radius above, [0, 1]; superellipsoid: roundness along z
    double b = 1.0;      ///< superellipsoid: roundness about z
    bool capped = true;  ///< frustum: closed by discs
};

/// Both roundnesses of a superellipsoid lie between these: from all but a box to an octahedron.
/// Within them the shape is convex.
inline constexpr double kLeastRoundness = 0.02;
inline constexpr double kMostRoundness = 2.0;

/// Where a glyph is: the point (x, y, z) of the unit shape lies at origin + x X + y Y + z Z. Any
/// affine map, so that a ball becomes the ellipsoid of a deformation gradient. A map without volume
/// shows nothing.
struct Placement {
    Vec3f x_axis{1, 0, 0}, y_axis{0, 1, 0}, z_axis{0, 0, 1};  ///< in the frame of object or scene
    Vec3f origin;

    Vec3d point(Vec3d p) const {
        return to_double(origin) + to_double(x_axis) * p.x + to_double(y_axis) * p.y +
               to_double(z_axis) * p.z;
    }
};

/// Whether the three axes of a placement span a solid, and do not lie in one plane but for
/// rounding: one thinner than three millionths of its width, rays miss and hit by chance.
bool has_volume(const Placement& placement);

/// A frustum, cylinder or cone from `from` to `to`, which must differ; `radius` is that of its
/// lower end.
Placement placement_between(Vec3d from, Vec3d to, double radius);

/// A disc, torus or other shape about an axis: `axis`, of any length but zero, becomes its z
/// direction, and it is scaled by `size` alike in all directions.
Placement placement_about(Vec3d centre, Vec3d axis, double size);

/// The placement, moved.
Placement moved(const Placement& placement, const Motion& motion);

/// One shape in many places, as flat arrays. `colors` and `parts` have one entry a placement, or
/// none at all.
struct Glyphs {
    UnitShape shape;
    std::vector<Placement> placements;
    std::vector<Rgb8> colors;          ///< instead of the material's
    std::vector<std::uint32_t> parts;  ///< index into the object's `part_names`
    std::vector<Copy> copies{};        ///< see CopyNumbering
    std::uint32_t parts_a_copy = 0;
    /// Of sticks in two halves: from each to the one of another colour that goes on from it, 1 or
    /// -1; 0 where none does. Empty: there are no such halves.
    std::vector<std::int8_t> other_half{};

    CopyNumbering numbering() const { return {copies, placements.size(), parts_a_copy}; }
    std::size_t count() const { return numbering().count(); }
    Placement at(std::size_t primitive) const {
        if (copies.empty()) return placements[primitive];
        return moved(placements[numbering().source(primitive)], numbering().copy(primitive).motion);
    }
};

/// Solids with six four-sided faces, as flat arrays like Glyphs. Corners are in VTK's order: 0 to 3
/// round one face, 4 to 7 above them. Faces should be planar; one that is not is two triangles with
/// one normal.
struct Hexahedra {
    using Corners = std::array<Vec3f, 8>;  ///< in the frame of the object or scene

    std::vector<Corners> corners;
    std::vector<Rgb8> colors;
    std::vector<std::uint32_t> parts;

    /// The faces of a solid, counterclockwise from outside where 4 to 7 are above 0 to 3.
    static constexpr std::array<std::array<std::uint8_t, 4>, 6> kFaces{
        {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
};

/// Largest value of dot(direction, p) over the points p of a unit shape, or a little more for
/// height fields.
double support(const UnitShape& shape, Vec3d direction);

/// The same over the points of a placed glyph.
double support(const UnitShape& shape, const Placement& placement, Vec3d direction);

/// The least box about a glyph, rounded outwards; empty for a placement that is not finite.
Bounds3f glyph_bounds(const UnitShape& shape, const Placement& placement);

/// The box about the corners of a hexahedron; empty where one is not finite.
Bounds3f hexahedron_bounds(const Hexahedra::Corners& corners);

}  // namespace ink

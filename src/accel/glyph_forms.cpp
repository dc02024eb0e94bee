#include "accel/screen_packets.h"

#include <array>
#include <limits>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/glyph_forms.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_forms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

using DoubleMask = hn::Mask<Doubles>;

/// The cube that holds a unit shape, in camera space: its middle, and from there to its faces.
struct Cube {
    Triple middle, x, y, z;
};

/// The cube, or the square in its middle, on the screen. What has no form has no bounds either: of
/// no numbers, they would spoil those of its cluster.
HWY_INLINE void bound_glyphs(const Basis& basis, const Cube& cube, bool flat, DoubleMask has_form,
                             int i, BoundsPacket& packet) {
    const Double infinity = number(std::numeric_limits<double>::infinity());
    CornerBounds bounds = CornerBounds::none();
    Double width = infinity;  // of a pixel, at the corner where it is least
    for (int corner = 0; corner < (flat ? 4 : 8); ++corner) {
        Triple p = (corner & 1) != 0 ? sum(cube.middle, cube.x) : difference(cube.middle, cube.x);
        p = (corner & 2) != 0 ? sum(p, cube.y) : difference(p, cube.y);
        if (!flat) p = (corner & 4) != 0 ? sum(p, cube.z) : difference(p, cube.z);
        const Double pixel = pixel_at(basis, p.z);
        bounds.add(p, pixel);
        width = hn::Min(width, pixel);
    }
    // A corner beside the eye has no place on the screen.
    const auto beside = hn::Le(width, number(1e-6 * basis.origin_step));
    bounds.left = hn::IfThenElse(beside, hn::Neg(infinity), bounds.left);
    bounds.top = hn::IfThenElse(beside, hn::Neg(infinity), bounds.top);
    bounds.right = hn::IfThenElse(beside, infinity, bounds.right);
    bounds.bottom = hn::IfThenElse(beside, infinity, bounds.bottom);
    const CornerBounds none = CornerBounds::none();
    bounds.left = hn::IfThenElse(has_form, bounds.left, none.left);
    bounds.top = hn::IfThenElse(has_form, bounds.top, none.top);
    bounds.right = hn::IfThenElse(has_form, bounds.right, none.right);
    bounds.bottom = hn::IfThenElse(has_form, bounds.bottom, none.bottom);
    bounds.depth = hn::IfThenElse(has_form, bounds.depth, none.depth);
    bounds.put(i, packet);
}

void lay_glyphs(Basis basis, const GlyphLanes& glyphs, ScreenPacket& packet) {
    FormLanes form;
    HitLanes hit;
    const bool flat =
        packet.shape.kind == GlyphKind::disc || packet.shape.kind == GlyphKind::rectangle;
    for (int i = 0; i < kLanes; i += kStep) {
        const Triple x = load(glyphs.x_axis, i);
        const Triple y = load(glyphs.y_axis, i);
        const Triple z = load(glyphs.z_axis, i);
        const Triple yz = cross(y, z);
        const Double scale = hn::Div(number(1.0), dot(x, yz));  // infinite without a volume
        const std::array<Triple, 3> cofactors{yz, cross(z, x), cross(x, y)};
        const Triple c = to_camera(basis, load(glyphs.origin, i));
        const Double pixel = pixel_at(basis, c.z);
        const Double u = hn::Div(c.x, pixel);
        const Double v = hn::Div(c.y, pixel);
        put(u, form[0], i);
        put(v, form[1], i);
        put(c.z, form[2], i);
        auto finite = hn::Eq(pixel, pixel);
        for (std::size_t k = 0; k < 3; ++k) {
            const Triple row{hn::Mul(cofactors[k].x, scale), hn::Mul(cofactors[k].y, scale),
                             hn::Mul(cofactors[k].z, scale)};
            const Triple own = turned(basis, row);
            const Double ahead = hn::Add(
                own.z,
                hn::Mul(hn::Add(hn::Mul(own.x, u), hn::Mul(own.y, v)), number(basis.slope_step)));
            put(hn::Mul(own.x, pixel), form[3 + k], i);
            put(hn::Mul(own.y, pixel), form[6 + k], i);
            put(ahead, form[9 + k], i);
            put(row.x, hit[3 * k], i);
            put(row.y, hit[3 * k + 1], i);
            put(row.z, hit[3 * k + 2], i);
            const Double size = hn::Add(hn::Add(hn::Abs(row.x), hn::Abs(row.y)), hn::Abs(row.z));
            finite = hn::And(finite, hn::Lt(size, number(1e30)));
        }
        put(hn::Div(number(basis.slope_step), pixel), form[12], i);
        const Cube cube{c, turned(basis, x), turned(basis, y), turned(basis, z)};
        bound_glyphs(basis, cube, flat, finite, i, packet.bounds);
    }
    lay_side_by_side(form, 16, packet.forms);
    lay_side_by_side(hit, 12, packet.hit);
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(lay_glyphs);

void prepare(const Basis& basis, const GlyphLanes& glyphs, ScreenPacket& packet) {
    HWY_DYNAMIC_DISPATCH(lay_glyphs)(basis, glyphs, packet);
}

}  // namespace ink

#endif

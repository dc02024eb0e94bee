// What the kernels of camera rays share; included once for each instruction set.

#include <array>

#include "accel/screen_kernels.h"
#include "accel/side_by_side-inl.h"
#include "base/lanes-inl.h"

#if defined(INKTRACE_SCREEN_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_SCREEN_LANES_INL_H
#undef INKTRACE_SCREEN_LANES_INL_H
#else
#define INKTRACE_SCREEN_LANES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

// Forms are read number by number: a copy of them all would go through memory, which every test
// would wait for.

HWY_INLINE SphereForm sphere_form(const FormNumbers& n) {
    return {n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]};
}

HWY_INLINE TriangleForm triangle_form(const FormNumbers& n) {
    return {{n[0], n[1], n[2], n[3]},
            {n[4], n[5], n[6], n[7]},
            {n[8], n[9], n[10], n[11]},
            {n[12], n[13], n[14], n[15]},
            n[16],
            n[17],
            n[18],
            n[19],
            n[20],
            n[21]};
}

/// The lines of a TriangleForm side by side: of its three edges, and of its depth.
struct TriangleLines {
    hn::Vec<Four> x, y, dx, dy;

    HWY_INLINE explicit TriangleLines(const FormNumbers& n)
        : x(hn::LoadU(kFour, n.data())),
          y(hn::LoadU(kFour, n.data() + 4)),
          dx(hn::LoadU(kFour, n.data() + 8)),
          dy(hn::LoadU(kFour, n.data() + 12)) {}

    /// e_k at a point.
    HWY_INLINE hn::Vec<Four> at(float qx, float qy) const {
        return hn::Sub(hn::Mul(dx, hn::Sub(hn::Set(kFour, qy), y)),
                       hn::Mul(dy, hn::Sub(hn::Set(kFour, qx), x)));
    }
};

HWY_INLINE GlyphForm glyph_form(const FormNumbers& n) {
    return {n[0], n[1], n[2], {n[3], n[4], n[5]}, {n[6], n[7], n[8]}, {n[9], n[10], n[11]}, n[12]};
}

HWY_INLINE Vectors along(const Vectors& o, const Vectors& d, Number s) {
    return {hn::Add(o.x, hn::Mul(s, d.x)), hn::Add(o.y, hn::Mul(s, d.y)),
            hn::Add(o.z, hn::Mul(s, d.z))};
}
HWY_INLINE Vectors scaled(const Vectors& v, Number by) {
    return {hn::Mul(v.x, by), hn::Mul(v.y, by), hn::Mul(v.z, by)};
}
/// A number that can be divided by.
HWY_INLINE Number not_zero(Number v) {
    const auto tiny = hn::Lt(hn::Abs(v), set(1e-30F));
    return hn::IfThenElse(tiny, set(1e-30F), v);
}

HWY_INLINE void store(const Vectors& v, Lanes<float>& x, Lanes<float>& y, Lanes<float>& z, int i) {
    store(v.x, x, i);
    store(v.y, y, i);
    store(v.z, z, i);
}

/// Rays of a projection, rounded to floats: at a depth, the one through q is at start + (right q.x
/// + down q.y) (origin_step + slope_step depth) + forward depth.
struct RayFloats {
    float origin_step, slope_step;
    std::array<float, 3> start, right, down, forward;

    explicit RayFloats(const Basis& b)
        : origin_step(static_cast<float>(b.origin_step)),
          slope_step(static_cast<float>(b.slope_step)),
          start(rounded(b.sx, b.sy, b.sz)),
          right(rounded(b.rx, b.ry, b.rz)),
          down(rounded(b.dx, b.dy, b.dz)),
          forward(rounded(b.fx, b.fy, b.fz)) {}

    static std::array<float, 3> rounded(double x, double y, double z) {
        return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    }

    HWY_INLINE Vectors place(Number qx, Number qy, Number depth) const {
        const auto pixel = hn::Add(set(origin_step), hn::Mul(depth, set(slope_step)));
        const auto x = hn::Mul(qx, pixel);
        const auto y = hn::Mul(qy, pixel);
        const auto along_axis = [&](std::size_t axis) {
            const auto across = hn::Add(hn::Mul(x, set(right[axis])), hn::Mul(y, set(down[axis])));
            return hn::Add(hn::Add(set(start[axis]), hn::Mul(depth, set(forward[axis]))), across);
        };
        return {along_axis(0), along_axis(1), along_axis(2)};
    }

    HWY_INLINE Vectors direction(Number qx, Number qy) const {
        const auto x = hn::Mul(qx, set(slope_step));
        const auto y = hn::Mul(qy, set(slope_step));
        const auto along_axis = [&](std::size_t axis) {
            const auto across = hn::Add(hn::Mul(x, set(right[axis])), hn::Mul(y, set(down[axis])));
            return hn::Add(set(forward[axis]), across);
        };
        return {along_axis(0), along_axis(1), along_axis(2)};
    }

    /// From where the ray starts.
    HWY_INLINE Number distance(Number qx, Number qy, Number depth) const {
        const auto x = hn::Mul(qx, set(slope_step));
        const auto y = hn::Mul(qy, set(slope_step));
        const auto squared = hn::Add(hn::Add(set(1.0F), hn::Mul(x, x)), hn::Mul(y, y));
        return hn::Mul(depth, hn::Sqrt(squared));
    }
};

/// Rays in the coordinates of a unit shape: p + s d; see GlyphForm.
struct LocalRays {
    Vectors p, d;
};

HWY_INLINE LocalRays local_rays(const GlyphForm& form, Number qx, Number qy) {
    const auto dx = hn::Sub(qx, set(form.u));
    const auto dy = hn::Sub(qy, set(form.v));
    const auto own = [&](std::size_t k) {
        return hn::Add(hn::Mul(set(form.right[k]), dx), hn::Mul(set(form.down[k]), dy));
    };
    LocalRays rays{{own(0), own(1), own(2)}, {}};
    rays.d =
        along({set(form.ahead[0]), set(form.ahead[1]), set(form.ahead[2])}, rays.p, set(form.turn));
    return rays;
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

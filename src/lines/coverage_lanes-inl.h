// What the kernels of lines share; included once for each instruction set.

#include "base/lanes-inl.h"

#if defined(INKTRACE_COVERAGE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_COVERAGE_LANES_INL_H
#undef INKTRACE_COVERAGE_LANES_INL_H
#else
#define INKTRACE_COVERAGE_LANES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// square_coverage (lines/coverage.h), a normal a lane.
class SquareCoverage {
  public:
    /// What depends on the normal alone.
    struct Shape {
        Lanes<float> reach, flat, slope, corner;
    };
    HWY_INLINE void store(Shape& shape, int first) const {
        hn::Store(reach_, kFloats, shape.reach.data() + first);
        hn::Store(flat_, kFloats, shape.flat.data() + first);
        hn::Store(slope_, kFloats, shape.slope.data() + first);
        hn::Store(corner_, kFloats, shape.corner.data() + first);
    }
    /// The normal of one lane of a shape, in all.
    HWY_INLINE SquareCoverage(const Shape& shape, int lane)
        : reach_(set(shape.reach[lane])),
          flat_(set(shape.flat[lane])),
          slope_(set(shape.slope[lane])),
          corner_(set(shape.corner[lane])) {}

    /// Those of a shape, which may differ from lane to lane.
    HWY_INLINE SquareCoverage(Number reach, Number flat, Number slope, Number corner)
        : reach_(reach), flat_(flat), slope_(slope), corner_(corner) {}

    HWY_INLINE SquareCoverage(Number nx, Number ny) {
        const Number wide = hn::Max(hn::Abs(nx), hn::Abs(ny));
        const Number narrow = hn::Min(hn::Abs(nx), hn::Abs(ny));
        const Number half = set(0.5F);
        reach_ = hn::Mul(half, hn::Add(wide, narrow));
        flat_ = hn::Mul(half, hn::Sub(wide, narrow));
        slope_ = hn::Div(set(1.0F), wide);
        corner_ = hn::Div(half, hn::Max(hn::Mul(wide, narrow), set(1e-6F)));
    }
    /// From the middle of a square to the farthest edge that touches it.
    HWY_INLINE Number reach() const { return reach_; }
    HWY_INLINE Number operator()(Number inside) const {
        const Number off = hn::Min(hn::Abs(inside), reach_);
        const Number rest = hn::Sub(reach_, off);
        const Number flat = hn::Sub(set(0.5F), hn::Mul(off, slope_));
        const Number corner = hn::Mul(hn::Mul(rest, rest), corner_);
        const Number outer = hn::IfThenElse(hn::Le(off, flat_), flat, corner);
        const auto is_inside = hn::Ge(inside, hn::Zero(kFloats));
        return hn::IfThenElse(is_inside, hn::Sub(set(1.0F), outer), outer);
    }

  private:
    Number reach_, flat_, slope_, corner_;
};

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

#pragma once

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"
#include "base/vec.h"

namespace ink {

/// Area of the unit square about the origin on the inner side of a straight line at signed distance
/// `inside` from its centre (positive: the centre is inside), where (nx, ny) is the line's unit
/// normal. In closed form: a trapezoid, the convolution of two boxes as wide as |nx| and |ny|.
INKTRACE_INLINE float square_coverage(float inside, float nx, float ny) {
    const float wide = std::max(std::abs(nx), std::abs(ny));
    const float narrow = std::min(std::abs(nx), std::abs(ny));
    const float reach = 0.5F * (wide + narrow);
    const float off = std::min(std::abs(inside), reach);
    const float rest = reach - off;
    const bool linear = off <= 0.5F * (wide - narrow);
    const float part =
        (linear ? off : rest * rest) / (linear ? wide : 2.0F * std::max(wide * narrow, 1e-6F));
    const float outer = linear ? 0.5F - part : part;
    return inside >= 0.0F ? 1.0F - outer : outer;
}

/// Area of a pixel under a straight band of half width `half` at distance `distance` from the
/// pixel's centre, (nx, ny) being the unit normal. Summed across a line it is exactly the band's
/// width, at any angle.
INKTRACE_INLINE float band_coverage(float distance, float half, float nx, float ny) {
    return square_coverage(half - distance, nx, ny) - square_coverage(-half - distance, nx, ny);
}

}  // namespace ink

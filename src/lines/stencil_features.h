#pragma once

#include <cstdint>

#include "base/lanes.h"
#include "base/multiversion.h"

// What a ray stencil tells of a sample none of whose stencil rays left its geometry: Choudhury and
// Parker 2009, section 3.1, case 2. Sixteen samples at a time.
namespace ink {

/// When a stencil within one geometry shows a line.
struct StencilThresholds {
    /// A crease: |n_right - n_left|^2 + |n_up - n_down|^2 > (gradient * w)^2, w being the line's
    /// width, that is, the distance between opposite rays. In 1/pixel; with 0.1, a turn of 17
    /// degrees across a line of 3 pixels is a crease, and so is all of a ball of less than 14
    /// pixels' radius.
    float crease_gradient = 0.1F;
    /// A self-occlusion: |t_r - t_s| > share * t_s. The paper leaves the threshold to the scene and
    /// suggests a share of t_s; 0.2 shows the hollow of a torus that is seen from three or four
    /// times its size.
    float depth_share = 0.2F;
};

/// Unit normals of the four rays of the outer ring along the axes; background where there is none.
struct AxisNormals {
    Lanes<float> x, y, z;
};

/// |a - b|^2, added to `sum`: one axis of the normal's gradient, figure 4(a).
INKTRACE_INLINE void add_normal_difference(const AxisNormals& a, const AxisNormals& b,
                                           Lanes<float>& sum) {
    for (int i = 0; i < kLanes; ++i) {
        const float x = a.x[i] - b.x[i];
        const float y = a.y[i] - b.y[i];
        const float z = a.z[i] - b.z[i];
        sum[i] += x * x + y * y + z * z;
    }
}

/// Adds to d, in each lane, the stencil ray that lies farther from the sample in depth than
/// `threshold`: the count d of section 3.1.
INKTRACE_INLINE void count_depth_jumps(const Lanes<float>& sample, const Lanes<float>& stencil,
                                       const Lanes<float>& threshold, Lanes<std::int32_t>& d) {
    for (int i = 0; i < kLanes; ++i) {
        const float jump = stencil[i] - sample[i];
        d[i] += static_cast<std::int32_t>((jump < 0.0F ? -jump : jump) > threshold[i]);
    }
}

}  // namespace ink

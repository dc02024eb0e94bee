#pragma once

#include <cstdint>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "scene/ids.h"

namespace ink {

/// How the share of a stencil that lies on foreign geometry becomes the strength of an edge.
struct Metric {
    enum class Kind : std::uint8_t {
        linear,  ///< Choudhury and Parker 2009, equation 2
        power,   ///< the same with an exponent; equation 3 has 10
        solid    ///< full strength wherever the stencil touches an edge at all
    };
    Kind kind = Kind::linear;
    double exponent = 10.0;  ///< of `power`, >= 1
};

/// Edge strength e_M(i) in [0, 1] of a stencil of M rays, i of which differ from the sample.
/// 1 where half of them do. Choudhury and Parker 2009, section 3.1, equations 2 and 3.
/// 0 <= i <= M, M > 0.
float edge_strength(const Metric& metric, int i, int M);

/// The limit of edge_strength at a straight edge for stencils of infinitely many rays: `u` is the
/// distance from the edge over the stencil's radius, in [0, inf).
float straight_edge_strength(const Metric& metric, double u);

/// Adds to m, in each lane, the stencil ray whose geometry differs from the sample's: the count m
/// of section 3.1.
INKTRACE_INLINE void count_foreign(const Lanes<GeometryId>& sample,
                                   const Lanes<GeometryId>& stencil, Lanes<std::int32_t>& m) {
    for (int i = 0; i < kLanes; ++i) m[i] += static_cast<std::int32_t>(sample[i] != stencil[i]);
}

}  // namespace ink

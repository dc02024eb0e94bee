#pragma once

#include <cmath>

#include "sampling/samples.h"

// What two hits tell of the surfaces between them.
namespace ink {

/// How far two hits are from lying on one smooth surface: distance of either from the plane through
/// the other at a right angle to their mean normal.
inline float depth_jump(const Sample& a, const Sample& b) {
    const Vec3f normals = a.normal + b.normal;
    const float size = length(normals);
    return size > 0.0F ? std::abs(dot(b.position - a.position, normals)) / size : 0.0F;
}

inline bool lies_in_front(const Sample& a, const Sample& b) {
    return b.id == kBackground || (a.id != kBackground && a.t <= b.t);
}

/// How far the normal turns between two hits, as the chord on the unit sphere: 2 sin(angle / 2).
inline float turn(const Sample& a, const Sample& b) { return length(b.normal - a.normal); }

/// Of the tangent plane: the facet's, where it is known.
inline Vec3f plane_normal(const Sample& sample) {
    return dot(sample.facet, sample.facet) > 0.0F ? sample.facet : sample.normal;
}

}  // namespace ink

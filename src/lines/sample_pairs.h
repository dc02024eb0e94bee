#pragma once

#include <algorithm>
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

/// Whether a surface goes on from one hit to another, beyond a slit. `least_turn`: of a crease.
inline bool one_surface(const Viewpoint& viewpoint, const Sample& a, const Sample& b,
                        float least_turn) {
    constexpr float kOneSurface = 0.2F;
    if (a.id != b.id) return false;
    const Vec3f ray = viewpoint.ray_direction(a);
    const float facing = std::abs(dot(a.normal + b.normal, ray)) * 0.5F;
    // Of surfaces that are seen at a flat angle, even those behind each other are nearly in line.
    if (turn(a, b) > std::min(least_turn, facing)) return false;
    const Vec3f chord = b.position - a.position;
    const float along = dot(chord, ray);
    const float across = std::sqrt(std::max(dot(chord, chord) - along * along, 0.0F));
    return depth_jump(a, b) * std::max(facing, 0.01F) <= kOneSurface * across;
}

/// Whether the surface before a slit goes on beyond it, and is not what is seen within.
inline bool is_slit(const Viewpoint& viewpoint, const Sample& before, const Sample& within,
                    const Sample& beyond, float least_turn) {
    return one_surface(viewpoint, before, beyond, least_turn) &&
           !one_surface(viewpoint, within, beyond, least_turn);
}

/// Of the tangent plane: the facet's, where it is known.
inline Vec3f plane_normal(const Sample& sample) {
    return dot(sample.facet, sample.facet) > 0.0F ? sample.facet : sample.normal;
}

}  // namespace ink

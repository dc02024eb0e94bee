#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace ink::test {

/// Principal curvatures; positive where the surface falls away from its normal.
struct Curvatures {
    double least, most;
};

/// From how a surface and its normals change along two ways on it (Weingarten: the second
/// fundamental form over the first).
inline Curvatures curvatures(Vec3d pu, Vec3d pv, Vec3d nu, Vec3d nv) {
    const double E = dot(pu, pu);
    const double F = dot(pu, pv);
    const double G = dot(pv, pv);
    const double L = dot(nu, pu);
    const double M = 0.5 * (dot(nu, pv) + dot(nv, pu));
    const double N = dot(nv, pv);
    const double area = E * G - F * F;
    const double K = (L * N - M * M) / area;
    const double H = 0.5 * (E * N - 2.0 * F * M + G * L) / area;
    const double root = std::sqrt(std::max(H * H - K, 0.0));
    return {H - root, H + root};
}

}  // namespace ink::test

// How neighbouring samples are compared, some at a time; included once for each instruction set.

#include <cstdint>

#include "base/lanes-inl.h"
#include "lines/suspect_bits.h"
#include "sampling/samples.h"

#if defined(INKTRACE_DETECT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_DETECT_LANES_INL_H
#undef INKTRACE_DETECT_LANES_INL_H
#else
#define INKTRACE_DETECT_LANES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Positions and normals of some points.
struct Surface {
    Number px, py, pz, nx, ny, nz;
};

/// DetectSettings as they are compared with.
struct Thresholds {
    Number sine_squared, least_squared;
    Number crease;  ///< the square of the sum of two unit vectors is 2 (1 + cosine)

    HWY_INLINE explicit Thresholds(const DetectSettings& settings)
        : sine_squared(set(settings.chord_sine * settings.chord_sine)),
          least_squared(set(settings.least_jump * settings.least_jump)),
          crease(set(2.0F + 2.0F * settings.crease_cosine)) {}
};

/// Between hits of one geometry, from bit `i` on: which of them do not fit one smooth surface, and
/// where normals turn.
HWY_INLINE void compare_surfaces(const Surface& a, const Surface& b, int i,
                                 const Thresholds& thresholds, SuspectBits& found) {
    const auto dot = [](Number ax, Number ay, Number az, Number bx, Number by, Number bz) {
        return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
    };
    const Number cx = hn::Sub(b.px, a.px);
    const Number cy = hn::Sub(b.py, a.py);
    const Number cz = hn::Sub(b.pz, a.pz);
    const Number mx = hn::Add(b.nx, a.nx);
    const Number my = hn::Add(b.ny, a.ny);
    const Number mz = hn::Add(b.nz, a.nz);
    const Number along = dot(cx, cy, cz, mx, my, mz);
    const Number chord_squared = dot(cx, cy, cz, cx, cy, cz);
    const Number normal_squared = dot(mx, my, mz, mx, my, mz);
    const Number bound =
        hn::Mul(hn::Max(hn::Mul(thresholds.sine_squared, chord_squared), thresholds.least_squared),
                normal_squared);
    found.depth |= bits_of(hn::Gt(hn::Mul(along, along), bound)) << i;
    found.normal |= bits_of(hn::Lt(normal_squared, thresholds.crease)) << i;
}

/// Where the IDs at the two ends of some edges differ, and where the first one is a hit.
HWY_INLINE std::uint32_t compare_ids(Word first, Word second, int i, SuspectBits& found) {
    found.id |= bits_of(hn::Ne(first, second)) << i;
    return bits_of(hn::Ne(first, hn::Set(kWords, kBackground))) << i;
}

/// Between which pairs of hits no line runs, as they lie on one surface.
HWY_INLINE std::uint32_t share_surface(Word first, Word second, int i) {
    const auto known = hn::Lt(first, hn::Set(kWords, SampleGrid::kUnknownSurface));
    return bits_of(hn::And(hn::Eq(first, second), known)) << i;
}

/// Keeps what is looked for, of edges between hits of one geometry.
HWY_INLINE void keep(std::uint32_t hit, const DetectSettings& settings, SuspectBits& found) {
    found.depth = settings.depths ? found.depth & hit : 0;
    found.normal = settings.normals ? found.normal & hit & ~found.depth : 0;
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

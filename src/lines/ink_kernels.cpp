#include "lines/ink_kernels.h"

#include <cmath>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/ink_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "lines/coverage_lanes-inl.h"

#ifndef INK_BLOCK_OFFSETS
#define INK_BLOCK_OFFSETS
namespace ink {

/// Where the pixels of a block lie, from the first one on.
struct BlockOffsets {
    Lanes<float> x, y;
    constexpr BlockOffsets() : x(), y() {
        for (std::size_t i = 0; i < kLanes; ++i) {
            x.at(i) = static_cast<float>(i % kBlockSide);
            y.at(i) = static_cast<float>(i / kBlockSide);
        }
    }
};
inline constexpr BlockOffsets kBlockOffsets;

}  // namespace ink
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Distances from a band's middle line.
class BandFrame {
  public:
    HWY_INLINE explicit BandFrame(const Band& band)
        : ax_(set(band.a.x)),
          ay_(set(band.a.y)),
          along_x_(set(band.along.x)),
          along_y_(set(band.along.y)),
          length_(set(band.length)) {}
    /// Of the centres of a block's pixels from the i-th on; (x, y) is that of its first pixel.
    HWY_INLINE Number distance(float x, float y, int i) const {
        const Number rx = hn::Sub(hn::Add(set(x), load(kBlockOffsets.x, i)), ax_);
        const Number ry = hn::Sub(hn::Add(set(y), load(kBlockOffsets.y, i)), ay_);
        const Number s = hn::Add(hn::Mul(rx, along_x_), hn::Mul(ry, along_y_));
        const Number across = hn::Sub(hn::Mul(ry, along_x_), hn::Mul(rx, along_y_));
        const Number beyond = hn::Max(hn::Max(hn::Neg(s), hn::Sub(s, length_)), hn::Zero(kFloats));
        return hn::Sqrt(hn::Add(hn::Mul(across, across), hn::Mul(beyond, beyond)));
    }

  private:
    Number ax_, ay_, along_x_, along_y_, length_;
};

/// Where there is ink, `nearest` becomes at most `t`.
HWY_INLINE void keep_nearest(Number ink, float t, float* nearest) {
    const auto inked = hn::Gt(ink, hn::Zero(kFloats));
    const Number at = hn::IfThenElse(inked, set(t), set(kInfinity));
    hn::Store(hn::Min(hn::Load(kFloats, nearest), at), kFloats, nearest);
}

/// Calls `draw(k, x, y)` for those blocks of a range that a band may ink, and marks them; (x, y) is
/// the centre of the block's first pixel.
template <class Draw>
HWY_INLINE void for_each_block(const Band& band, const BlockRange& range, const InkPlanes& planes,
                               const Draw& draw) {
    constexpr float kHalfBlock = 0.5F * (kBlockSide - 1);
    const Vec2f along = band.along;
    // How far a block's pixels reach from its middle, along the band and across it.
    const float extent = 0.5F * kBlockSide * (std::abs(along.x) + std::abs(along.y));
    const float most = band.half + extent;
    for (int row = range.top; row <= range.bottom; ++row) {
        const float y = planes.y0 + static_cast<float>(row * kBlockSide);
        const float ry = y + kHalfBlock - band.a.y;
        for (int column = range.left; column <= range.right; ++column) {
            const float x = planes.x0 + static_cast<float>(column * kBlockSide);
            const float rx = x + kHalfBlock - band.a.x;
            const float s = rx * along.x + ry * along.y;
            if (std::abs(ry * along.x - rx * along.y) > most || s < -most ||
                s > band.length + most) {
                continue;
            }
            const std::size_t k =
                static_cast<std::size_t>(row) * planes.across + static_cast<std::size_t>(column);
            std::uint8_t& touched = planes.touched[k];
            if (touched == kFull) continue;
            touched = kTouched;
            draw(k, x, y);
        }
    }
}

/// A band that is `kWide` reaches beyond every pixel that its far edge could cut.
template <bool kWide>
HWY_INLINE void draw_blocks(const Band& band, const BlockRange& range, const InkPlanes& planes) {
    const SquareCoverage coverage(set(band.along.y), set(band.along.x));
    const BandFrame frame(band);
    const Number half = set(band.half);
    const Number strength = set(band.strength);
    for_each_block(band, range, planes, [&](std::size_t k, float x, float y) HWY_ATTR {
        bool full = planes.t == nullptr;
        for (int i = 0; i < kLanes; i += kStep) {
            const Number distance = frame.distance(x, y, i);
            Number area = coverage(hn::Sub(half, distance));
            if constexpr (!kWide) {
                area = hn::Sub(area, coverage(hn::Sub(hn::Neg(half), distance)));
            }
            const Number ink = hn::Mul(area, strength);
            float* most = planes.coverage[k].data() + i;
            const Number covered = hn::Max(hn::Load(kFloats, most), ink);
            hn::Store(covered, kFloats, most);
            if (planes.t == nullptr) {
                full = full && hn::AllTrue(kFloats, hn::Ge(covered, set(1.0F)));
            } else {
                keep_nearest(ink, band.t, planes.t[k].data() + i);
            }
        }
        if (full) planes.touched[k] = kFull;
    });
}

void draw_band(const Band& band, const BlockRange& range, const InkPlanes& planes) {
    constexpr float kWideHalf = 0.7072F;
    if (band.half >= kWideHalf) {
        draw_blocks<true>(band, range, planes);
    } else {
        draw_blocks<false>(band, range, planes);
    }
}

void draw_soft_band(const Band& band, const BlockRange& range, const InkPlanes& planes,
                    std::span<const float> profile) {
    const hn::RebindToSigned<Floats> indices;
    const BandFrame frame(band);
    const Number half = set(band.half);
    const Number strength = set(band.strength);
    const Number entries = set(static_cast<float>(profile.size() - 1));
    for_each_block(band, range, planes, [&](std::size_t k, float x, float y) HWY_ATTR {
        for (int i = 0; i < kLanes; i += kStep) {
            const Number u = hn::Min(hn::Div(frame.distance(x, y, i), half), set(1.0F));
            const auto entry = hn::ConvertTo(indices, hn::Mul(u, entries));
            const Number ink = hn::Mul(hn::GatherIndex(kFloats, profile.data(), entry), strength);
            float* most = planes.coverage[k].data() + i;
            hn::Store(hn::Max(hn::Load(kFloats, most), ink), kFloats, most);
            if (planes.t != nullptr) keep_nearest(ink, band.t, planes.t[k].data() + i);
        }
    });
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(draw_band);
HWY_EXPORT(draw_soft_band);

void draw_solid(const Band& band, const BlockRange& range, const InkPlanes& planes) {
    HWY_DYNAMIC_DISPATCH(draw_band)(band, range, planes);
}

void draw_soft(const Band& band, const BlockRange& range, const InkPlanes& planes,
               std::span<const float> profile) {
    HWY_DYNAMIC_DISPATCH(draw_soft_band)(band, range, planes, profile);
}

}  // namespace ink

#endif

#include "lines/ink_kernels.h"

#include <algorithm>
#include <cmath>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/ink_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/block_rows-inl.h"
#include "base/vec.h"
#include "lines/border_code.h"
#include "lines/coverage_lanes-inl.h"

#ifndef INK_BLOCK_OFFSETS
#define INK_BLOCK_OFFSETS
namespace ink {

/// Where pixels lie, from the first one on, in rows of so many.
struct PixelOffsets {
    Lanes<float> x, y;
    constexpr explicit PixelOffsets(std::size_t across) : x(), y() {
        for (std::size_t i = 0; i < kLanes; ++i) {
            x.at(i) = static_cast<float>(i % across);
            y.at(i) = static_cast<float>(i / across);
        }
    }
};
inline constexpr PixelOffsets kBlockOffsets{kBlockSide};
inline constexpr PixelOffsets kWindowOffsets{kInkWindowAcross};

}  // namespace ink
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Strokes as straight bands, and the pixels of the tile that each may ink.
struct Bands {
    Lanes<float> along_x, along_y;  ///< unit directions
    Lanes<float> length, half;      ///< half: of the width
    SquareCoverage::Shape shape;
    Lanes<std::int32_t> left, right, top, bottom;  ///< inclusive; maybe none
};

/// Pixels in one direction whose centre lies within `reach` of a stroke's ends.
HWY_INLINE void find_pixels(Number a, Number b, Number reach, float first_centre, int size, int i,
                            Lanes<std::int32_t>& first, Lanes<std::int32_t>& last) {
    const Number low = hn::Sub(hn::Sub(hn::Min(a, b), reach), set(first_centre));
    const Number high = hn::Sub(hn::Add(hn::Max(a, b), reach), set(first_centre));
    const Integer low_pixel = hn::Max(hn::ConvertTo(kIntegers, hn::Ceil(low)), hn::Zero(kIntegers));
    const Integer high_pixel =
        hn::Min(hn::ConvertTo(kIntegers, hn::Floor(high)), hn::Set(kIntegers, size - 1));
    hn::Store(low_pixel, kIntegers, first.data() + i);
    hn::Store(high_pixel, kIntegers, last.data() + i);
}

/// `kSoft`: a band inks only what has its centre within it.
template <bool kSoft>
HWY_INLINE void make_bands(const InkBatch& batch, Bands& bands) {
    constexpr float kRounding = 0.01F;
    const StrokeLanes& strokes = batch.strokes;
    const InkPlanes& planes = *batch.planes[0];
    for (int i = 0; i < kLanes; i += kStep) {
        const Number ax = load(strokes.ax, i);
        const Number ay = load(strokes.ay, i);
        const Number bx = load(strokes.bx, i);
        const Number by = load(strokes.by, i);
        const Number dx = hn::Sub(bx, ax);
        const Number dy = hn::Sub(by, ay);
        const Number length = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        const auto is_point = hn::Le(length, hn::Zero(kFloats));
        const Number scale = hn::Div(set(1.0F), hn::IfThenElse(is_point, set(1.0F), length));
        const Number along_x = hn::IfThenElse(is_point, set(1.0F), hn::Mul(dx, scale));
        const Number along_y = hn::Mul(dy, scale);
        const Number half = hn::Mul(load(strokes.width, i), set(0.5F));
        const SquareCoverage coverage(along_y, along_x);
        const Number within = kSoft ? half : hn::Add(half, coverage.reach());
        const Number reach = hn::Add(within, set(kRounding));
        hn::Store(along_x, kFloats, bands.along_x.data() + i);
        hn::Store(along_y, kFloats, bands.along_y.data() + i);
        hn::Store(length, kFloats, bands.length.data() + i);
        hn::Store(half, kFloats, bands.half.data() + i);
        coverage.store(bands.shape, i);
        find_pixels(ax, bx, reach, planes.x0, batch.width, i, bands.left, bands.right);
        find_pixels(ay, by, reach, planes.y0, batch.height, i, bands.top, bands.bottom);
    }
}

/// A band that is being drawn, a number in all lanes.
class Band {
  public:
    HWY_INLINE Band(const StrokeLanes& strokes, const Bands& bands, int lane)
        : ax_(set(strokes.ax[lane])),
          ay_(set(strokes.ay[lane])),
          along_x_(set(bands.along_x[lane])),
          along_y_(set(bands.along_y[lane])),
          length_(set(bands.length[lane])) {}
    /// From its middle line to the centres of pixels that lie `offsets` from one at (x, y),
    /// squared.
    HWY_INLINE Number squared_distance(float x, float y, Number offsets_x, Number offsets_y) const {
        return squared_distance(column(hn::Add(set(x), offsets_x)), hn::Add(set(y), offsets_y));
    }
    /// What of it depends on x alone.
    struct Column {
        Number along, across;
    };
    HWY_INLINE Column column(Number x) const {
        const Number rx = hn::Sub(x, ax_);
        return {hn::Mul(rx, along_x_), hn::Mul(rx, along_y_)};
    }
    HWY_INLINE Number squared_distance(const Column& column, Number y) const {
        const Number ry = hn::Sub(y, ay_);
        const Number s = hn::Add(column.along, hn::Mul(ry, along_y_));
        const Number across = hn::Sub(hn::Mul(ry, along_x_), column.across);
        const Number beyond = hn::Max(hn::Max(hn::Neg(s), hn::Sub(s, length_)), hn::Zero(kFloats));
        return hn::Add(hn::Mul(across, across), hn::Mul(beyond, beyond));
    }

  private:
    Number ax_, ay_, along_x_, along_y_, length_;
};

/// Adds ink to kStep pixels of a block, from the i-th on.
HWY_INLINE void add_ink(Number ink, float t, const InkPlanes& planes, std::size_t k, int i,
                        bool& any, bool& full) {
    float* most = planes.coverage[k].data() + i;
    const auto inked = hn::Gt(ink, hn::Zero(kFloats));
    const Number covered = hn::Max(hn::Load(kFloats, most), ink);
    hn::Store(covered, kFloats, most);
    any = any || !hn::AllFalse(kFloats, inked);
    if (planes.t == nullptr) {
        full = full && hn::AllTrue(kFloats, hn::Ge(covered, set(1.0F)));
        return;
    }
    full = false;
    float* nearest = planes.t[k].data() + i;
    const Number at = hn::IfThenElse(inked, set(t), set(kInfinity));
    hn::Store(hn::Min(hn::Load(kFloats, nearest), at), kFloats, nearest);
}

/// Calls `draw(x, y, k)` for each block that stroke `lane` of a batch may reach: (x, y) is the
/// centre of its first pixel, k its index.
template <class Draw>
HWY_INLINE void for_each_block(const InkBatch& batch, const Bands& bands, int lane,
                               const Draw& draw) {
    constexpr float kHalfBlock = 0.5F * (kBlockSide - 1);
    static_assert(kBlockSide == 4);
    const InkPlanes& planes = *batch.planes[static_cast<std::size_t>(lane)];
    const float ax = batch.strokes.ax[lane];
    const float ay = batch.strokes.ay[lane];
    const float along_x = bands.along_x[lane];
    const float along_y = bands.along_y[lane];
    // How far a block's pixels reach from its middle, along the band and across it.
    const float extent = 0.5F * kBlockSide * (std::abs(along_x) + std::abs(along_y));
    const float most = bands.half[lane] + extent;
    const float last = bands.length[lane] + most;
    for (int row = bands.top[lane] >> 2; row <= bands.bottom[lane] >> 2; ++row) {
        const float y = planes.y0 + static_cast<float>(row * kBlockSide);
        const float ry = y + kHalfBlock - ay;
        for (int column = bands.left[lane] >> 2; column <= bands.right[lane] >> 2; ++column) {
            const float x = planes.x0 + static_cast<float>(column * kBlockSide);
            const float rx = x + kHalfBlock - ax;
            const float s = rx * along_x + ry * along_y;
            if (std::abs(ry * along_x - rx * along_y) > most || s < -most || s > last) continue;
            draw(x, y,
                 static_cast<std::size_t>(row) * planes.across + static_cast<std::size_t>(column));
        }
    }
}

/// Draws stroke `lane` of a batch: `ink_at(x, y, i)` is the ink of kStep pixels of a block from the
/// i-th on, (x, y) the centre of the first one.
template <class InkAt>
HWY_INLINE void draw_blocks(const InkBatch& batch, const Bands& bands, int lane,
                            const InkAt& ink_at) {
    const InkPlanes& planes = *batch.planes[static_cast<std::size_t>(lane)];
    const float t = batch.strokes.t[lane];
    for_each_block(batch, bands, lane, [&](float x, float y, std::size_t k) HWY_ATTR {
        std::uint8_t& touched = planes.touched[k];
        if (touched == kFull) return;
        bool any = false;
        bool full = true;
        for (int i = 0; i < kLanes; i += kStep) {
            add_ink(ink_at(x, y, i), t, planes, k, i, any, full);
        }
        touched = full ? kFull : static_cast<std::uint8_t>(touched | (any ? kTouched : 0));
    });
}

/// The same of a narrow one, in windows that begin where it does: mostly one is as wide as all that
/// it inks. `ink_at(distance)` is the ink of pixels at a distance from its middle line.
template <class InkAt>
HWY_INLINE void draw_narrow(const InkBatch& batch, const Bands& bands, int lane, const Band& band,
                            const InkAt& ink_at) {
    constexpr int kAcross = std::min(kStep, static_cast<int>(kInkWindowAcross));
    constexpr int kDown = kStep / kAcross;
    const InkPlanes& planes = *batch.planes[static_cast<std::size_t>(lane)];
    const int left = bands.left[lane];
    const int right = bands.right[lane];
    const int top = bands.top[lane];
    const int bottom = bands.bottom[lane];
    if (left > right || top > bottom) return;
    const Number t = set(batch.strokes.t[lane]);
    for (int x = left; x <= right; x += kAcross) {
        const Band::Column column =
            band.column(hn::Add(set(planes.x0 + static_cast<float>(x)), load(kWindowOffsets.x, 0)));
        Number centre_y =
            hn::Add(set(planes.y0 + static_cast<float>(top)), load(kWindowOffsets.y, 0));
        std::size_t at =
            static_cast<std::size_t>(top) * planes.stride + static_cast<std::size_t>(x);
        for (int y = top; y <= bottom; y += kDown) {
            const Number ink = ink_at(hn::Sqrt(band.squared_distance(column, centre_y)));
            float* const most = planes.narrow + at;
            store_rows<kInkWindowAcross>(
                kFloats, hn::Max(load_rows<kInkWindowAcross>(kFloats, most, planes.stride), ink),
                most, planes.stride);
            if (planes.narrow_t != nullptr) {
                float* const nearest = planes.narrow_t + at;
                const auto inked = hn::Gt(ink, hn::Zero(kFloats));
                const Number own = hn::IfThenElse(inked, t, set(kInfinity));
                store_rows<kInkWindowAcross>(
                    kFloats,
                    hn::Min(load_rows<kInkWindowAcross>(kFloats, nearest, planes.stride), own),
                    nearest, planes.stride);
            }
            centre_y = hn::Add(centre_y, set(static_cast<float>(kDown)));
            at += static_cast<std::size_t>(kDown) * planes.stride;
        }
    }
    for (int row = top / kBlockSide; row <= bottom / kBlockSide; ++row) {
        for (int column = left / kBlockSide; column <= right / kBlockSide; ++column) {
            planes.touched[static_cast<std::size_t>(row) * planes.across +
                           static_cast<std::size_t>(column)] |= kTouched;
        }
    }
}

void draw_solid_batch(const InkBatch& batch) {
    // A band that is wider on either side reaches beyond every pixel that its far edge could cut.
    constexpr float kWideHalf = 0.7072F;
    // One that is wider still fills blocks, which are left out from then on.
    constexpr float kNarrowHalf = 8.0F;
    Bands bands;
    make_bands<false>(batch, bands);
    for (int lane = 0; lane < batch.count; ++lane) {
        const Band band(batch.strokes, bands, lane);
        const SquareCoverage coverage(bands.shape, lane);
        const Number half = set(bands.half[lane]);
        const Number strength = set(batch.strokes.strength[lane]);
        const auto wide_ink = [&](Number distance) HWY_ATTR {
            return hn::Mul(coverage(hn::Sub(half, distance)), strength);
        };
        if (bands.half[lane] > kNarrowHalf) {
            draw_blocks(batch, bands, lane, [&](float x, float y, int i) HWY_ATTR {
                return wide_ink(hn::Sqrt(band.squared_distance(x, y, load(kBlockOffsets.x, i),
                                                               load(kBlockOffsets.y, i))));
            });
            continue;
        }
        if (bands.half[lane] >= kWideHalf) {
            draw_narrow(batch, bands, lane, band, wide_ink);
            continue;
        }
        draw_narrow(batch, bands, lane, band, [&](Number distance) HWY_ATTR {
            const Number near_side = coverage(hn::Sub(half, distance));
            const Number far_side = coverage(hn::Sub(hn::Neg(half), distance));
            return hn::Mul(hn::Sub(near_side, far_side), strength);
        });
    }
}

void finish_solid_blocks(const InkPlanes& planes, std::size_t blocks) {
    std::size_t k = 0;
    for (std::size_t row = 0; k < blocks; ++row) {
        std::size_t first = row * kBlockSide * planes.stride;
        for (std::size_t column = 0; column < planes.across; ++column, ++k, first += kBlockSide) {
            if (planes.touched[k] == 0) continue;
            for (int i = 0; i < kLanes; i += kStep) {
                const std::size_t at =
                    first + static_cast<std::size_t>(i / kBlockSide) * planes.stride;
                const Number ink = load_rows(kFloats, planes.narrow + at, planes.stride);
                store(hn::Max(load(planes.coverage[k], i), ink), planes.coverage[k], i);
                if (planes.t == nullptr) continue;
                const Number t = load_rows(kFloats, planes.narrow_t + at, planes.stride);
                store(hn::Min(load(planes.t[k], i), t), planes.t[k], i);
            }
        }
    }
}

/// Of a soft line: `u` is the distance from it over half its width, in [0, 1].
HWY_INLINE Number profile_at(std::span<const float> profile, Number u) {
    const Number place = hn::Mul(u, set(static_cast<float>(profile.size() - 2)));
    const auto entry = hn::ConvertTo(kIntegers, place);
    const Number from = hn::GatherIndex(kFloats, profile.data(), entry);
    const Number to = hn::GatherIndex(kFloats, profile.data() + 1, entry);
    const Number beyond = hn::Sub(place, hn::ConvertTo(kFloats, entry));
    return hn::Add(from, hn::Mul(hn::Sub(to, from), beyond));
}

void draw_soft_batch(const InkBatch& batch, std::span<const float> profile) {
    Bands bands;
    make_bands<true>(batch, bands);
    for (int lane = 0; lane < batch.count; ++lane) {
        const Band band(batch.strokes, bands, lane);
        const float half = bands.half[lane];
        if (half <= 0.0F) continue;
        const Number per_half = set(1.0F / (half * half));
        const auto squared_at = [&](float x, float y, int i) HWY_ATTR {
            return hn::Mul(
                band.squared_distance(x, y, load(kBlockOffsets.x, i), load(kBlockOffsets.y, i)),
                per_half);
        };
        if (batch.strokes.strength[lane] != 1.0F) {
            const Number strength = set(batch.strokes.strength[lane]);
            draw_blocks(batch, bands, lane, [&](float x, float y, int i) HWY_ATTR {
                const Number u = hn::Sqrt(hn::Min(squared_at(x, y, i), set(1.0F)));
                return hn::Mul(profile_at(profile, u), strength);
            });
            continue;
        }
        const InkPlanes& planes = *batch.planes[static_cast<std::size_t>(lane)];
        const Number t = set(batch.strokes.t[lane]);
        for_each_block(batch, bands, lane, [&](float x, float y, std::size_t k) HWY_ATTR {
            for (int i = 0; i < kLanes; i += kStep) {
                const Number squared = squared_at(x, y, i);
                float* const least = planes.squared[k].data() + i;
                hn::Store(hn::Min(hn::Load(kFloats, least), squared), kFloats, least);
                const auto inked = hn::Lt(squared, set(1.0F));
                if (hn::AllFalse(kFloats, inked)) continue;
                planes.touched[k] |= kTouched;
                if (planes.t == nullptr) continue;
                float* const nearest = planes.t[k].data() + i;
                const Number own = hn::IfThenElse(inked, t, set(kInfinity));
                hn::Store(hn::Min(hn::Load(kFloats, nearest), own), kFloats, nearest);
            }
        });
    }
}

void finish_soft_blocks(const InkPlanes& planes, std::size_t blocks,
                        std::span<const float> profile) {
    for (std::size_t k = 0; k < blocks; ++k) {
        if (planes.touched[k] == 0) continue;
        for (int i = 0; i < kLanes; i += kStep) {
            const Number squared = hn::Min(load(planes.squared[k], i), set(1.0F));
            const Number ink = profile_at(profile, hn::Sqrt(squared));
            float* const most = planes.coverage[k].data() + i;
            hn::Store(hn::Max(hn::Load(kFloats, most), ink), kFloats, most);
        }
    }
}

/// More than half a diagonal of a pixel: farther from a band no pixel gets ink.
constexpr float kBeyondBand = 0.75F;

/// Borders that some pixels of a block see, from the i-th on.
class BorderLanes {
  public:
    HWY_INLINE BorderLanes(const Lanes<std::uint32_t>& codes, float reach, int i)
        : code_(hn::Load(kNumbers, codes.data() + i)),
          distance_(hn::Mul(number(hn::ShiftRight<16>(code_)), set(reach / BorderCode::kSteps))) {}

    /// Whether none gets ink from a band of that half width.
    HWY_INLINE bool beyond(float half) const {
        return hn::AllTrue(kFloats, hn::Ge(distance_, set(half + kBeyondBand)));
    }
    HWY_INLINE Number ink(float half) const {
        const Number narrow = hn::Mul(number(hn::And(code_, hn::Set(kNumbers, 0xFFFFU))),
                                      set(BorderCode::kMostNarrow / BorderCode::kSteps));
        const Number wide = hn::Sqrt(hn::Sub(set(1.0F), hn::Mul(narrow, narrow)));
        const SquareCoverage area(wide, narrow);
        return hn::Sub(area(hn::Sub(set(half), distance_)), area(hn::Sub(set(-half), distance_)));
    }

  private:
    static constexpr hn::RebindToUnsigned<Floats> kNumbers{};

    HWY_INLINE Number number(hn::Vec<hn::RebindToUnsigned<Floats>> bits) const {
        return hn::ConvertTo(kFloats, hn::BitCast(kIntegers, bits));
    }

    hn::Vec<hn::RebindToUnsigned<Floats>> code_;
    Number distance_;
};

bool draw_border_lanes(const Lanes<std::uint32_t>& codes, float reach, float half,
                       const Lanes<float>& depths, float behind, Lanes<float>& coverage,
                       Lanes<float>& nearest) {
    bool any = false;
    for (int i = 0; i < kLanes; i += kStep) {
        const BorderLanes borders(codes, reach, i);
        if (borders.beyond(half)) continue;
        any = true;
        const Number ink = borders.ink(half);
        float* const most = coverage.data() + i;
        hn::Store(hn::Max(hn::Load(kFloats, most), ink), kFloats, most);
        float* const t = nearest.data() + i;
        const auto inked = hn::Gt(ink, hn::Zero(kFloats));
        const Number own = hn::Add(load(depths, i), set(behind));
        hn::Store(hn::Min(hn::Load(kFloats, t), hn::IfThenElse(inked, own, set(kInfinity))),
                  kFloats, t);
    }
    return any;
}

bool ink_border_lanes(const Lanes<std::uint32_t>& codes, float reach, float half, float opacity,
                      Lanes<float>& alpha) {
    bool any = false;
    for (int i = 0; i < kLanes; i += kStep) {
        const BorderLanes borders(codes, reach, i);
        if (borders.beyond(half)) continue;
        any = true;
        store(hn::Max(hn::Mul(borders.ink(half), set(opacity)), load(alpha, i)), alpha, i);
    }
    return any;
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(draw_border_lanes);
HWY_EXPORT(ink_border_lanes);
HWY_EXPORT(draw_solid_batch);
HWY_EXPORT(draw_soft_batch);
HWY_EXPORT(finish_solid_blocks);
HWY_EXPORT(finish_soft_blocks);

void draw_solid(const InkBatch& batch) { HWY_DYNAMIC_DISPATCH(draw_solid_batch)(batch); }

void finish_solid(const InkPlanes& planes, std::size_t blocks) {
    HWY_DYNAMIC_DISPATCH(finish_solid_blocks)(planes, blocks);
}

bool draw_borders(const Lanes<std::uint32_t>& codes, float reach, float half,
                  const Lanes<float>& depths, float behind, Lanes<float>& coverage,
                  Lanes<float>& nearest) {
    return HWY_DYNAMIC_DISPATCH(draw_border_lanes)(codes, reach, half, depths, behind, coverage,
                                                   nearest);
}

bool ink_borders(const Lanes<std::uint32_t>& codes, float reach, float half, float opacity,
                 Lanes<float>& alpha) {
    return HWY_DYNAMIC_DISPATCH(ink_border_lanes)(codes, reach, half, opacity, alpha);
}

void draw_soft(const InkBatch& batch, std::span<const float> profile) {
    HWY_DYNAMIC_DISPATCH(draw_soft_batch)(batch, profile);
}

void finish_soft(const InkPlanes& planes, std::size_t blocks, std::span<const float> profile) {
    HWY_DYNAMIC_DISPATCH(finish_soft_blocks)(planes, blocks, profile);
}

}  // namespace ink

#endif

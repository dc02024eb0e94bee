#include "lines/detect.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "base/lanes.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/detect.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef INK_DETECT_RUNS
#define INK_DETECT_RUNS
namespace ink {

/// The planes of a grid as pointers.
struct GridPlanes {
    const GeometryId* id;
    const std::uint32_t* surface;
    const float *px, *py, *pz, *nx, *ny, *nz;

    explicit GridPlanes(const SampleGrid& grid)
        : id(grid.id.data()),
          surface(grid.surface.empty() ? nullptr : grid.surface.data()),
          px(grid.px.data()),
          py(grid.py.data()),
          pz(grid.pz.data()),
          nx(grid.nx.data()),
          ny(grid.ny.data()),
          nz(grid.nz.data()) {}
};

/// Bit i is set for the edge that hangs on point i of sixteen.
struct Suspects {
    std::uint32_t id, depth, normal;
    std::uint32_t any() const { return id | depth | normal; }
};

/// The edges of sixteen points that follow each other in the grid, row after row.
struct SuspectRun {
    std::size_t first;
    Suspects right, down;
};

}  // namespace ink
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Ids = hn::Rebind<GeometryId, Floats>;
constexpr Floats kFloats;
constexpr Ids kIds;
constexpr auto kStep = static_cast<int>(hn::MaxLanes(Floats()));
using Number = hn::Vec<Floats>;

HWY_INLINE Number load(const float* from) { return hn::LoadU(kFloats, from); }

template <class Tag, class Mask>
HWY_INLINE std::uint32_t bits_of([[maybe_unused]] Tag tag, Mask mask) {
#if HWY_TARGET <= HWY_AVX3
    return static_cast<std::uint32_t>(mask.raw);
#endif
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(tag, mask, bytes);
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U;
}

/// Positions and normals of some points.
struct Surface {
    Number px, py, pz, nx, ny, nz;

    HWY_INLINE Surface(const GridPlanes& grid, std::size_t at)
        : px(load(grid.px + at)),
          py(load(grid.py + at)),
          pz(load(grid.pz + at)),
          nx(load(grid.nx + at)),
          ny(load(grid.ny + at)),
          nz(load(grid.nz + at)) {}
};

/// DetectSettings as they are compared with.
struct Thresholds {
    Number sine_squared, least_squared;
    Number crease;  ///< the square of the sum of two unit vectors is 2 (1 + cosine)

    HWY_INLINE explicit Thresholds(const DetectSettings& settings)
        : sine_squared(hn::Set(kFloats, settings.chord_sine * settings.chord_sine)),
          least_squared(hn::Set(kFloats, settings.least_jump * settings.least_jump)),
          crease(hn::Set(kFloats, 2.0F + 2.0F * settings.crease_cosine)) {}
};

/// Between hits of one geometry: which of them do not fit one smooth surface, and where normals
/// turn.
HWY_INLINE void compare_surfaces(const Surface& a, const Surface& b, int i,
                                 const Thresholds& thresholds, Suspects& found) {
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
    found.depth |= bits_of(kFloats, hn::Gt(hn::Mul(along, along), bound)) << i;
    found.normal |= bits_of(kFloats, hn::Lt(normal_squared, thresholds.crease)) << i;
}

/// Where the IDs of sixteen edges differ; and those that hit one geometry at both ends.
HWY_INLINE std::uint32_t compare_ids(const GeometryId* a, const GeometryId* b, std::uint32_t wanted,
                                     Suspects& found) {
    std::uint32_t hit = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto first = hn::LoadU(kIds, a + i);
        const auto second = hn::LoadU(kIds, b + i);
        found.id |= bits_of(kIds, hn::Ne(first, second)) << i;
        hit |= bits_of(kIds, hn::Ne(first, hn::Set(kIds, kBackground))) << i;
    }
    found.id &= wanted;
    return hit & wanted & ~found.id;
}

/// Between which of sixteen pairs of hits no line runs, as they lie on one surface.
HWY_INLINE std::uint32_t share_surface(const std::uint32_t* a, const std::uint32_t* b) {
    std::uint32_t shared = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto first = hn::LoadU(kIds, a + i);
        const auto second = hn::LoadU(kIds, b + i);
        const auto known = hn::Lt(first, hn::Set(kIds, SampleGrid::kUnknownSurface));
        shared |= bits_of(kIds, hn::And(hn::Eq(first, second), known)) << i;
    }
    return shared;
}

HWY_INLINE void keep(std::uint32_t hit, const DetectSettings& settings, Suspects& found) {
    found.depth = settings.depths ? found.depth & hit : 0;
    found.normal = settings.normals ? found.normal & hit & ~found.depth : 0;
}

/// The first `count` edges of sixteen.
HWY_INLINE std::uint32_t first_bits(std::size_t count) {
    return (1U << std::min<std::size_t>(count, kLanes)) - 1;
}

/// Compares all points with those on the right and below. Returns how many runs have a suspect.
std::size_t compare(const SampleGrid& grid, const DetectSettings& settings, SuspectRun* runs) {
    const GridPlanes planes(grid);
    const Thresholds thresholds(settings);
    const bool by_surface = settings.depths || settings.normals;
    const auto width = static_cast<std::size_t>(grid.width);
    const std::size_t count = width * static_cast<std::size_t>(grid.height);
    const std::size_t last_row = count - width;
    std::size_t row_end = width - 1;  // nothing on its right
    const SuspectRun* const before = runs;
    for (std::size_t first = 0; first < count; first += kLanes) {
        std::uint32_t has_right = first_bits(count - first);
        for (; row_end < first + kLanes; row_end += width) has_right &= ~(1U << (row_end - first));
        const std::uint32_t has_below = first < last_row ? first_bits(last_row - first) : 0;
        const std::size_t below = has_below != 0 ? first + width : first;
        Suspects across{};
        Suspects along{};
        const GeometryId* const id = planes.id + first;
        std::uint32_t hit_b = compare_ids(id, id + 1, has_right, across);
        std::uint32_t hit_c = compare_ids(id, planes.id + below, has_below, along);
        if (planes.surface != nullptr && (hit_b | hit_c) != 0) {
            const std::uint32_t* const surface = planes.surface + first;
            hit_b &= ~share_surface(surface, surface + 1);
            hit_c &= ~share_surface(surface, planes.surface + below);
        }
        if ((hit_b | hit_c) != 0 && by_surface) {
            for (int i = 0; i < kLanes; i += kStep) {
                const auto at = static_cast<std::size_t>(i);
                const Surface own(planes, first + at);
                compare_surfaces(own, Surface(planes, first + at + 1), i, thresholds, across);
                compare_surfaces(own, Surface(planes, below + at), i, thresholds, along);
            }
            keep(hit_b, settings, across);
            keep(hit_c, settings, along);
        }
        *runs = {first, across, along};
        if ((across.any() | along.any()) != 0) ++runs;
    }
    return static_cast<std::size_t>(runs - before);
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(compare);

namespace {

/// Of edges that hang on points of row j, the first of which is (i, j).
void collect(const Suspects& some, std::uint32_t those, int i, int j, bool down,
             std::vector<SuspectEdge>& edges) {
    for (std::uint32_t rest = some.any() & those; rest != 0; rest &= rest - 1) {
        const std::uint32_t bit = rest & (0U - rest);
        const Suspicion suspicion = (some.id & bit) != 0      ? Suspicion::id
                                    : (some.depth & bit) != 0 ? Suspicion::depth
                                                              : Suspicion::normal;
        edges.push_back({static_cast<std::uint16_t>(i + std::countr_zero(rest)),
                         static_cast<std::uint16_t>(j), down, suspicion});
    }
}

void collect(const SuspectRun& run, int width, std::vector<SuspectEdge>& edges) {
    const auto first = static_cast<int>(run.first);
    int i = first % width;
    int j = first / width;
    for (int begin = 0; begin < kLanes; i = 0, ++j) {
        const int end = std::min(begin + width - i, kLanes);
        const std::uint32_t those = (1U << end) - (1U << begin);
        collect(run.right, those, i - begin, j, false, edges);
        collect(run.down, those, i - begin, j, true, edges);
        begin = end;
    }
}

}  // namespace

void detect(const SampleGrid& grid, const DetectSettings& settings,
            std::vector<SuspectEdge>& edges) {
    edges.clear();
    const auto points =
        static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
    // One more, for what has no suspects.
    const std::size_t most = (points + kLanes - 1) / kLanes + 1;
    const auto runs = std::make_unique_for_overwrite<SuspectRun[]>(most);
    const std::size_t count = HWY_DYNAMIC_DISPATCH(compare)(grid, settings, runs.get());
    for (std::size_t k = 0; k < count; ++k) collect(runs[k], grid.width, edges);
}

}  // namespace ink

#endif

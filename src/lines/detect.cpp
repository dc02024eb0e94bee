#include "lines/detect.h"

#include <algorithm>
#include <memory>

#include "lines/suspect_bits.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/detect.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "lines/detect_lanes-inl.h"

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

/// The edges of sixteen points that follow each other in the grid, row after row.
struct SuspectRun {
    std::size_t first;
    SuspectBits right, down;
};

}  // namespace ink
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

HWY_INLINE Number load(const float* from) { return hn::LoadU(kFloats, from); }

HWY_INLINE Surface load_surface(const GridPlanes& grid, std::size_t at) {
    return {load(grid.px + at), load(grid.py + at), load(grid.pz + at),
            load(grid.nx + at), load(grid.ny + at), load(grid.nz + at)};
}

/// Where the IDs of sixteen edges differ; and those that hit one geometry at both ends.
HWY_INLINE std::uint32_t compare_id_runs(const GeometryId* a, const GeometryId* b,
                                         std::uint32_t wanted, SuspectBits& found) {
    std::uint32_t hit = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        hit |= compare_ids(hn::LoadU(kWords, a + i), hn::LoadU(kWords, b + i), i, found);
    }
    found.id &= wanted;
    return hit & wanted & ~found.id;
}

/// Between which of sixteen pairs of hits no line runs.
HWY_INLINE std::uint32_t share_surfaces(const std::uint32_t* a, const std::uint32_t* b) {
    std::uint32_t shared = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        shared |= share_surface(hn::LoadU(kWords, a + i), hn::LoadU(kWords, b + i), i);
    }
    return shared;
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
        SuspectBits across{};
        SuspectBits along{};
        const GeometryId* const id = planes.id + first;
        std::uint32_t hit_b = compare_id_runs(id, id + 1, has_right, across);
        std::uint32_t hit_c = compare_id_runs(id, planes.id + below, has_below, along);
        if (planes.surface != nullptr && (hit_b | hit_c) != 0) {
            const std::uint32_t* const surface = planes.surface + first;
            hit_b &= ~share_surfaces(surface, surface + 1);
            hit_c &= ~share_surfaces(surface, planes.surface + below);
        }
        if ((hit_b | hit_c) != 0 && by_surface) {
            for (int i = 0; i < kLanes; i += kStep) {
                const auto at = static_cast<std::size_t>(i);
                const Surface own = load_surface(planes, first + at);
                compare_surfaces(own, load_surface(planes, first + at + 1), i, thresholds, across);
                compare_surfaces(own, load_surface(planes, below + at), i, thresholds, along);
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

void collect(const SuspectRun& run, int width, std::vector<SuspectEdge>& edges) {
    const auto first = static_cast<int>(run.first);
    int i = first % width;
    int j = first / width;
    for (int begin = 0; begin < kLanes; i = 0, ++j) {
        const int end = std::min(begin + width - i, kLanes);
        const std::uint32_t those = (1U << end) - (1U << begin);
        const auto point = [&](int bit) { return std::pair{i - begin + bit, j}; };
        run.right.list(those, false, point, edges);
        run.down.list(those, true, point, edges);
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

#include "lines/detect.h"

#include <algorithm>
#include <bit>
#include <span>

#include "base/lanes.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/detect.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef INK_DETECT_ROWS
#define INK_DETECT_ROWS
namespace ink {

/// Part of a row of the grid as pointers.
struct GridRow {
    const GeometryId* id;
    const float *px, *py, *pz, *nx, *ny, *nz;

    GridRow(const SampleGrid& grid, std::size_t first)
        : id(grid.id.data() + first),
          px(grid.px.data() + first),
          py(grid.py.data() + first),
          pz(grid.pz.data() + first),
          nx(grid.nx.data() + first),
          ny(grid.ny.data() + first),
          nz(grid.nz.data() + first) {}
};

/// Bit i is set for the edge between points i of two rows.
struct Suspects {
    std::uint32_t id, depth, normal;
    std::uint32_t any() const { return id | depth | normal; }
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

    HWY_INLINE Surface(const GridRow& row, int i)
        : px(load(row.px + i)),
          py(load(row.py + i)),
          pz(load(row.pz + i)),
          nx(load(row.nx + i)),
          ny(load(row.ny + i)),
          nz(load(row.nz + i)) {}
};

/// Between hits of one geometry: which of them do not fit one smooth surface, and where normals
/// turn.
HWY_INLINE void compare_surfaces(const Surface& a, const Surface& b, int i,
                                 const DetectSettings& settings, Suspects& found) {
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
    const Number sine_squared = hn::Set(kFloats, settings.chord_sine * settings.chord_sine);
    const Number least_squared = hn::Set(kFloats, settings.least_jump * settings.least_jump);
    const Number bound =
        hn::Mul(hn::Max(hn::Mul(sine_squared, chord_squared), least_squared), normal_squared);
    const Number turn = dot(a.nx, a.ny, a.nz, b.nx, b.ny, b.nz);
    found.depth |= bits_of(kFloats, hn::Gt(hn::Mul(along, along), bound)) << i;
    found.normal |= bits_of(kFloats, hn::Lt(turn, hn::Set(kFloats, settings.crease_cosine))) << i;
}

/// Where the IDs of sixteen edges differ; and those that hit one geometry at both ends.
HWY_INLINE std::uint32_t compare_ids(const GridRow& a, const GridRow& b, std::uint32_t wanted,
                                     Suspects& found) {
    std::uint32_t hit = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto first = hn::LoadU(kIds, a.id + i);
        const auto second = hn::LoadU(kIds, b.id + i);
        found.id |= bits_of(kIds, hn::Ne(first, second)) << i;
        hit |= bits_of(kIds, hn::Ne(first, hn::Set(kIds, kBackground))) << i;
    }
    found.id &= wanted;
    return hit & wanted & ~found.id;
}

HWY_INLINE void keep(std::uint32_t hit, const DetectSettings& settings, Suspects& found) {
    found.depth = settings.depths ? found.depth & hit : 0;
    found.normal = settings.normals ? found.normal & hit & ~found.depth : 0;
}

/// The first `count` edges of sixteen.
HWY_INLINE std::uint32_t first_bits(int count) {
    return count <= 0 ? 0 : (1U << std::min(count, kLanes)) - 1;
}

/// The edges that hang on the points of a row, to the right and down to the row `below`, sixteen an
/// entry. False if there are no suspects.
bool compare(const SampleGrid& grid, std::size_t row, std::size_t below, bool has_below,
             const DetectSettings& settings, Suspects* right, Suspects* down) {
    std::uint32_t any = 0;
    for (int first = 0; first < grid.width; first += kLanes) {
        const auto offset = static_cast<std::size_t>(first);
        const GridRow a(grid, row + offset);
        const GridRow b(grid, row + offset + 1);
        const GridRow c(grid, below + offset);
        Suspects across{};
        Suspects along{};
        const std::uint32_t hit_b = compare_ids(a, b, first_bits(grid.width - 1 - first), across);
        const std::uint32_t hit_c =
            compare_ids(a, c, has_below ? first_bits(grid.width - first) : 0, along);
        if ((hit_b | hit_c) != 0 && (settings.depths || settings.normals)) {
            for (int i = 0; i < kLanes; i += kStep) {
                const Surface own(a, i);
                compare_surfaces(own, Surface(b, i), i, settings, across);
                compare_surfaces(own, Surface(c, i), i, settings, along);
            }
            keep(hit_b, settings, across);
            keep(hit_c, settings, along);
        }
        any |= across.any() | along.any();
        *right++ = across;
        *down++ = along;
    }
    return any != 0;
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(compare);

namespace {

void collect(std::span<const Suspects> row, int j, bool down, std::vector<SuspectEdge>& edges) {
    int i = 0;
    for (const Suspects& some : row) {
        for (std::uint32_t rest = some.any(); rest != 0; rest &= rest - 1) {
            const std::uint32_t bit = rest & (0U - rest);
            const Suspicion suspicion = (some.id & bit) != 0      ? Suspicion::id
                                        : (some.depth & bit) != 0 ? Suspicion::depth
                                                                  : Suspicion::normal;
            edges.push_back({static_cast<std::uint16_t>(i + std::countr_zero(rest)),
                             static_cast<std::uint16_t>(j), down, suspicion});
        }
        i += kLanes;
    }
}

}  // namespace

void detect(const SampleGrid& grid, const DetectSettings& settings,
            std::vector<SuspectEdge>& edges) {
    edges.clear();
    const auto size = static_cast<std::size_t>((grid.width + kLanes - 1) / kLanes);
    std::vector<Suspects> right(size);
    std::vector<Suspects> down(size);
    for (int j = 0; j < grid.height; ++j) {
        const bool has_below = j + 1 < grid.height;
        const std::size_t row = grid.index(0, j);
        const std::size_t below = has_below ? grid.index(0, j + 1) : row;
        if (!HWY_DYNAMIC_DISPATCH(compare)(grid, row, below, has_below, settings, right.data(),
                                           down.data())) {
            continue;
        }
        collect(right, j, false, edges);
        collect(down, j, true, edges);
    }
}

}  // namespace ink

#endif

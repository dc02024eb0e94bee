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
using Number = hn::Vec<Floats>;

HWY_INLINE Number load(const float* from) { return hn::LoadU(kFloats, from); }

template <class Tag, class Mask>
HWY_INLINE std::uint32_t bits_of(Tag tag, Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(tag, mask, bytes);
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U;
}

/// Between hits of one geometry: whether they do not fit one smooth surface, or their normals turn.
HWY_INLINE void compare_surfaces(const GridRow& a, const GridRow& b, int i,
                                 const DetectSettings& settings, std::uint32_t& broken,
                                 std::uint32_t& bent) {
    const auto dot = [](Number ax, Number ay, Number az, Number bx, Number by, Number bz) {
        return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
    };
    const Number cx = hn::Sub(load(b.px + i), load(a.px + i));
    const Number cy = hn::Sub(load(b.py + i), load(a.py + i));
    const Number cz = hn::Sub(load(b.pz + i), load(a.pz + i));
    const Number ax = load(a.nx + i);
    const Number ay = load(a.ny + i);
    const Number az = load(a.nz + i);
    const Number bx = load(b.nx + i);
    const Number by = load(b.ny + i);
    const Number bz = load(b.nz + i);
    const Number mx = hn::Add(bx, ax);
    const Number my = hn::Add(by, ay);
    const Number mz = hn::Add(bz, az);
    const Number along = dot(cx, cy, cz, mx, my, mz);
    const Number chord_squared = dot(cx, cy, cz, cx, cy, cz);
    const Number normal_squared = dot(mx, my, mz, mx, my, mz);
    const Number sine_squared = hn::Set(kFloats, settings.chord_sine * settings.chord_sine);
    const Number least_squared = hn::Set(kFloats, settings.least_jump * settings.least_jump);
    const Number bound =
        hn::Mul(hn::Max(hn::Mul(sine_squared, chord_squared), least_squared), normal_squared);
    const Number turn = dot(ax, ay, az, bx, by, bz);
    broken = bits_of(kFloats, hn::Gt(hn::Mul(along, along), bound));
    bent = bits_of(kFloats, hn::Lt(turn, hn::Set(kFloats, settings.crease_cosine)));
}

/// Sixteen edges from the points on that the rows begin with.
HWY_INLINE Suspects compare_some(const GridRow& a, const GridRow& b, std::uint32_t wanted,
                                 const DetectSettings& settings) {
    Suspects found{};
    std::uint32_t hit = 0;
    constexpr auto kStep = static_cast<int>(hn::MaxLanes(Floats()));
    for (int i = 0; i < kLanes; i += kStep) {
        const auto first = hn::LoadU(kIds, a.id + i);
        const auto second = hn::LoadU(kIds, b.id + i);
        found.id |= bits_of(kIds, hn::Ne(first, second)) << i;
        hit |= bits_of(kIds, hn::Ne(first, hn::Set(kIds, kBackground))) << i;
    }
    found.id &= wanted;
    hit &= wanted & ~found.id;
    if (hit == 0 || !(settings.depths || settings.normals)) return found;
    for (int i = 0; i < kLanes; i += kStep) {
        std::uint32_t broken = 0;
        std::uint32_t bent = 0;
        compare_surfaces(a, b, i, settings, broken, bent);
        found.depth |= broken << i;
        found.normal |= bent << i;
    }
    found.depth = settings.depths ? found.depth & hit : 0;
    found.normal = settings.normals ? found.normal & hit & ~found.depth : 0;
    return found;
}

/// The edges between the first `count` points of two rows, sixteen an entry.
void compare(const SampleGrid& grid, std::size_t a, std::size_t b, int count,
             const DetectSettings& settings, Suspects* found) {
    for (int i = 0; i < count; i += kLanes) {
        const auto first = static_cast<std::size_t>(i);
        const std::uint32_t wanted = (1U << std::min(count - i, kLanes)) - 1;
        *found++ =
            compare_some(GridRow(grid, a + first), GridRow(grid, b + first), wanted, settings);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(compare);

namespace {

void collect(std::span<const Suspects> row, int j, bool down, std::vector<SuspectEdge>& edges) {
    int i = 0;
    for (const auto [id, depth, normal] : row) {
        for (std::uint32_t rest = id | depth | normal; rest != 0; rest &= rest - 1) {
            const std::uint32_t bit = rest & (0U - rest);
            const Suspicion suspicion = (id & bit) != 0      ? Suspicion::id
                                        : (depth & bit) != 0 ? Suspicion::depth
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
    std::vector<Suspects> found(static_cast<std::size_t>((grid.width + kLanes - 1) / kLanes));
    const auto compare_rows = [&](std::size_t a, std::size_t b, int count, int j, bool down) {
        HWY_DYNAMIC_DISPATCH(compare)(grid, a, b, count, settings, found.data());
        const auto used = static_cast<std::size_t>((count + kLanes - 1) / kLanes);
        collect(std::span(found).first(used), j, down, edges);
    };
    for (int j = 0; j < grid.height; ++j) {
        const std::size_t row = grid.index(0, j);
        compare_rows(row, row + 1, grid.width - 1, j, false);
        if (j + 1 == grid.height) break;
        compare_rows(row, grid.index(0, j + 1), grid.width, j, true);
    }
}

}  // namespace ink

#endif

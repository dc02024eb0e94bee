#include "lines/detect.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/lanes.h"
#include "base/multiversion.h"

namespace ink {

namespace {

/// One row of the grid as pointers, for loops that vectorise.
struct Row {
    const GeometryId* id;
    const float *px, *py, *pz, *nx, *ny, *nz;

    Row(const SampleGrid& grid, std::size_t first)
        : id(grid.id.data() + first),
          px(grid.px.data() + first),
          py(grid.py.data() + first),
          pz(grid.pz.data() + first),
          nx(grid.nx.data() + first),
          ny(grid.ny.data() + first),
          nz(grid.nz.data() + first) {}
};

static_assert(kBackground == 0);

/// Whether a packet's length of points is background in both rows.
INKTRACE_INLINE bool is_empty(const GeometryId* a, const GeometryId* b) {
    GeometryId any = 0;
    for (int i = 0; i < kLanes; ++i) any |= a[i] | b[i];
    return any == kBackground;
}

/// Suspicions between `a` and `b`, point by point. Background at either end of the rows is left
/// out.
INKTRACE_MULTIVERSION
void compare_rows(const Row& a, const Row& b, int count, const DetectSettings& settings,
                  std::uint8_t* __restrict codes) {
    int begin = 0;
    int end = count;
    while (begin + kLanes <= end && is_empty(a.id + begin, b.id + begin)) begin += kLanes;
    while (end - kLanes >= begin && is_empty(a.id + end - kLanes, b.id + end - kLanes)) {
        end -= kLanes;
    }
    std::memset(codes, 0, static_cast<std::size_t>(count));
    const auto [aid, apx, apy, apz, anx, any, anz] = a;
    const auto [bid, bpx, bpy, bpz, bnx, bny, bnz] = b;
    const float sine_squared = settings.chord_sine * settings.chord_sine;
    const float cosine = settings.crease_cosine;
    const float least_squared = settings.least_jump * settings.least_jump;
    const auto depth_code = settings.depths ? static_cast<std::uint32_t>(Suspicion::depth) : 0U;
    const auto normal_code = settings.normals ? static_cast<std::uint32_t>(Suspicion::normal) : 0U;
    for (int i = begin; i < end; ++i) {
        const float cx = bpx[i] - apx[i];
        const float cy = bpy[i] - apy[i];
        const float cz = bpz[i] - apz[i];
        const float mx = bnx[i] + anx[i];
        const float my = bny[i] + any[i];
        const float mz = bnz[i] + anz[i];
        const float along = cx * mx + cy * my + cz * mz;
        const float chord_squared = cx * cx + cy * cy + cz * cz;
        const float normal_squared = mx * mx + my * my + mz * mz;
        const float bound = std::max(sine_squared * chord_squared, least_squared) * normal_squared;
        const float turn = anx[i] * bnx[i] + any[i] * bny[i] + anz[i] * bnz[i];
        const std::uint32_t bent = turn < cosine ? normal_code : 0U;
        const std::uint32_t broken = along * along > bound ? depth_code : bent;
        const std::uint32_t same = aid[i] != kBackground ? broken : 0U;
        codes[i] = static_cast<std::uint8_t>(aid[i] != bid[i] ? 1U : same);
    }
}

static_assert(static_cast<int>(Suspicion::id) == 1);

/// The same where the ID is all that counts.
INKTRACE_MULTIVERSION
void compare_ids(const GeometryId* __restrict a, const GeometryId* __restrict b, int count,
                 std::uint8_t* __restrict codes) {
    for (int i = 0; i < count; ++i) codes[i] = a[i] != b[i] ? 1 : 0;
}

/// `codes` has zeros behind its `count` entries, up to a multiple of eight.
void collect(const std::uint8_t* codes, int count, int j, bool down,
             std::vector<SuspectEdge>& edges) {
    for (int i = 0; i < count; i += 8) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, codes + i, 8);
        for (; eight != 0;) {
            const int byte = std::countr_zero(eight) / 8;
            const auto code = static_cast<std::uint8_t>(eight >> (8 * byte));
            edges.push_back({static_cast<std::uint16_t>(i + byte), static_cast<std::uint16_t>(j),
                             down, static_cast<Suspicion>(code)});
            eight &= ~(std::uint64_t{0xFF} << (8 * byte));
        }
    }
}

}  // namespace

void detect(const SampleGrid& grid, const DetectSettings& settings,
            std::vector<SuspectEdge>& edges) {
    edges.clear();
    const bool ids_only = !settings.depths && !settings.normals;
    const auto compare = [&](const Row& a, const Row& b, int count, std::uint8_t* codes) {
        if (ids_only) return compare_ids(a.id, b.id, count, codes);
        compare_rows(a, b, count, settings, codes);
    };
    std::vector<std::uint8_t> codes(static_cast<std::size_t>(grid.width) + kLanes);
    for (int j = 0; j < grid.height; ++j) {
        const Row row(grid, grid.index(0, j));
        const Row right(grid, grid.index(1, j));
        compare(row, right, grid.width - 1, codes.data());
        codes[static_cast<std::size_t>(grid.width) - 1] = 0;
        collect(codes.data(), grid.width - 1, j, false, edges);
        if (j + 1 == grid.height) break;
        const Row below(grid, grid.index(0, j + 1));
        compare(row, below, grid.width, codes.data());
        collect(codes.data(), grid.width, j, true, edges);
    }
}

}  // namespace ink

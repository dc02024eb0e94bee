// Which edges of a lattice are suspected of a line.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "instruction_sets.h"
#include "lines/detect.h"
#include "lines/detect_blocks.h"

namespace ink::test {
namespace {

/// What lies between two points of a grid, by the definition.
Suspicion between(const SampleGrid& grid, std::size_t a, std::size_t b,
                  const DetectSettings& settings) {
    if (grid.id[a] != grid.id[b]) return Suspicion::id;
    if (grid.id[a] == kBackground) return Suspicion::none;
    if (!grid.surface.empty() && grid.surface[a] == grid.surface[b] &&
        grid.surface[a] < SampleGrid::kUnknownSurface) {
        return Suspicion::none;
    }
    const Sample p = grid.sample(a);
    const Sample q = grid.sample(b);
    const Vec3d chord = to_double(q.position) - to_double(p.position);
    const Vec3d mean = normalize(to_double(p.normal) + to_double(q.normal));
    const double least = std::max<double>(settings.chord_sine * length(chord), settings.least_jump);
    if (std::abs(dot(chord, mean)) > least) return Suspicion::depth;
    const double cosine = dot(to_double(p.normal), to_double(q.normal));
    return cosine < settings.crease_cosine ? Suspicion::normal : Suspicion::none;
}

/// Steps, slopes and gaps at random; surfaces two points wide, every third of them unknown.
SampleGrid random_grid(int width, int height, bool with_surfaces) {
    std::mt19937 random(static_cast<unsigned>(7 * width + height));
    std::uniform_real_distribution<float> slope(-0.2F, 0.2F);
    SampleGrid grid;
    grid.resize(width, height);
    if (with_surfaces) grid.surface.resize(grid.id.size());
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            const std::size_t k = grid.index(i, j);
            grid.id[k] = static_cast<GeometryId>(random() % 5 == 0 ? random() % 3 : 1);
            grid.px[k] = static_cast<float>(i);
            grid.py[k] = static_cast<float>(j);
            grid.pz[k] = random() % 4 == 0 ? 5.0F * slope(random) : 0.0F;
            const Vec3f normal = normalize(Vec3f{slope(random), slope(random), 1.0F});
            grid.nx[k] = normal.x;
            grid.ny[k] = normal.y;
            grid.nz[k] = normal.z;
            if (!with_surfaces) continue;
            const auto number = static_cast<std::uint32_t>(i / 2 + 100 * (j / 2));
            grid.surface[k] = number + (number % 3 == 0 ? SampleGrid::kUnknownSurface : 0);
        }
    }
    return grid;
}

using FoundEdge = std::tuple<int, int, bool, Suspicion>;

std::set<FoundEdge> suspects_by_definition(const SampleGrid& grid, const DetectSettings& settings) {
    std::set<FoundEdge> edges;
    for (int j = 0; j < grid.height; ++j) {
        for (int i = 0; i < grid.width; ++i) {
            for (const bool down : {false, true}) {
                if (down ? j + 1 == grid.height : i + 1 == grid.width) continue;
                const std::size_t other = grid.index(i + (down ? 0 : 1), j + (down ? 1 : 0));
                const Suspicion kind = between(grid, grid.index(i, j), other, settings);
                if (kind != Suspicion::none) edges.insert({i, j, down, kind});
            }
        }
    }
    return edges;
}

std::set<FoundEdge> set_of(const std::vector<SuspectEdge>& found) {
    std::set<FoundEdge> edges;
    for (const SuspectEdge& e : found) edges.insert({e.i, e.j, e.down, e.suspicion});
    EXPECT_EQ(edges.size(), found.size());
    return edges;
}

constexpr std::array kGridSizes{std::pair{1, 1},   std::pair{2, 3},  std::pair{7, 5},
                                std::pair{16, 16}, std::pair{17, 2}, std::pair{65, 65},
                                std::pair{130, 9}};

TEST(Detection, SuspectsWhatItsDefinitionSaysInGridsOfAnySize) {
    DetectSettings settings;
    settings.least_jump = 0.05F;
    for (const bool with_surfaces : {false, true}) {
        for (const auto& [width, height] : kGridSizes) {
            const SampleGrid grid = random_grid(width, height, with_surfaces);
            std::vector<SuspectEdge> found;
            detect(grid, settings, found);
            EXPECT_EQ(set_of(found), suspects_by_definition(grid, settings))
                << width << " x " << height;
        }
    }
}

/// A grid cut into blocks. Those where all is background have no packet, and what lies beyond the
/// grid looks like a hit.
struct CutGrid {
    SampleBlocks blocks;
    std::vector<std::uint32_t> packet_at;
    std::vector<Lanes<GeometryId>> ids;
    std::vector<Lanes<std::uint32_t>> surfaces;
    std::vector<Vec3Lanes> places, normals;

    explicit CutGrid(const SampleGrid& grid) {
        const int across = (grid.width + kBlockSide - 1) / kBlockSide;
        const int down = (grid.height + kBlockSide - 1) / kBlockSide;
        for (int k = 0; k < across * down; ++k) {
            put_block(grid, k % across * kBlockSide, k / across * kBlockSide);
        }
        blocks = {grid.width, grid.height,     across,        down,          packet_at,
                  ids.data(), surfaces.data(), places.data(), normals.data()};
    }

    void put_block(const SampleGrid& grid, int x, int y) {
        Lanes<GeometryId> id = Lanes<GeometryId>::filled(9);
        Lanes<std::uint32_t> surface{};
        Vec3Lanes place{};
        Vec3Lanes normal{};
        bool any = false;
        for (int lane = 0; lane < kLanes; ++lane) {
            const int i = x + lane % kBlockSide;
            const int j = y + lane / kBlockSide;
            if (i >= grid.width || j >= grid.height) continue;
            const std::size_t k = grid.index(i, j);
            id[lane] = grid.id[k];
            any |= grid.id[k] != kBackground;
            surface[lane] = grid.surface[k];
            place.x[lane] = grid.px[k];
            place.y[lane] = grid.py[k];
            place.z[lane] = grid.pz[k];
            normal.x[lane] = grid.nx[k];
            normal.y[lane] = grid.ny[k];
            normal.z[lane] = grid.nz[k];
        }
        packet_at.push_back(any ? static_cast<std::uint32_t>(ids.size()) : SampleBlocks::kNothing);
        if (!any) return;
        ids.push_back(id);
        surfaces.push_back(surface);
        places.push_back(place);
        normals.push_back(normal);
    }
};

TEST(Detection, IsTheSameBlockByBlockOnEveryInstructionSet) {
    DetectSettings settings;
    settings.least_jump = 0.05F;
    on_every_instruction_set([&] {
        for (const auto& [width, height] : kGridSizes) {
            SampleGrid grid = random_grid(width, height, true);
            // A hole of a few blocks.
            for (int k = 0; k < width * height; ++k) {
                const int i = k % width;
                const int j = k / width;
                if (i >= 8 && i < 24 && j < 12) grid.id[grid.index(i, j)] = kBackground;
            }
            std::vector<SuspectEdge> found;
            detect(CutGrid(grid).blocks, settings, found);
            EXPECT_EQ(set_of(found), suspects_by_definition(grid, settings))
                << width << " x " << height;
        }
    });
}

}  // namespace
}  // namespace ink::test

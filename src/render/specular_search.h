#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "lines/connect.h"
#include "lines/detect.h"
#include "lines/locate.h"
#include "lines/segment.h"
#include "render/edges_plan.h"
#include "render/path_table.h"
#include "render/specular_paths.h"
#include "sampling/sampler.h"
#include "sampling/samples.h"

namespace ink {

/// What the first hits of a tile's lattice are, block by block: spans of equal length.
struct LatticeHits {
    std::span<const Block> blocks;
    std::span<const RayPacket> rays;
    std::span<const PointPacket> points;
    std::span<const HitPacket> hits;
    std::span<const NormalPacket> normals;  ///< shading normals, where anything was hit
};

/// Finds the lines that a tile shows in mirrors, through glass and on and behind transparent
/// surfaces. Level k of a lattice point is the hit number k on its specular path; two neighbours
/// are compared at a level if their paths to it agree. Each level is searched as the first hits
/// are, in the plane of the picture.
class SpecularSearch {
  public:
    explicit SpecularSearch(const EdgesPlan& edges);

    /// Follows the paths of a tile's lattice, of the extent of `lattice`, and mixes what they see
    /// into the colours of its blocks.
    void follow(const SampleGrid& lattice, const LatticeHits& hits, std::span<ColorPacket> colors);

    /// Adds the lines of levels 1 and on. Level 0 crosses those of `suspects` at `direct`.
    void search(std::span<const SuspectEdge> suspects, std::span<const Crossing> direct,
                std::vector<Segment>& segments);

    std::size_t rays() const { return sampler_.rays() + paths_.rays(); }
    std::size_t crossings() const { return crossing_count_; }

  private:
    struct LegLane {
        const PathLeg* leg;
        int lane;
    };

    void fill_grid(int level);
    const PathLeg* leg_of(std::size_t block, int level) const;
    LegLane leg_at(std::size_t point, int level) const;
    Sample sample_of(const PathLeg& leg, const NormalPacket& normals, int lane);
    void complete(const PathLeg& leg, int lane, Sample& sample) const;
    bool is_smooth(const SuspectEdge& edge, int level) const;
    void sample(int level, std::span<const Vec2f> points, std::span<Sample> out);
    void take(int level, std::vector<Segment>& segments);
    bool belongs(const Segment& segment) const;
    void find_repeated();
    void remember(std::span<const SuspectEdge> suspects, std::span<const Crossing> crossings);

    const EdgesPlan& edges_;
    Sampler sampler_;
    SpecularPaths paths_;
    PathTable table_;
    Locator locator_;
    Connector connector_;
    SampleGrid grid_;
    std::vector<Block> blocks_;
    int blocks_across_ = 0;
    std::vector<std::uint32_t> block_at_;   ///< of all blocks of the grid, row by row
    std::vector<std::uint32_t> first_leg_;  ///< of each block, and one more
    std::vector<PathLeg> legs_, point_legs_;
    std::vector<HitPacket> point_hits_;
    std::vector<SuspectEdge> suspects_;
    std::vector<Crossing> crossings_;
    std::vector<Segment> found_;
    /// Where lines of lower levels cross the edges of the lattice, by their ends and direction.
    std::unordered_multimap<std::uint32_t, Vec2f> crossed_;
    std::unordered_set<std::uint64_t> repeated_;  ///< crossings of this level that are among those
    std::size_t crossing_count_ = 0;
};

}  // namespace ink

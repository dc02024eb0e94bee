#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/mesh_crossing.h"
#include "sampling/mesh_walk.h"

namespace ink {

/// Finds what lies between neighbouring points of the screen by walks over the meshes that they
/// see. So lines lie where edges of the mesh are, exactly, and no ray is traced. Each thread needs
/// one of its own.
class MeshCrosser {
  public:
    /// `meshes` must stay.
    explicit MeshCrosser(const MeshWalk& meshes) : meshes_(meshes) {}

    /// See MeshCrossingFunction. Of the object of each key `MeshWalk::knows` must hold, or it must
    /// be that of a miss.
    void cross(std::span<const SeenPair> pairs, std::span<MeshCrossing> crossings,
               std::vector<SurfaceKey>& expected);

  private:
    class Crosser;
    /// What an end of a pair sees must go on to a point past that end.
    struct Past {
        std::uint32_t pair;
        SurfaceKey end;
        double slack;  ///< of the place of that point along the way there
    };
    static constexpr std::uint32_t kNoWay = 0xFFFFFFFFU;

    void walk_from_ends(std::span<const SeenPair> pairs);
    void look_past(std::span<MeshCrossing> crossings, std::vector<SurfaceKey>& expected);

    const MeshWalk& meshes_;
    std::vector<WayLine> lines_, past_lines_;
    std::vector<Walk> walks_;
    std::vector<MeshWay> ways_;
    WalkMemory memory_;
    std::vector<std::uint32_t> first_ways_, second_ways_;  ///< of each pair, or kNoWay
    std::vector<Past> pasts_;
};

}  // namespace ink

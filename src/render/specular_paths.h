#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "accel/tracer.h"
#include "render/path_table.h"
#include "render/pipeline.h"
#include "sampling/optics.h"
#include "shading/shading.h"

namespace ink {

/// One leg of sixteen specular paths: from where a ray left one surface to what it meets next.
struct PathLeg {
    RayPacket rays;               ///< inactive where the path had ended
    HitPacket hits;               ///< normals of unit length, facing the ray's origin
    NormalPacket normals;         ///< shading normals, likewise
    Lanes<float> before;          ///< length of the path so far, from where camera rays start
    Lanes<PathTable::Path> path;  ///< so far
};

/// Follows camera rays over mirrors and through glass and transparent surfaces. Each thread needs
/// one of its own.
class SpecularPaths {
  public:
    explicit SpecularPaths(const Pipeline& pipeline);

    bool goes_on(const HitPacket& hits) const;

    /// Appends the legs of up to `depth` more hits to `legs`.
    void follow(const RayPacket& rays, const HitPacket& hits, const NormalPacket& normals,
                int depth, PathTable& table, std::vector<PathLeg>& legs);
    /// The same to the depth that is set; and mixes what is seen along the way into the colours of
    /// the hits; `points` are those of the screen through which the rays run.
    void follow(const RayPacket& rays, const PointPacket& points, const HitPacket& hits,
                const NormalPacket& normals, PathTable& table, std::vector<PathLeg>& legs,
                ColorPacket& colors);

    std::size_t rays() const { return rays_; }  ///< traced so far

  private:
    /// Where sixteen rays are on their ways.
    struct Stage {
        PathLeg leg;
        std::array<Media, kLanes> media{};
        /// Rays that went straight all the way see the background as the camera does; to others it
        /// is opaque.
        std::array<bool, kLanes> bent{};
    };
    struct Record {
        PathTable& table;
        std::vector<PathLeg>& legs;
    };
    struct Shares;

    static Stage first_stage(const RayPacket& rays, const HitPacket& hits,
                             const NormalPacket& normals);
    void advance(const Stage& from, int depth, Record* record, ColorPacket* colors, bool sides);
    bool scatter(const Stage& from, Stage& main, Stage& side, Shares& shares, Record* record);
    void arrive(Stage& stage);
    void shade(const Stage& stage, ColorPacket& colors) const;
    void see(Stage& stage, int depth, Record* record, ColorPacket* colors, bool sides);

    const Pipeline& pipeline_;
    std::array<float, 4> opaque_background_;
    PointPacket points_{};  ///< of the rays at hand
    std::size_t rays_ = 0;
};

}  // namespace ink

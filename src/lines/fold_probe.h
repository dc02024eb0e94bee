#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lines/folds.h"

namespace ink {

/// What rays tell about self-occlusions and the surface around them. Calls with different workers
/// may run at one time.
class FoldProbe {
  public:
    /// `lines`: all of the picture's.
    FoldProbe(std::span<const Segment> lines, const Viewpoint& viewpoint, float spacing,
              std::span<const FoldWorker> workers, const FoldSettings& settings)
        : lines_(lines),
          viewpoint_(viewpoint),
          spacing_(spacing),
          workers_(workers),
          settings_(settings),
          scratch_(workers.size()) {}

    /// Says that the worker's next samples lie no farther than `reach` from a point, or seldom.
    void enter(Vec2f point, float reach, std::size_t worker) const;

    /// Where the valley of the angle between surface and ray runs beside a point that a way along
    /// it comes to; nothing where there is none, or another geometry than `owner` is seen.
    std::optional<Vec2f> find_valley(Vec2f point, Vec2f way, GeometryId owner,
                                     std::size_t worker) const;

    /// Whether the surface is steep enough to be leapt over at all of these points.
    bool is_steep(std::span<const Vec2f> path, GeometryId owner, std::size_t worker) const;

    /// How far the two sides of each fold are from lying on one surface, in pixels; less than zero
    /// where they are of two geometries. Sorts the folds, by their indices, by place.
    std::vector<float> depths_of(std::vector<std::uint32_t>& folds, const FoldLoop& loop) const;

  private:
    /// What a worker needs while it looks at one place of the picture.
    struct alignas(64) Scratch {
        std::vector<Vec2f> points;
        std::vector<Sample> samples;
    };

    std::span<const Sample> look(std::span<const Vec2f> points, std::size_t worker) const;
    std::optional<std::size_t> lowest_of(std::span<const Sample> samples, bool wide,
                                         GeometryId owner) const;
    void measure_depths(std::span<const std::uint32_t> folds, std::size_t worker,
                        std::span<float> depths) const;
    Vec2f middle_of(std::uint32_t fold) const { return (lines_[fold].a + lines_[fold].b) * 0.5F; }
    float facing(const Sample& sample) const;
    float length_between(Vec2f p, Vec2f q, const Sample& sample) const;

    std::span<const Segment> lines_;
    const Viewpoint& viewpoint_;
    float spacing_;
    std::span<const FoldWorker> workers_;
    const FoldSettings& settings_;
    mutable std::vector<Scratch> scratch_;  ///< of each worker
};

}  // namespace ink

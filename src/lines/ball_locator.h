#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lines/detect.h"
#include "lines/edge_balls.h"
#include "lines/locate.h"
#include "lines/predict_lanes.h"
#include "sampling/samples.h"
#include "sampling/surface_key.h"

namespace ink {

/// What one ray saw of a ball, or the background.
struct BallHit {
    GeometryId id = kBackground;
    SurfaceKey surface;
    float t = 0.0F;  ///< as in Sample
    Ball ball{};     ///< of radius 0: the background
};

/// Locates what Locator would between balls, sixteen edges at a time and without samples of its
/// own: a crossing is computed, and one ray beside it asked what it hits. What that does not settle
/// is left to Locator.
class BallLocator {
  public:
    BallLocator(const Viewpoint& viewpoint, const LocateSettings& settings)
        : viewpoint_(viewpoint), settings_(settings) {}

    void begin() { count_ = 0; }
    /// Takes suspect edge number `edge`, from screen point a to b, both of whose ends see balls or
    /// the background, and not the same.
    void add(std::uint32_t edge, Vec2f a, Vec2f b, const BallHit& first, const BallHit& second) {
        const auto lane = static_cast<int>(count_ % kLanes);
        if (count_ / kLanes == batches_.size()) batches_.emplace_back();
        Batch& batch = batches_[count_ / kLanes];
        ++count_;
        batch.edge[lane] = edge;
        batch.lanes.ax[lane] = a.x;
        batch.lanes.ay[lane] = a.y;
        batch.lanes.bx[lane] = b.x;
        batch.lanes.by[lane] = b.y;
        put(first, lane, batch.lanes.first, batch.first);
        put(second, lane, batch.lanes.second, batch.second);
    }
    /// Takes all suspect edges of a grid whose points see balls of the table or the background.
    void add(const SampleGrid& grid, std::span<const SuspectEdge> edges, const BallTable& table);
    /// Adds crossings, and to `left` the edges that are left, in the order in which they came.
    void locate(const IdentifyFunction& identify, std::vector<Crossing>& crossings,
                std::vector<std::uint32_t>& left);

  private:
    struct Batch {
        EdgeLanes lanes;
        EdgeEnds first, second;
        Lanes<std::uint32_t> edge;
        PredictionLanes predictions;
    };

    static void put(const BallHit& hit, int lane, BallLanes& balls, EdgeEnds& ends) {
        balls.x[lane] = hit.ball.centre.x;
        balls.y[lane] = hit.ball.centre.y;
        balls.z[lane] = hit.ball.centre.z;
        balls.radius[lane] = hit.ball.radius;
        balls.t[lane] = hit.t;
        ends.id[lane] = hit.id;
        ends.object[lane] = hit.surface.object;
        ends.primitive[lane] = hit.surface.primitive;
    }
    void search(Batch& batch, int lane) const;
    void list_checks(std::size_t number, int used);
    std::size_t confirm(std::size_t number, std::size_t checked);
    void take_crossings(const Batch& batch, int used, std::vector<Crossing>& crossings,
                        std::vector<std::uint32_t>& left) const;

    Viewpoint viewpoint_;
    LocateSettings settings_;
    std::vector<Batch> batches_;  ///< they are kept for the next edges
    std::size_t count_ = 0;
    std::vector<std::uint32_t> checked_;
    std::vector<Vec2f> points_;
    std::vector<SurfaceKey> seen_;
};

}  // namespace ink

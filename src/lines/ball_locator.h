#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lines/detect.h"
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

/// A suspect edge both of whose ends see balls or the background, and not the same.
struct BallEdge {
    std::uint32_t edge;  ///< index of the suspect edge
    BallHit first, second;
};

/// Locates what Locator would between balls, sixteen edges at a time and without samples of its
/// own: a crossing is computed, and one ray beside it asked what it hits. What that does not settle
/// is left to Locator.
class BallLocator {
  public:
    BallLocator(const Viewpoint& viewpoint, const LocateSettings& settings)
        : viewpoint_(viewpoint), settings_(settings) {}

    /// Adds crossings, and to `left` the suspect edges that are left.
    void locate(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                std::span<const BallEdge> edges, const IdentifyFunction& identify,
                std::vector<Crossing>& crossings, std::vector<std::uint32_t>& left);

  private:
    void predict(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                 std::span<const BallEdge> edges);
    void search(const BallEdge& edge, std::size_t k);
    void check(std::span<const BallEdge> edges, const IdentifyFunction& identify);
    Prediction prediction(std::size_t k) const {
        const PredictionLanes& lanes = predictions_[k / kLanes];
        const auto lane = static_cast<int>(k % kLanes);
        return {static_cast<Prediction::Kind>(lanes.kind[lane]), lanes.at[lane], lanes.t[lane],
                lanes.squared_radius[lane]};
    }

    Viewpoint viewpoint_;
    LocateSettings settings_;
    EdgeLanes lanes_;
    std::vector<PredictionLanes> predictions_;
    std::vector<Vec2f> from_, to_;  ///< ends of the edges, pixels
    std::vector<std::uint32_t> checked_;
    std::vector<Vec2f> points_;
    std::vector<SurfaceKey> seen_;
};

}  // namespace ink

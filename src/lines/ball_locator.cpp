#include "lines/ball_locator.h"

#include <algorithm>
#include <optional>

namespace ink {

namespace {

constexpr auto kFirstLimb = static_cast<std::int32_t>(Prediction::Kind::first_limb);
constexpr auto kSecondLimb = static_cast<std::int32_t>(Prediction::Kind::second_limb);
constexpr auto kGap = static_cast<std::int32_t>(Prediction::Kind::gap);

void put(const BallHit& hit, BallLanes& lanes, int lane) {
    lanes.x[lane] = hit.ball.centre.x;
    lanes.y[lane] = hit.ball.centre.y;
    lanes.z[lane] = hit.ball.centre.z;
    lanes.radius[lane] = hit.ball.radius;
    lanes.t[lane] = hit.t;
}

Sample sample_of(const BallHit& hit) {
    Sample sample;
    sample.id = hit.id;
    sample.t = hit.t;
    sample.ball = hit.ball;
    return sample;
}

}  // namespace

void BallLocator::locate(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                         std::span<const BallEdge> edges, const IdentifyFunction& identify,
                         std::vector<Crossing>& crossings, std::vector<std::uint32_t>& left) {
    if (edges.empty()) return;
    predict(grid, suspects, edges);
    check(edges, identify);
    Crossing crossing;
    for (std::size_t k = 0; k < edges.size(); ++k) {
        const auto lane = static_cast<int>(k % kLanes);
        if (predictions_[k / kLanes].kind[lane] < 0) {
            left.push_back(edges[k].edge);
            continue;
        }
        crossing.edge = edges[k].edge;
        const PredictedSide first{edges[k].first.id, edges[k].first.t, edges[k].first.ball};
        const PredictedSide second{edges[k].second.id, edges[k].second.t, edges[k].second.ball};
        if (cross_as_predicted(viewpoint_, settings_, prediction(k), from_[k], to_[k], first,
                               second, crossing)) {
            crossings.push_back(crossing);
        }
    }
}

void BallLocator::predict(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                          std::span<const BallEdge> edges) {
    predictions_.resize((edges.size() + kLanes - 1) / kLanes);
    from_.resize(edges.size());
    to_.resize(edges.size());
    for (std::size_t first = 0; first < edges.size(); first += kLanes) {
        const std::size_t count = std::min<std::size_t>(kLanes, edges.size() - first);
        for (std::size_t i = 0; i < kLanes; ++i) {
            // Unused lanes repeat the last edge.
            const std::size_t k = first + std::min(i, count - 1);
            const SuspectEdge& suspect = suspects[edges[k].edge];
            const auto lane = static_cast<int>(i);
            from_[k] = grid.point(suspect.i, suspect.j);
            to_[k] = suspect.down ? grid.point(suspect.i, suspect.j + 1)
                                  : grid.point(suspect.i + 1, suspect.j);
            lanes_.ax[lane] = from_[k].x;
            lanes_.ay[lane] = from_[k].y;
            lanes_.bx[lane] = to_[k].x;
            lanes_.by[lane] = to_[k].y;
            put(edges[k].first, lanes_.first, lane);
            put(edges[k].second, lanes_.second, lane);
        }
        predict_crossings(viewpoint_, lanes_, predictions_[first / kLanes]);
    }
    for (std::size_t k = 0; k < edges.size(); ++k) {
        const std::int32_t kind = predictions_[k / kLanes].kind[static_cast<int>(k % kLanes)];
        if (kind == PredictionLanes::kSearch) search(edges[k], k);
    }
}

void BallLocator::search(const BallEdge& edge, std::size_t k) {
    const std::optional<Prediction> found = predict_crossing(
        viewpoint_, from_[k], sample_of(edge.first), to_[k], sample_of(edge.second));
    PredictionLanes& lanes = predictions_[k / kLanes];
    const auto lane = static_cast<int>(k % kLanes);
    lanes.kind[lane] = found ? static_cast<std::int32_t>(found->kind) : PredictionLanes::kNone;
    if (!found) return;
    lanes.at[lane] = found->at;
    lanes.t[lane] = found->t;
    lanes.squared_radius[lane] = found->squared_radius;
}

/// Predictions that a ray beside them does not confirm become none.
void BallLocator::check(std::span<const BallEdge> edges, const IdentifyFunction& identify) {
    checked_.clear();
    points_.clear();
    for (std::size_t k = 0; k < edges.size(); ++k) {
        PredictionLanes& lanes = predictions_[k / kLanes];
        std::int32_t& kind = lanes.kind[static_cast<int>(k % kLanes)];
        if (kind < 0 || !needs_check(settings_, prediction(k))) continue;
        if (kind == kGap) {
            kind = PredictionLanes::kNone;  // two crossings, which Locator finds
            continue;
        }
        checked_.push_back(static_cast<std::uint32_t>(k));
        points_.push_back(from_[k] + (to_[k] - from_[k]) * checked_place(settings_, prediction(k)));
    }
    seen_.resize(points_.size());
    identify(points_, seen_);
    for (std::size_t n = 0; n < checked_.size(); ++n) {
        const std::size_t k = checked_[n];
        std::int32_t& kind = predictions_[k / kLanes].kind[static_cast<int>(k % kLanes)];
        const bool as_first = seen_[n] == edges[k].first.surface;
        const bool as_second = seen_[n] == edges[k].second.surface;
        const bool confirmed = kind == kFirstLimb    ? as_second
                               : kind == kSecondLimb ? as_first
                                                     : as_first || as_second;
        if (!confirmed) kind = PredictionLanes::kNone;
    }
}

}  // namespace ink

#include "lines/ball_locator.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "base/multiversion.h"

namespace ink {

namespace {

constexpr auto kFirstContour = static_cast<std::int32_t>(Prediction::Kind::first_contour);
constexpr auto kSecondContour = static_cast<std::int32_t>(Prediction::Kind::second_contour);
constexpr auto kSeam = static_cast<std::int32_t>(Prediction::Kind::seam);
constexpr auto kGap = static_cast<std::int32_t>(Prediction::Kind::gap);

Ball ball_of(const BallLanes& balls, int lane) {
    return {{balls.x[lane], balls.y[lane], balls.z[lane]}, balls.radius[lane]};
}

Sample sample_of(GeometryId id, const BallLanes& balls, int lane) {
    Sample sample;
    sample.id = id;
    sample.t = balls.t[lane];
    sample.ball = ball_of(balls, lane);
    return sample;
}

/// The places at which rays are to confirm predictions.
struct CheckLanes {
    Lanes<float> x, y;
    Lanes<std::int32_t> wanted;  ///< 1, or 0 where none is
};

/// needs_check and checked_place, for sixteen edges at once.
INKTRACE_MULTIVERSION
void find_checks(float offset, float least_squared, const EdgeLanes& edges,
                 const PredictionLanes& predictions, CheckLanes& checks) {
    for (int i = 0; i < kLanes; ++i) {
        const std::int32_t kind = predictions.kind[i];
        const float at = predictions.at[i];
        const float before = at - offset;
        const float after = at + offset;
        const bool known =
            (kind == kFirstContour && after >= 1.0F) || (kind == kSecondContour && at <= offset);
        const bool large = predictions.squared_radius[i] >= least_squared;
        checks.wanted[i] = kind >= 0 && !known && large ? 1 : 0;
        const float place = kind == kFirstContour ? after : kind == kSecondContour ? before : at;
        checks.x[i] = edges.ax[i] + (edges.bx[i] - edges.ax[i]) * place;
        checks.y[i] = edges.ay[i] + (edges.by[i] - edges.ay[i]) * place;
    }
}

/// What cross_as_predicted gives of sixteen edges, but for seams within one geometry.
struct CrossingLanes {
    Lanes<float> x, y;
    Lanes<std::int32_t> type, first_in_front;
    Lanes<GeometryId> nearer;
};

INKTRACE_MULTIVERSION
void find_crossings(const EdgeLanes& edges, const PredictionLanes& predictions,
                    const Lanes<GeometryId>& first, const Lanes<GeometryId>& second,
                    CrossingLanes& crossings) {
    constexpr auto kIntersection = static_cast<std::int32_t>(LineType::intersection);
    constexpr auto kSelfOcclusion = static_cast<std::int32_t>(LineType::self_occlusion);
    constexpr auto kSilhouette = static_cast<std::int32_t>(LineType::silhouette);
    for (int i = 0; i < kLanes; ++i) {
        const std::int32_t kind = predictions.kind[i];
        const float at = predictions.at[i];
        crossings.x[i] = edges.ax[i] + (edges.bx[i] - edges.ax[i]) * at;
        crossings.y[i] = edges.ay[i] + (edges.by[i] - edges.ay[i]) * at;
        const bool nearer = edges.first.t[i] <= edges.second.t[i];
        const bool in_front = kind == kFirstContour || (kind != kSecondContour && nearer);
        crossings.first_in_front[i] = in_front ? 1 : 0;
        crossings.nearer[i] = in_front ? first[i] : second[i];
        const std::int32_t contour = first[i] == second[i] ? kSelfOcclusion : kSilhouette;
        crossings.type[i] = kind == kSeam ? kIntersection : contour;
    }
}

}  // namespace

void BallLocator::locate(const IdentifyFunction& identify, std::vector<Crossing>& crossings,
                         std::vector<std::uint32_t>& left) {
    if (count_ == 0) return;
    checked_.clear();
    points_.clear();
    const auto used_of = [&](std::size_t number) {
        return static_cast<int>(std::min<std::size_t>(kLanes, count_ - number * kLanes));
    };
    const std::size_t batches = (count_ + kLanes - 1) / kLanes;
    for (std::size_t number = 0; number < batches; ++number) {
        Batch& batch = batches_[number];
        predict_crossings(viewpoint_, batch.lanes, batch.predictions);
        const int used = used_of(number);
        for (int lane = 0; lane < used; ++lane) {
            if (batch.predictions.kind[lane] == PredictionLanes::kSearch) search(batch, lane);
        }
        list_checks(number, used);
    }
    seen_.resize(points_.size());
    identify(points_, seen_);

    crossings.reserve(crossings.size() + count_);
    std::size_t checked = 0;
    for (std::size_t number = 0; number < batches; ++number) {
        checked = confirm(number, checked);
        take_crossings(batches_[number], used_of(number), crossings, left);
    }
}

void BallLocator::take_crossings(const Batch& batch, int used, std::vector<Crossing>& crossings,
                                 std::vector<std::uint32_t>& left) const {
    const EdgeLanes& lanes = batch.lanes;
    const PredictionLanes& found = batch.predictions;
    CrossingLanes all;
    find_crossings(lanes, found, batch.first.id, batch.second.id, all);
    Crossing crossing;
    for (int lane = 0; lane < used; ++lane) {
        crossing.edge = batch.edge[lane];
        if (found.kind[lane] < 0) {
            left.push_back(crossing.edge);
            continue;
        }
        const GeometryId first = batch.first.id[lane];
        const GeometryId second = batch.second.id[lane];
        if (first == second && found.kind[lane] == kSeam) {
            const Prediction prediction{Prediction::Kind::seam, found.at[lane], found.t[lane],
                                        found.squared_radius[lane]};
            const PredictedSide from{{lanes.ax[lane], lanes.ay[lane]},
                                     first,
                                     lanes.first.t[lane],
                                     ball_of(lanes.first, lane)};
            const PredictedSide to{{lanes.bx[lane], lanes.by[lane]},
                                   second,
                                   lanes.second.t[lane],
                                   ball_of(lanes.second, lane)};
            if (cross_as_predicted(viewpoint_, settings_, prediction, from, to, crossing)) {
                crossings.push_back(crossing);
            }
            continue;
        }
        crossing.point = {all.x[lane], all.y[lane]};
        crossing.type = static_cast<LineType>(all.type[lane]);
        crossing.strength = 1.0F;
        crossing.t = found.t[lane];
        crossing.first = first;
        crossing.second = second;
        crossing.nearer = all.nearer[lane];
        crossing.first_in_front = all.first_in_front[lane] != 0;
        crossings.push_back(crossing);
    }
}

void BallLocator::add(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                      const BallTable& table) {
    count_ = edges.size();
    if (batches_.size() * kLanes < count_) batches_.resize((count_ + kLanes - 1) / kLanes);
    for (std::size_t first = 0; first < count_; first += kLanes) {
        Batch& batch = batches_[first / kLanes];
        const std::size_t some = std::min<std::size_t>(kLanes, count_ - first);
        find_edge_balls(grid, edges.subspan(first, some), table, batch.lanes, batch.first,
                        batch.second);
        for (int lane = 0; lane < kLanes; ++lane) {
            batch.edge[lane] = static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(lane);
        }
    }
}

void BallLocator::search(Batch& batch, int lane) const {
    const EdgeLanes& lanes = batch.lanes;
    const std::optional<Prediction> found = predict_crossing(
        viewpoint_, {lanes.ax[lane], lanes.ay[lane]},
        sample_of(batch.first.id[lane], lanes.first, lane), {lanes.bx[lane], lanes.by[lane]},
        sample_of(batch.second.id[lane], lanes.second, lane));
    PredictionLanes& predictions = batch.predictions;
    predictions.kind[lane] =
        found ? static_cast<std::int32_t>(found->kind) : PredictionLanes::kNone;
    if (!found) return;
    predictions.at[lane] = found->at;
    predictions.t[lane] = found->t;
    predictions.squared_radius[lane] = found->squared_radius;
}

/// Adds the checks of a batch to those that wait for their rays.
void BallLocator::list_checks(std::size_t number, int used) {
    Batch& batch = batches_[number];
    CheckLanes checks;
    find_checks(settings_.check_offset, settings_.least_checked * settings_.least_checked,
                batch.lanes, batch.predictions, checks);
    std::uint32_t wanted = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
        wanted |= static_cast<std::uint32_t>(checks.wanted[lane]) << lane;
    }
    for (wanted &= (1U << used) - 1; wanted != 0; wanted &= wanted - 1) {
        const int lane = std::countr_zero(wanted);
        std::int32_t& kind = batch.predictions.kind[lane];
        if (kind == kGap) {
            kind = PredictionLanes::kNone;  // two crossings, which Locator finds
            continue;
        }
        checked_.push_back(static_cast<std::uint32_t>(number * kLanes) +
                           static_cast<std::uint32_t>(lane));
        points_.push_back({checks.x[lane], checks.y[lane]});
    }
}

/// Predictions of a batch that the ray beside them does not confirm become none. `checked` is where
/// the batch's checks begin; returns where they end.
std::size_t BallLocator::confirm(std::size_t number, std::size_t checked) {
    Batch& batch = batches_[number];
    for (; checked < checked_.size() && checked_[checked] / kLanes == number; ++checked) {
        const auto lane = static_cast<int>(checked_[checked] % kLanes);
        std::int32_t& kind = batch.predictions.kind[lane];
        const SurfaceKey seen = seen_[checked];
        // Of contours only one surface will do. No branch: which one cannot be guessed.
        const auto is = [&](const EdgeEnds& ends, std::int32_t unless) {
            return (ends.object[lane] ^ seen.object) | (ends.primitive[lane] ^ seen.primitive) |
                   static_cast<std::uint32_t>(kind == unless);
        };
        if (is(batch.first, kFirstContour) != 0 && is(batch.second, kSecondContour) != 0) {
            kind = PredictionLanes::kNone;
        }
    }
    return checked;
}

}  // namespace ink

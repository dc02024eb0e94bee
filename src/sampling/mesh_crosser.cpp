#include "sampling/mesh_crosser.h"

#include <algorithm>
#include <cmath>

namespace ink {

namespace {

/// As near to an edge a ray may hit the triangle beyond, in lengths of the way.
constexpr double kRayRounding = 1e-3;

/// What turns by less, as a chord on the unit sphere, is one side of a slit: about 10 degrees.
constexpr float kOneSurface = 0.17F;

/// Adds the triangles that a ray at this place of a way may hit.
void expect(std::uint32_t object, const MeshWay& way, double at, double slack,
            std::vector<SurfaceKey>& expected) {
    for (std::size_t k = 0; k + 1 < way.count(); ++k) {
        if (way.at(k) - slack <= at && at <= way.at(k + 1) + slack) {
            expected.push_back({object, way.triangle(k)});
        }
    }
}

}  // namespace

/// Finds the crossing of one pair from the walks over what its ends see.
class MeshCrosser::Crosser {
  public:
    Crosser(MeshCrosser& owner, std::uint32_t number, const SeenPair& pair,
            std::vector<SurfaceKey>& expected)
        : owner_(owner),
          number_(number),
          pair_(pair),
          projection_(owner.meshes_.projection()),
          from_(to_double(pair.from - projection_.centre)),
          step_(to_double(pair.to - pair.from)),
          first_way_(way(owner.first_ways_)),
          second_way_(way(owner.second_ways_)),
          expected_(expected) {}

    MeshCrossing run() {
        if (pair_.first == pair_.second) {
            MeshCrossing crossing;
            crossing.kind = MeshCrossing::Kind::smooth;
            return crossing;
        }
        if (first_way_ != nullptr) {
            if (first_way_->end() == WalkEnd::arrived) return along_surface(*first_way_, true);
            if (first_way_->end() == WalkEnd::unknown) return {};
            if (second_way_ == nullptr) return before_background(*first_way_, true);
        }
        if (second_way_->end() == WalkEnd::arrived) return along_surface(*second_way_, false);
        if (second_way_->end() == WalkEnd::unknown) return {};
        if (first_way_ == nullptr) return before_background(*second_way_, false);
        return between_surfaces();
    }

  private:
    const MeshWay* way(const std::vector<std::uint32_t>& ways) const {
        return ways[number_] == kNoWay ? nullptr : &owner_.ways_[ways[number_]];
    }

    MeshCrossing along_surface(const MeshWay& way, bool first) {
        const MeshWalk::Crease crease = owner_.meshes_.sharpest_crease(
            (first ? pair_.first : pair_.second).object, owner_.lines_[number_], way);
        MeshCrossing crossing;
        crossing.kind = MeshCrossing::Kind::smooth;
        if (crease.turn > 0.0F) {
            crossing.kind = MeshCrossing::Kind::crease;
            crossing.turn = crease.turn;
            place(way.from_start(crease.at), crease.nearness, crossing);
            // What an end sees in a slit does not go on to where the check goes.
            check_past(crossing.at > 0.5, crease.feet, crossing);
        }
        return crossing;
    }

    MeshCrossing before_background(const MeshWay& way, bool first) {
        if (!way.ends() || way.end_at() <= 0.0 || way.end_at() >= 1.0) return {};
        return contour(way, first, nullptr);
    }

    MeshCrossing between_surfaces() {
        const MeshWay& a = *first_way_;
        const MeshWay& b = *second_way_;
        const double low = b.ends() ? std::max(1.0 - b.end_at(), 0.0) : 0.0;
        const double high = a.ends() ? std::min(a.end_at(), 1.0) : 1.0;
        if (low > high) return {};  // something else is seen between them
        const double at_low = lead(low);
        const double at_high = lead(high);
        if (at_low >= 0.0 && at_high >= 0.0 && high < 1.0) return contour(a, true, &b);
        if (at_low <= 0.0 && at_high <= 0.0 && low > 0.0) return contour(b, false, &a);
        if (at_low > 0.0 && at_high < 0.0) return seam(low, high);
        return {};
    }

    /// By how much the first surface is nearer.
    double lead(double at) const {
        return nearness(*first_way_, at) - nearness(*second_way_, 1.0 - at);
    }
    static double nearness(const MeshWay& way, double at) {
        return way.ends() && at >= way.end_at() ? way.end_nearness() : way.nearness(at);
    }

    MeshCrossing contour(const MeshWay& way, bool first, const MeshWay* behind) {
        MeshCrossing crossing;
        crossing.kind =
            first ? MeshCrossing::Kind::first_contour : MeshCrossing::Kind::second_contour;
        crossing.at_rim = way.end() == WalkEnd::rim;
        place(way.from_start(way.end_at()), way.end_nearness(), crossing);
        if (behind != nullptr) {
            const double other = behind->nearness(1.0 - way.end_at());
            crossing.gap = static_cast<float>((depth_of(other) - depth_of(way.end_nearness())) *
                                              stretch(crossing.at));
        }
        add_check(way, first, behind, crossing);
        return crossing;
    }

    /// Where the lead changes its sign: it is linear between the steps of both ways.
    MeshCrossing seam(double low, double high) {
        const auto narrow = [&](double at) {
            if (at > low && at < high) (lead(at) > 0.0 ? low : high) = at;
        };
        const MeshWay& a = *first_way_;
        const MeshWay& b = *second_way_;
        for (std::size_t k = 1; k < a.count(); ++k) narrow(a.at(k));
        for (std::size_t k = b.count(); k-- > 1;) narrow(1.0 - b.at(k));
        const double at_low = lead(low);
        const double share = at_low / (at_low - lead(high));
        MeshCrossing crossing;
        crossing.kind = MeshCrossing::Kind::seam;
        const double at = low + share * (high - low);
        place(at, nearness(a, at), crossing);
        begin_check(at, crossing);
        expect(pair_.first.object, a, at, kRayRounding, expected_);
        expect(pair_.second.object, b, 1.0 - at, kRayRounding, expected_);
        end_check(crossing);
        return crossing;
    }

    /// Beside a contour, what is behind it should be seen.
    void add_check(const MeshWay& way, bool first, const MeshWay* behind, MeshCrossing& crossing) {
        if (check_past(first, way.last(), crossing)) {
            crossing.unless_object = (first ? pair_.first : pair_.second).object;
            return;
        }
        const double at =
            way.end_at() + (crossing.at_rim ? pair_.checks.slit : pair_.checks.offset);
        begin_check(way.from_start(at), crossing);
        if (behind == nullptr) {
            expected_.push_back({});
        } else {
            expect((first ? pair_.second : pair_.first).object, *behind, 1.0 - at, kRayRounding,
                   expected_);
        }
        end_check(crossing);
    }

    /// Where an end of the way is so near to a line along `edge` that it may look into a slit: past
    /// that end, the surface that it sees must go on, without a crease. False where it is not.
    bool check_past(bool second, const Feet& edge, MeshCrossing& crossing) {
        const Vec2d way = second ? step_ : step_ * -1.0;
        const Vec2d away = normal_of(edge, way);
        const double size = length(step_);
        const double left = second ? 1.0 - crossing.at : crossing.at;
        if (left * dot(away, way) >= pair_.checks.slit * size) return false;

        const SurfaceKey end = second ? pair_.second : pair_.first;
        const Vec2f from = second ? pair_.to : pair_.from;
        const Vec2d past = way * -left + away * (pair_.checks.slit * size);  // from that end on
        crossing.needs_check = true;
        crossing.in_slit = second ? MeshCrossing::InSlit::second : MeshCrossing::InSlit::first;
        crossing.checked = from + Vec2f{static_cast<float>(past.x), static_cast<float>(past.y)};
        if (end.object == SurfaceKey::kNothing) {
            crossing.first_expected = static_cast<std::uint32_t>(expected_.size());
            expected_.push_back({});
            end_check(crossing);
        } else {
            const double slack = kRayRounding * size / std::max(length(past), 1e-3 * size);
            owner_.pasts_.push_back({number_, end, slack});
            owner_.past_lines_.emplace_back(projection_, from, crossing.checked);
        }
        return true;
    }

    /// Of an edge on the screen, a unit vector, to the side to which `way` leads.
    Vec2d normal_of(const Feet& edge, Vec2d way) const {
        const auto place = [&](const Foot& foot) {
            const double pixel = projection_.origin_step + projection_.slope_step * foot.depth;
            return Vec2d{foot.along / pixel, foot.side / pixel / dot(step_, step_)};
        };
        const Vec2d p = place(edge[0]);
        const Vec2d q = place(edge[1]);
        const Vec2d along = step_ * (q.x - p.x) + Vec2d{-step_.y, step_.x} * (q.y - p.y);
        const double size = length(along);
        // A corner behind the eye is nowhere on the screen.
        const bool known = size > 0.0 && std::isfinite(size);
        const Vec2d normal =
            known ? Vec2d{-along.y, along.x} * (1.0 / size) : way * (1.0 / length(way));
        return dot(normal, way) < 0.0 ? normal * -1.0 : normal;
    }

    void begin_check(double at, MeshCrossing& crossing) const {
        crossing.needs_check = true;
        crossing.checked_at = static_cast<float>(at);
        crossing.checked = pair_.from + (pair_.to - pair_.from) * crossing.checked_at;
        crossing.first_expected = static_cast<std::uint32_t>(expected_.size());
    }
    void end_check(MeshCrossing& crossing) const {
        crossing.expected = static_cast<std::uint32_t>(expected_.size()) - crossing.first_expected;
    }

    double depth_of(double nearness) const {
        return projection_.orthographic()
                   ? -nearness
                   : (1.0 / nearness - projection_.origin_step) / projection_.slope_step;
    }

    /// How much longer the ray through a place is than its depth.
    double stretch(double at) const {
        const double x = (from_.x + step_.x * at) * projection_.slope_step;
        const double y = (from_.y + step_.y * at) * projection_.slope_step;
        return std::sqrt(1.0 + x * x + y * y);
    }

    void place(double at, double nearness, MeshCrossing& crossing) const {
        const double depth = depth_of(nearness);
        crossing.at = std::clamp(at, 0.0, 1.0);
        crossing.t = static_cast<float>(depth * stretch(at));
        crossing.footprint =
            static_cast<float>(projection_.origin_step + projection_.slope_step * depth);
    }

    MeshCrosser& owner_;
    std::uint32_t number_;
    const SeenPair& pair_;
    const Projection& projection_;
    Vec2d from_, step_;
    const MeshWay *first_way_, *second_way_;
    std::vector<SurfaceKey>& expected_;
};

void MeshCrosser::cross(std::span<const SeenPair> pairs, std::span<MeshCrossing> crossings,
                        std::vector<SurfaceKey>& expected) {
    lines_.clear();
    for (const SeenPair& pair : pairs)
        lines_.emplace_back(meshes_.projection(), pair.from, pair.to);
    walk_from_ends(pairs);
    pasts_.clear();
    past_lines_.clear();
    for (std::uint32_t k = 0; k < pairs.size(); ++k) {
        crossings[k] = Crosser(*this, k, pairs[k], expected).run();
    }
    look_past(crossings, expected);
}

namespace {

/// A ray may hit a triangle a little beside it.
constexpr double kWayLimit = 1.0 + 1e-3;

/// What a walk from one end may lead to, if the surfaces of both may be one.
std::uint32_t target_of(SurfaceKey from, SurfaceKey to) {
    return from.object == to.object ? to.primitive : Walk::kNoTarget;
}

}  // namespace

/// From the first end of each pair, or the second where the first sees nothing: all at once, as
/// each walk waits for the mesh. Then from the second, where the first walk does not tell all.
void MeshCrosser::walk_from_ends(std::span<const SeenPair> pairs) {
    memory_.clear();
    ways_.clear();
    first_ways_.assign(pairs.size(), kNoWay);
    second_ways_.assign(pairs.size(), kNoWay);
    const auto add = [&](std::uint32_t k, bool first) {
        const SurfaceKey from = first ? pairs[k].first : pairs[k].second;
        const SurfaceKey to = first ? pairs[k].second : pairs[k].first;
        if (from.object == SurfaceKey::kNothing) return;
        (first ? first_ways_ : second_ways_)[k] =
            static_cast<std::uint32_t>(ways_.size() + walks_.size());
        walks_.push_back({k, from, target_of(from, to), kWayLimit, !first});
    };
    const auto walk = [&] {
        meshes_.walk(walks_, lines_, memory_, ways_);
        walks_.clear();
    };
    walks_.clear();
    for (std::uint32_t k = 0; k < pairs.size(); ++k) {
        if (pairs[k].first == pairs[k].second) continue;
        add(k, pairs[k].first.object != SurfaceKey::kNothing);
    }
    walk();
    for (std::uint32_t k = 0; k < pairs.size(); ++k) {
        if (first_ways_[k] == kNoWay) continue;
        const WalkEnd end = ways_[first_ways_[k]].end();
        if (end != WalkEnd::arrived && end != WalkEnd::unknown) add(k, false);
    }
    walk();
}

/// Adds what rays past the ends of some pairs may see.
void MeshCrosser::look_past(std::span<MeshCrossing> crossings, std::vector<SurfaceKey>& expected) {
    walks_.clear();
    for (std::uint32_t n = 0; n < pasts_.size(); ++n) {
        walks_.push_back({n, pasts_[n].end, Walk::kNoTarget, 1.0 + pasts_[n].slack, false});
    }
    const std::size_t before = ways_.size();
    meshes_.walk(walks_, past_lines_, memory_, ways_);
    for (std::size_t n = 0; n < pasts_.size(); ++n) {
        const auto& [pair, end, slack] = pasts_[n];
        const MeshWay& way = ways_[before + n];
        MeshCrossing& crossing = crossings[pair];
        crossing.first_expected = static_cast<std::uint32_t>(expected.size());
        if (meshes_.sharpest_crease(end.object, past_lines_[n], way).turn < kOneSurface) {
            expect(end.object, way, 1.0, slack, expected);
        }
        crossing.expected = static_cast<std::uint32_t>(expected.size()) - crossing.first_expected;
    }
}

}  // namespace ink

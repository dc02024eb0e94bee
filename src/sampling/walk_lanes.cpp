#include "sampling/walk_lanes.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampling/walk_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kWalkLanes>;
using Integers = hn::Rebind<std::int32_t, Doubles>;
using Floats = hn::Rebind<float, Doubles>;
constexpr Doubles kDoubles;
constexpr Integers kIntegers;
constexpr Floats kFloats;
constexpr std::size_t kStep = hn::MaxLanes(Doubles());
using Number = hn::Vec<Doubles>;
using Mask = hn::Mask<Doubles>;

HWY_INLINE Number set(double value) { return hn::Set(kDoubles, value); }

/// Whole numbers below 2^31, which doubles hold exactly.
HWY_INLINE auto to_integers(Number n) { return hn::DemoteTo(kIntegers, n); }
HWY_INLINE void store_whole(Number n, WalkIndices& to, std::size_t i) {
    hn::StoreU(to_integers(n), kIntegers, reinterpret_cast<std::int32_t*>(to.data()) + i);
}
HWY_INLINE Number divide_by_three(Number n) {
    return hn::Floor(hn::Mul(hn::Add(n, set(0.5)), set(1.0 / 3.0)));
}

struct Feet3 {
    Number side, along, depth;
    HWY_INLINE Mask above() const { return hn::Ge(side, hn::Zero(kDoubles)); }
};

HWY_INLINE Feet3 choose(Mask mask, const Feet3& yes, const Feet3& no) {
    return {hn::IfThenElse(mask, yes.side, no.side), hn::IfThenElse(mask, yes.along, no.along),
            hn::IfThenElse(mask, yes.depth, no.depth)};
}

/// How ways leave a triangle: by an edge, from its first corner to its second.
struct Hop {
    Number edge, twin;
    Number first, second;  ///< vertices
    Feet3 first_foot, second_foot;
    Number at, nearness;
};

HWY_INLINE Hop choose(Mask mask, const Hop& yes, const Hop& no) {
    const auto pick = [mask](Number a, Number b) { return hn::IfThenElse(mask, a, b); };
    return {pick(yes.edge, no.edge),
            pick(yes.twin, no.twin),
            pick(yes.first, no.first),
            pick(yes.second, no.second),
            choose(mask, yes.first_foot, no.first_foot),
            choose(mask, yes.second_foot, no.second_foot),
            pick(yes.at, no.at),
            pick(yes.nearness, no.nearness)};
}

/// Some walks that go side by side. Each step first asks for all that is known to be needed, and
/// only when many walks have asked, are its numbers used.
class Walks {
  public:
    HWY_INLINE void start(const Mesh& mesh, const WayView& view, const WalkStarts& starts,
                          std::size_t first_lane) {
        twins_ = reinterpret_cast<const std::int32_t*>(mesh.twins.data());
        corners_ = reinterpret_cast<const std::int32_t*>(mesh.triangles.data()->data());
        vertices_ = &mesh.vertices.data()->x;
        view_ = &view;
        starts_ = &starts;
        i_ = first_lane;
        backwards_ = hn::Gt(own(starts.backwards), hn::Zero(kDoubles));
        count_ = end_ = hn::Zero(kDoubles);
        arrived_ = hn::Lt(count_, count_);

        triangle_ = own(starts.triangle);
        edge_ = hn::Mul(triangle_, set(3.0));
        fetch(corners_, edge_);
        fetch(twins_, edge_);
    }

    /// Asks for the corners of the first triangle.
    HWY_INLINE void look_around() {
        for (std::size_t k = 0; k < 3; ++k) {
            const Number edge = hn::Add(edge_, set(static_cast<double>(k)));
            corner_[k] = corner(edge);
            twin_[k] = twin(edge);
            fetch(vertices_, hn::Mul(corner_[k], set(3.0)));
        }
    }

    /// Of the two edges of the first triangle that a line crosses, the way leaves by the later.
    HWY_INLINE void begin(WalkRow& row) {
        const auto& [a, b, c] = corner_;
        const Feet3 p = foot(a);
        const Feet3 q = foot(b);
        const Feet3 r = foot(c);
        // They meet in the corner that is alone on its side.
        const Mask ab = hn::Xor(p.above(), q.above());
        const Mask bc = hn::Xor(q.above(), r.above());
        const Mask ca = hn::Xor(r.above(), p.above());
        active_ = hn::Or(ab, bc);
        const Number next = hn::Add(edge_, set(1.0));
        const Hop one =
            hop_over(hn::IfThenElse(ab, edge_, next), hn::IfThenElse(ab, twin_[0], twin_[1]),
                     hn::IfThenElse(ab, a, b), choose(ab, p, q), hn::IfThenElse(ab, b, c),
                     choose(ab, q, r), active_);
        const Hop other =
            hop_over(hn::IfThenElse(ca, hn::Add(edge_, set(2.0)), next),
                     hn::IfThenElse(ca, twin_[2], twin_[1]), hn::IfThenElse(ca, c, b),
                     choose(ca, r, q), hn::IfThenElse(ca, a, c), choose(ca, p, r), active_);
        const Mask other_first = hn::Lt(other.at, one.at);
        hop_ = choose(other_first, one, other);
        most_ = hop_.at;
        hn::Store(hn::IfThenElse(other_first, other.at, one.at), kDoubles, row.at.data() + i_);
        hn::Store(hn::IfThenElse(other_first, other.nearness, one.nearness), kDoubles,
                  row.nearness.data() + i_);
        store_whole(edge_, row.edge, i_);
        store_whole(triangle_, row.triangle, i_);
        fetch_behind();
    }

    HWY_INLINE bool goes_on() const { return !hn::AllFalse(kDoubles, active_); }

    /// Asks for the triangle behind the edge at hand.
    HWY_INLINE void look_behind() {
        beyond_ = hn::AndNot(arrived_, hn::And(active_, hn::Ge(hop_.at, own(starts_->limit))));
        const Mask over = hn::AndNot(hn::Or(arrived_, beyond_), active_);
        static_assert(Mesh::kNoTwin == 0xFFFFFFFFU);  // which is -1
        rim_ = hn::And(over, hn::Eq(hop_.twin, set(-1.0)));
        entered_ = hn::And(over, hn::Ge(hop_.twin, hn::Zero(kDoubles)));
        edge_ = hn::IfThenElseZero(entered_, hop_.twin);
        triangle_ = divide_by_three(edge_);
        const Number first = hn::Mul(triangle_, set(3.0));
        const Number last = hn::Add(first, set(2.0));
        after_ = hn::IfThenElse(hn::Eq(edge_, last), first, hn::Add(edge_, set(1.0)));
        before_ = hn::IfThenElse(hn::Eq(edge_, first), last, hn::Sub(edge_, set(1.0)));
        corner_[0] = corner(edge_);
        corner_[2] = corner(before_);
        twin_[1] = twin(after_);
        twin_[2] = twin(before_);
        fetch(vertices_, hn::Mul(corner_[2], set(3.0)));
    }

    /// Either over the edge at hand, through the triangle behind it, to the edge it is left by; or
    /// here the way ends, at step `count`.
    HWY_INLINE void step(WalkRow& row, std::size_t count) {
        Mask in_sight = entered_;
        const Hop next = go_through(in_sight);
        const Mask turned = hn::And(in_sight, hn::Lt(next.at, hn::Sub(most_, set(kWayRounding))));
        Mask on = hn::AndNot(turned, in_sight);
        if (count == kMostWalkSteps) on = hn::Xor(on, on);

        const Number number = set(static_cast<double>(count));
        count_ = hn::IfThenElse(active_, number, count_);
        const auto finish = [&](Mask which, WalkEnd end) {
            end_ = hn::IfThenElse(which, set(static_cast<double>(end)), end_);
            count_ = hn::IfThenElse(which, hn::Add(number, set(1.0)), count_);
        };
        finish(arrived_, WalkEnd::arrived);
        finish(beyond_, WalkEnd::beyond);
        if (count < kMostWalkSteps) {
            finish(turned, WalkEnd::turned);
            finish(rim_, WalkEnd::rim);
        }
        hn::Store(hn::IfThenElse(on, hop_.at, most_), kDoubles, row.at.data() + i_);
        hn::Store(hop_.nearness, kDoubles, row.nearness.data() + i_);
        store_whole(hop_.edge, row.edge, i_);
        store_whole(triangle_, row.triangle, i_);

        hop_ = choose(on, next, hop_);
        most_ = hn::IfThenElse(on, hn::Max(most_, next.at), most_);
        arrived_ = hn::And(on, hn::Eq(triangle_, own(starts_->target)));
        active_ = on;
        fetch_behind();
    }

    HWY_INLINE void finish(WalkEnds& ends) const {
        const auto put = [&](std::size_t k, const Feet3& foot) {
            hn::Store(foot.side, kDoubles, ends.feet[k].data() + i_);
            hn::Store(foot.along, kDoubles, ends.feet[k + 1].data() + i_);
            hn::Store(foot.depth, kDoubles, ends.feet[k + 2].data() + i_);
        };
        put(0, hop_.first_foot);
        put(3, hop_.second_foot);
        store_whole(count_, ends.count, i_);
        store_whole(end_, ends.end, i_);
    }

  private:
    /// Asks for the triangle behind the edge at hand ahead.
    HWY_INLINE void fetch_behind() const {
        const Number behind = hn::Max(hop_.twin, hn::Zero(kDoubles));
        fetch(corners_, behind);
        fetch(twins_, behind);
    }

    /// Asks for numbers of an array ahead.
    template <class T>
    HWY_INLINE static void fetch(const T* array, Number at) {
        alignas(64) std::int32_t places[kStep];
        hn::Store(to_integers(at), kIntegers, places);
        for (std::size_t k = 0; k < hn::Lanes(kDoubles); ++k) __builtin_prefetch(array + places[k]);
    }

    HWY_INLINE Number own(const WalkNumbers& numbers) const {
        return hn::Load(kDoubles, numbers.data() + i_);
    }
    HWY_INLINE Number corner(Number edge) const {
        return hn::PromoteTo(kDoubles, hn::GatherIndex(kIntegers, corners_, to_integers(edge)));
    }
    HWY_INLINE Number twin(Number edge) const {
        return hn::PromoteTo(kDoubles, hn::GatherIndex(kIntegers, twins_, to_integers(edge)));
    }

    /// As foot_of.
    HWY_INLINE Feet3 foot(Number vertex) const {
        const auto at = to_integers(hn::Mul(vertex, set(3.0)));
        const auto from_start = [&](int axis, double start) {
            const auto value = hn::GatherIndex(kFloats, vertices_ + axis, at);
            return hn::Sub(hn::PromoteTo(kDoubles, value), set(start));
        };
        const Number x = from_start(0, view_->start.x);
        const Number y = from_start(1, view_->start.y);
        const Number z = from_start(2, view_->start.z);
        const auto dot = [&](Number a, Number b, Number c) {
            return hn::Add(hn::Add(hn::Mul(a, x), hn::Mul(b, y)), hn::Mul(c, z));
        };
        const WalkStarts& s = *starts_;
        return {hn::Add(dot(own(s.side_x), own(s.side_y), own(s.side_z)), own(s.side_at_start)),
                dot(own(s.along_x), own(s.along_y), own(s.along_z)),
                dot(set(view_->forward.x), set(view_->forward.y), set(view_->forward.z))};
    }

    /// Over an edge whose ends have feet on different sides. Takes from `in_sight` what lies behind
    /// the eye.
    HWY_INLINE Hop hop_over(Number edge, Number twin, Number first, const Feet3& p, Number second,
                            const Feet3& q, Mask& in_sight) const {
        const Number share = hn::Div(p.side, hn::Sub(p.side, q.side));
        const auto between = [&](Number a, Number b) {
            return hn::Add(a, hn::Mul(share, hn::Sub(b, a)));
        };
        const Number depth = between(p.depth, q.depth);
        const Number pixel =
            hn::Add(set(view_->pixel_at_start), hn::Mul(set(view_->pixel_a_depth), depth));
        const Number at =
            hn::Sub(hn::Div(between(p.along, q.along), pixel), own(starts_->along_at_from));
        const Number nearness =
            view_->pixel_a_depth > 0.0 ? hn::Div(set(1.0), pixel) : hn::Neg(depth);
        in_sight = hn::And(in_sight, hn::Gt(pixel, hn::Zero(kDoubles)));
        return {edge,
                twin,
                first,
                second,
                p,
                q,
                hn::IfThenElse(backwards_, hn::Sub(set(1.0), at), at),
                nearness};
    }

    HWY_INLINE Hop go_through(Mask& in_sight) const {
        const Number a = corner_[0];
        const Number c = corner_[2];
        // Seldom do two neighbours run their edge the same way.
        const Mask alike = hn::Eq(a, hop_.first);
        const Number b = hn::IfThenElse(alike, hop_.second, hop_.first);
        const Feet3 foot_a = choose(alike, hop_.first_foot, hop_.second_foot);
        const Feet3 foot_b = choose(alike, hop_.second_foot, hop_.first_foot);
        const Feet3 foot_c = foot(c);
        // The line crosses the edge of which the new corner is the one end and a or b the other.
        const Mask by_a = hn::Not(hn::Xor(foot_c.above(), foot_b.above()));
        return hop_over(hn::IfThenElse(by_a, before_, after_),
                        hn::IfThenElse(by_a, twin_[2], twin_[1]), hn::IfThenElse(by_a, c, b),
                        choose(by_a, foot_c, foot_b), hn::IfThenElse(by_a, a, c),
                        choose(by_a, foot_a, foot_c), in_sight);
    }

    const std::int32_t* twins_;
    const std::int32_t* corners_;
    const float* vertices_;
    const WayView* view_;
    const WalkStarts* starts_;
    std::size_t i_;
    Mask backwards_, active_, arrived_;
    Mask beyond_, rim_, entered_;  ///< at the edge at hand
    Hop hop_;                      ///< by which edge the walk is about to go on, or where it ended
    Number most_, count_, end_;
    /// Of the triangle behind it: the same edge there, those after and before it, and their twins.
    Number edge_, triangle_, after_, before_;
    Number corner_[3], twin_[3];
};

void walk(const Mesh& mesh, const WayView& view, std::span<const WalkStarts> starts,
          std::span<WalkRow* const> rows, std::span<WalkEnds> ends) {
    constexpr std::size_t kParts = kWalkLanes / kStep;
    Walks walks[kMostWalkGroups * kParts];
    const std::size_t count = starts.size() * kParts;
    for (std::size_t k = 0; k < count; ++k) {
        walks[k].start(mesh, view, starts[k / kParts], k % kParts * kStep);
    }
    for (std::size_t k = 0; k < count; ++k) walks[k].look_around();
    for (std::size_t k = 0; k < count; ++k) walks[k].begin(rows[k / kParts][0]);
    bool any = true;
    for (std::size_t row = 1; any; ++row) {
        for (std::size_t k = 0; k < count; ++k) {
            if (walks[k].goes_on()) walks[k].look_behind();
        }
        any = false;
        for (std::size_t k = 0; k < count; ++k) {
            if (!walks[k].goes_on()) continue;
            walks[k].step(rows[k / kParts][row], row);
            any |= walks[k].goes_on();
        }
    }
    for (std::size_t k = 0; k < count; ++k) walks[k].finish(ends[k / kParts]);
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(walk);

WayLine::WayLine(const Projection& projection, Vec2f from, Vec2f to) {
    const Vec2d a = to_double(from - projection.centre);
    const Vec2d d = to_double(to - from);
    const double squared = dot(d, d);
    const Vec2d step{d.x / squared, d.y / squared};
    const double offset = cross(d, a);
    side = projection.down * d.x - projection.right * d.y -
           projection.forward * (offset * projection.slope_step);
    along = projection.right * step.x + projection.down * step.y;
    side_at_start = -offset * projection.origin_step;
    along_at_from = dot(step, a);
}

Foot foot_of(const WayView& view, const WayLine& line, Vec3f vertex) {
    const Vec3d p = to_double(vertex) - view.start;
    return {dot(line.side, p) + line.side_at_start, dot(line.along, p), dot(view.forward, p)};
}

void WalkStarts::put(std::size_t lane, const WayLine& line, std::uint32_t from, std::uint32_t to,
                     double far_enough, bool turned_round) {
    side_x[lane] = line.side.x;
    side_y[lane] = line.side.y;
    side_z[lane] = line.side.z;
    along_x[lane] = line.along.x;
    along_y[lane] = line.along.y;
    along_z[lane] = line.along.z;
    side_at_start[lane] = line.side_at_start;
    along_at_from[lane] = line.along_at_from;
    triangle[lane] = from;
    target[lane] = to;
    limit[lane] = far_enough;
    backwards[lane] = turned_round ? 1.0 : 0.0;
}

void walk_side_by_side(const Mesh& mesh, const WayView& view, std::span<const WalkStarts> starts,
                       std::span<WalkRow* const> rows, std::span<WalkEnds> ends) {
    HWY_DYNAMIC_DISPATCH(walk)(mesh, view, starts, rows, ends);
}

}  // namespace ink

#endif

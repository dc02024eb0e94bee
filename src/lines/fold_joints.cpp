#include "lines/fold_joints.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "lines/bridges.h"
#include "lines/end_table.h"

namespace ink {

namespace {

using plane::dot;
using plane::EndTable;
using plane::length;
using plane::nearest_on;
using plane::unit;

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

float cosine(float degrees) { return std::cos(degrees * std::numbers::pi_v<float> / 180.0F); }

// The end of segment k at its point a is number 2 k, that at b 2 k + 1.

class JointEaser {
  public:
    JointEaser(const plane::PlacedLines& lines, std::span<const std::size_t> gone, float spacing,
               float width, const JointSettings& settings)
        : places_(lines),
          lines_(lines.all()),
          gone_(lines_.size()),
          spacing_(spacing),
          width_(width),
          settings_(settings) {
        for (const std::size_t k : gone) gone_[k] = 1;
        for (std::uint32_t k = 0; k < lines_.size(); ++k) {
            if (is_fold(k)) folds_.push_back(k);
        }
    }

    FoldJoints run() {
        if (folds_.empty()) return {};
        meet();
        find_loose();
        drop_hairs();
        find_joints();
        find_overlaps();
        std::ranges::sort(joints_, {}, [this](const Joint& joint) {
            const Vec2f p = point(joint.first);
            return std::tuple(joint.straight, p.y, p.x);
        });
        std::vector<std::uint8_t> taken(lines_.size());
        for (const Joint& joint : joints_) ease(joint, taken);
        for (std::size_t k = 0; k < lines_.size(); ++k) {
            if (taken[k] != 0) found_.dropped.push_back(k);
        }
        std::ranges::sort(found_.dropped);
        return std::move(found_);
    }

  private:
    /// Two ends at which a line goes on.
    struct Joint {
        float straight;  ///< cosine of the turn; -1 of two that run past each other
        std::uint32_t first, second;
        float overlap;  ///< by how much, pixels
    };
    struct LooseEnd {
        std::uint32_t end;
        Vec2f point, way;   ///< in which the line would go on
        bool held = false;  ///< it ends on another line
    };
    /// A way along a line, from one of its ends on.
    struct Walk {
        std::vector<Vec2f> points;
        std::vector<std::uint32_t> ends;  ///< of each segment that is walked along, the first
        float length = 0.0F;
        Vec2f last() const { return points.back(); }
    };

    static constexpr std::size_t kMostWalked = 256;  ///< segments
    static constexpr float kHeld = 0.75F;            ///< by a line no farther away, cells

    Vec2f point(std::uint32_t end) const {
        return end % 2 == 0 ? lines_[end / 2].a : lines_[end / 2].b;
    }

    bool is_fold(std::uint32_t k) const { return lines_[k].type == LineType::self_occlusion; }

    /// Says which ends meet.
    void meet() {
        table_ = EndTable(2 * folds_.size());
        for (const std::uint32_t k : folds_) {
            if (gone_[k] != 0) continue;
            table_.add(lines_[k].a, 2 * k);
            table_.add(lines_[k].b, 2 * k + 1);
        }
    }

    /// Which of them meet no other one.
    void find_loose() {
        loose_.clear();
        table_.for_each_alone([&](std::uint32_t end) {
            loose_.push_back({end, point(end), direction(end, 3.0F * spacing_) * -1.0F});
        });
        std::ranges::sort(loose_, {}, [](const LooseEnd& e) {
            return std::tuple(e.point.y, e.point.x, e.way.y, e.way.x);
        });
        for (LooseEnd& loose : loose_) loose.held = is_held(loose.end);
    }

    /// Whether an end ends on a line that is none of its own.
    bool is_held(std::uint32_t end) const {
        const float most = kHeld * spacing_;
        const Vec2f at = point(end);
        bool held = false;
        const Walk own = walk(end, 3.0F * spacing_);
        places_.near(at, 2.0F * most, [&](std::uint32_t k) {
            held = held ||
                   (gone_[k] == 0 && length(nearest_on(lines_[k], at) - at) <= most &&
                    std::ranges::none_of(own.ends, [&](std::uint32_t n) { return n / 2 == k; }));
        });
        return held;
    }

    /// The end of another segment at which the line goes on; kNone if there is not just one.
    std::uint32_t next_to(std::uint32_t end) const {
        const auto& meeting = table_.at(point(end));
        return meeting.count == 2 ? meeting.other(end) : kNone;
    }

    /// Away from an end, along its segment and on, for `far` pixels or until the line ends.
    Walk walk(std::uint32_t end, float far) const {
        Walk walk;
        walk.points.reserve(16);
        walk.ends.reserve(16);
        walk.points.push_back(point(end));
        while (end != kNone && walk.length < far && walk.ends.size() < kMostWalked) {
            walk.ends.push_back(end);
            walk.points.push_back(point(end ^ 1U));
            walk.length += length(walk.points.back() - walk.points[walk.points.size() - 2]);
            end = next_to(end ^ 1U);
        }
        return walk;
    }

    /// In which a line goes that is walked along.
    static Vec2f direction(const Walk& walk) { return unit(walk.last() - walk.points.front()); }
    /// In which a line goes that would be walked along.
    Vec2f direction(std::uint32_t end, float far) const {
        const Vec2f from = point(end);
        Vec2f at = from;
        float walked = 0.0F;
        for (std::size_t n = 0; end != kNone && walked < far && n < kMostWalked; ++n) {
            const Vec2f to = point(end ^ 1U);
            walked += length(to - at);
            at = to;
            end = next_to(end ^ 1U);
        }
        return unit(at - from);
    }

    /// Where one line was joined to another near its end, what is left of that end sticks out; so
    /// does the end of a line that turns back.
    void drop_hairs() {
        for (const LooseEnd& loose : loose_) {
            const Walk hair = walk(loose.end, settings_.hair * width_);
            if (hair.length < settings_.hair * width_ && table_.at(hair.last()).count == 3) {
                drop(hair.ends);
            } else if (!loose.held) {
                drop_hook(loose.end);
            }
        }
        if (found_.dropped.empty()) return;
        for (const std::size_t k : found_.dropped) {
            if (gone_[k] != 0) continue;  // as part of another one
            gone_[k] = 1;
            table_.remove(lines_[k].a, static_cast<std::uint32_t>(2 * k));
            table_.remove(lines_[k].b, static_cast<std::uint32_t>(2 * k + 1));
        }
        find_loose();
    }

    void drop(std::span<const std::uint32_t> ends) {
        for (const std::uint32_t end : ends) found_.dropped.push_back(end / 2);
    }

    /// Up to where the line turns back, if that is near.
    void drop_hook(std::uint32_t end) {
        const Walk hook = walk(end, settings_.hook * width_);
        float sharpest = cosine(settings_.hook_turn);
        std::size_t at = 0;
        for (std::size_t n = 1; n + 1 < hook.points.size(); ++n) {
            const Vec2f before = unit(hook.points[n] - hook.points[0]);
            const float turn = dot(before, direction(hook.ends[n], 1.5F * spacing_));
            if (turn >= sharpest) continue;
            sharpest = turn;
            at = n;
        }
        // Of what goes on for less, nobody knows which is the hook.
        if (at == 0 || walk(hook.ends[at], hook.length).length < hook.length) return;
        drop(std::span(hook.ends).first(at));
    }

    /// Where a piece that joins others turns.
    void find_joints() {
        const float sharp = cosine(settings_.least_turn);
        const auto first_joining = static_cast<std::uint32_t>(2 * places_.first_joining());
        for (std::uint32_t end = first_joining; end < 2 * lines_.size(); ++end) {
            if (!is_fold(end / 2) || gone_[end / 2] != 0) continue;
            const std::uint32_t other = next_to(end);
            if (other == kNone) continue;
            if (other >= first_joining && other < end) continue;  // seen from there
            const float far = 1.5F * spacing_;
            const float straight = -dot(direction(end, far), direction(other, far));
            if (straight < sharp) {
                joints_.push_back({straight, std::min(end, other), std::max(end, other), 0.0F});
            }
        }
    }

    /// Ends of two lines that run past each other, the nearest first.
    void find_overlaps() {
        std::vector<std::tuple<float, std::size_t, std::size_t, float>> pairs;
        const float most = (settings_.aside + settings_.overlap) * width_;
        for (std::size_t k = 0; k < loose_.size(); ++k) {
            for (std::size_t n = k + 1; n < loose_.size(); ++n) {
                if (loose_[n].point.y - loose_[k].point.y > most) break;
                if (const auto overlap = overlap_of(loose_[k], loose_[n])) {
                    pairs.emplace_back(length(loose_[n].point - loose_[k].point), k, n, *overlap);
                }
            }
        }
        std::ranges::sort(pairs);
        std::vector<bool> paired(loose_.size());
        for (const auto& [apart, k, n, overlap] : pairs) {
            if (paired[k] || paired[n] || loose_[k].held || loose_[n].held) {
                continue;
            }
            paired[k] = paired[n] = true;
            joints_.push_back({-1.0F, loose_[k].end, loose_[n].end, std::max(overlap, 0.0F)});
        }
    }

    /// By how many pixels two ends of one line run past each other, less than zero where they do
    /// not; nothing if they are none.
    std::optional<float> overlap_of(const LooseEnd& a, const LooseEnd& b) const {
        const Segment& s = lines_[a.end / 2];
        const Segment& t = lines_[b.end / 2];
        const bool a_front = s.left_in_front == (a.end % 2 != 0);
        const bool b_front = t.left_in_front == (b.end % 2 != 0);
        if (s.owner != t.owner || a_front == b_front || a.end / 2 == b.end / 2) return {};
        if (-dot(a.way, b.way) < cosine(settings_.most_turned)) return {};
        const Vec2f way = unit(a.way - b.way);
        const Vec2f apart = b.point - a.point;
        const float ahead = dot(apart, way);
        const float aside = std::abs(dot(apart, plane::left_of(way)));
        if (aside > settings_.aside * width_ || ahead > settings_.gap * width_ ||
            -ahead > settings_.overlap * width_) {
            return {};
        }
        return -ahead;
    }

    /// Lets a curve take the place of the line on both sides of a joint.
    void ease(const Joint& joint, std::vector<std::uint8_t>& taken) {
        const float reach = settings_.reach * width_ + joint.overlap;
        const Walk before = walk(joint.first, reach);
        const Walk after = walk(joint.second, reach);
        if (std::min(before.length, after.length) < 0.5F * reach) return;
        for (const Walk* side : {&before, &after}) {
            for (const std::uint32_t end : side->ends) {
                if (taken[end / 2] != 0) return;
            }
        }
        const Vec2f from = before.last();
        const Vec2f to = after.last();
        const Vec2f way_from = way_at_end_of(before);
        const Vec2f way_to = way_at_end_of(after);
        constexpr float kAhead = 0.6F;
        const Vec2f chord = unit(to - from);
        if (-dot(way_from, way_to) < cosine(settings_.most_turned) ||
            dot(way_from, chord) < kAhead || dot(way_to, chord) > -kAhead) {
            return;
        }
        for (const Walk* side : {&before, &after}) {
            for (const std::uint32_t end : side->ends) taken[end / 2] = 1;
        }
        const std::uint32_t model = before.ends.back();
        Vec2f at = from;
        for (const Vec2f next : plane::curve_between(from, way_from, to, way_to, spacing_)) {
            const std::vector<Vec2f> cut = plane::cut_by_cells(at, next, spacing_);
            for (std::size_t n = 1; n < cut.size(); ++n) {
                found_.curves.push_back(
                    plane::piece_like(lines_[model / 2], model % 2 != 0, cut[n - 1], cut[n]));
            }
            at = next;
        }
    }

    /// Back towards where a walk began, as the line that goes on past its end points.
    Vec2f way_at_end_of(const Walk& walked) const {
        const std::uint32_t next = next_to(walked.ends.back() ^ 1U);
        if (next != kNone) return direction(next, 3.0F * spacing_) * -1.0F;
        return unit(walked.points[walked.points.size() / 2] - walked.last());
    }

    const plane::PlacedLines& places_;
    std::span<const Segment> lines_;
    std::vector<std::uint8_t> gone_;
    float spacing_, width_;
    const JointSettings& settings_;
    std::vector<std::uint32_t> folds_;  ///< the self-occlusions among the lines
    EndTable table_{0};
    std::vector<LooseEnd> loose_;  ///< by place
    std::vector<Joint> joints_;
    FoldJoints found_;
};

}  // namespace

FoldJoints ease_joints(const plane::PlacedLines& lines, std::span<const std::size_t> gone,
                       float spacing, float width, const JointSettings& settings) {
    return JointEaser(lines, gone, spacing, width, settings).run();
}

}  // namespace ink

#include "lines/line_gaps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "lines/bridges.h"
#include "lines/end_table.h"
#include "lines/segment_squares.h"

namespace ink {

namespace {

using plane::dot;
using plane::EndTable;
using plane::length;
using plane::nearest_on;
using plane::unit;

/// An end of a segment.
struct End {
    Vec2f point;
    std::uint32_t segment;
    bool at_b;
    Vec2f way{};  ///< in which the line would go on
};

float cross(Vec2f a, Vec2f b) { return a.x * b.y - a.y * b.x; }

class GapCloser {
  public:
    GapCloser(const plane::PlacedLines& lines, std::span<const std::size_t> gone, float spacing,
              float width, const GapSettings& settings)
        : places_(lines),
          lines_(lines.all()),
          gone_(lines_.size()),
          spacing_(spacing),
          most_(std::max(settings.longest * width, settings.longest_cells * spacing)),
          settings_(settings),
          table_(count_ends(lines_)) {
        for (const std::size_t k : gone) gone_[k] = 1;
    }

    std::vector<Segment> run() {
        find_loose();
        const std::vector<Pair> found = pairs();
        for (const auto& [apart, first, second] : found) {
            End& a = loose_[first];
            End& b = loose_[second];
            if (closed_[first] || closed_[second] || is_crossed(a, b)) continue;
            closed_[first] = closed_[second] = true;
            bridge(a, b);
        }
        return std::move(bridges_);
    }

  private:
    static bool may_break(const Segment& line) {
        return line.type == LineType::crease || line.type == LineType::self_occlusion ||
               line.type == LineType::boundary;
    }
    static std::size_t count_ends(std::span<const Segment> lines) {
        return 2 * static_cast<std::size_t>(std::ranges::count_if(lines, may_break));
    }

    template <class Visit>
    void for_each_end(Visit visit) const {
        for (std::uint32_t k = 0; k < lines_.size(); ++k) {
            if (gone_[k] != 0 || !may_break(lines_[k])) continue;
            visit(lines_[k].a, 2 * k);
            visit(lines_[k].b, 2 * k + 1);
        }
    }

    void find_loose() {
        for_each_end([&](Vec2f point, std::uint32_t end) { table_.add(point, end); });
        table_.for_each_alone([&](std::uint32_t number) {
            const Segment& line = lines_[number / 2];
            if (line.strength < settings_.least_strength) return;
            const bool at_b = number % 2 != 0;
            End end{at_b ? line.b : line.a, number / 2, at_b};
            end.way = unit(end.point - back_from(end));
            loose_.push_back(end);
        });
        std::ranges::sort(loose_, {}, [](const End& end) {
            return std::tuple(end.point.y, end.point.x, end.way.y, end.way.x);
        });
        closed_.assign(loose_.size(), false);
    }

    /// A point on the line some pixels before its end.
    Vec2f back_from(End end) const {
        const float enough = 3.0F * spacing_;
        float walked = 0.0F;
        for (int step = 0;; ++step) {
            const Segment& line = lines_[end.segment];
            const Vec2f from = end.at_b ? line.b : line.a;
            const Vec2f to = end.at_b ? line.a : line.b;
            walked += length(to - from);
            const auto& meeting = table_.at(to);
            if (walked >= enough || meeting.count != 2 || step == 8) return to;
            const std::uint32_t next = meeting.other(2 * end.segment + (end.at_b ? 0 : 1));
            end = {to, next / 2, next % 2 != 0};
        }
    }

    struct Pair {
        float apart;
        std::size_t first, second;
        auto operator<=>(const Pair&) const = default;
    };

    /// The nearest first.
    std::vector<Pair> pairs() const {
        std::vector<Pair> found;
        for (std::size_t k = 0; k < loose_.size(); ++k) {
            for (std::size_t n = k + 1; n < loose_.size(); ++n) {
                if (loose_[n].point.y - loose_[k].point.y > most_) break;
                const float apart = length(loose_[n].point - loose_[k].point);
                if (apart <= most_ && face_each_other(loose_[k], loose_[n])) {
                    found.push_back({apart, k, n});
                }
            }
        }
        std::ranges::sort(found);
        return found;
    }

    bool face_each_other(const End& a, const End& b) const {
        const Vec2f way = unit(b.point - a.point);
        return lines_[a.segment].owner == lines_[b.segment].owner &&
               dot(a.way, way) > settings_.least_ahead && dot(b.way, way) < -settings_.least_ahead;
    }

    /// Whether another line runs across the gap, or either line ends on one.
    bool is_crossed(const End& a, const End& b) const {
        const Vec2f way = unit(b.point - a.point);
        const float reach = 0.75F * spacing_;
        const Vec2f from = a.point - way * reach;
        const Vec2f to = b.point + way * reach;
        const auto crosses = [&](const Segment& line) {
            if (std::max(line.a.y, line.b.y) < std::min(from.y, to.y) - reach ||
                std::min(line.a.y, line.b.y) > std::max(from.y, to.y) + reach ||
                std::max(line.a.x, line.b.x) < std::min(from.x, to.x) - reach ||
                std::min(line.a.x, line.b.x) > std::max(from.x, to.x) + reach) {
                return false;
            }
            const Vec2f along = line.b - line.a;
            if (std::abs(cross(unit(along), way)) < settings_.crossing) return false;
            const bool apart =
                (cross(line.a - from, way) > 0.0F) == (cross(line.b - from, way) > 0.0F);
            const bool before =
                (cross(from - line.a, along) > 0.0F) == (cross(to - line.a, along) > 0.0F);
            if (!apart && !before) return true;
            // What ends on the gap.
            const auto beside = [&](Vec2f p) {
                const float s = dot(p - from, way);
                return s > 0.0F && s < length(to - from) &&
                       std::abs(cross(p - from, way)) < 0.25F * spacing_;
            };
            const bool own =
                line.a == a.point || line.b == a.point || line.a == b.point || line.b == b.point;
            return !own && (beside(line.a) || beside(line.b));
        };
        constexpr float kLongest = 1.5F;  // segment, cells
        const float near = 0.5F * (length(to - from) + kLongest * spacing_) + 2.0F * reach;
        bool found = false;
        places_.near((from + to) * 0.5F, near, [&](std::uint32_t k) {
            found = found || (gone_[k] == 0 && crosses(lines_[k]));
        });
        return found;
    }

    /// Whether an end lies within its cell, not on a side of it.
    bool is_within_cell(const End& end) const {
        return end.at_b && !lines_[end.segment].spans_cell;
    }

    void bridge(const End& a, const End& b) {
        std::vector<Vec2f> points{a.point};
        for (const Vec2f to : plane::curve_between(a.point, a.way, b.point, b.way, spacing_)) {
            const std::vector<Vec2f> cut = plane::cut_by_cells(points.back(), to, spacing_);
            points.insert(points.end(), cut.begin() + 1, cut.end());
        }
        const bool first_within = is_within_cell(a);
        const bool last_within = is_within_cell(b);
        if (points.size() < 3 && first_within && last_within) return;
        const Segment& line = lines_[a.segment];
        for (std::size_t n = 1; n < points.size(); ++n) {
            // Such an end is a segment's second.
            const bool back = n == 1 && first_within;
            Segment piece = back ? plane::piece_like(line, !a.at_b, points[1], points[0])
                                 : plane::piece_like(line, a.at_b, points[n - 1], points[n]);
            piece.spans_cell = !back && !(last_within && n + 1 == points.size());
            bridges_.push_back(piece);
        }
    }

    const plane::PlacedLines& places_;
    std::span<const Segment> lines_;
    std::vector<std::uint8_t> gone_;
    float spacing_, most_;
    const GapSettings& settings_;
    EndTable table_;
    std::vector<End> loose_;  ///< by place
    std::vector<bool> closed_;
    std::vector<Segment> bridges_;
};

}  // namespace

std::vector<Segment> close_gaps(const plane::PlacedLines& lines, std::span<const std::size_t> gone,
                                float spacing, float width, const GapSettings& settings) {
    return GapCloser(lines, gone, spacing, width, settings).run();
}

}  // namespace ink

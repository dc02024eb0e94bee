#include "vector/outlines.h"

#include <algorithm>
#include <utility>

namespace ink {

namespace {

void append(Curve& outline, const Curve& next) {
    outline.pieces.insert(outline.pieces.end(), next.pieces.begin(), next.pieces.end());
}

}  // namespace

void append_straight(Curve& outline, Vec2f to) {
    const Vec2f from = outline.end();
    if (from == to) return;
    outline.pieces.push_back(straight_piece(from, to));
}

std::optional<float> Border::place(Vec2f p) const {
    constexpr float kNear = 1e-2F;  // pixels
    const Vec2f size = upper_ - lower_;
    const float x = std::clamp((p.x - lower_.x) / size.x, 0.0F, 1.0F);
    const float y = std::clamp((p.y - lower_.y) / size.y, 0.0F, 1.0F);
    if (p.x < lower_.x + kNear) return y;
    if (p.y > upper_.y - kNear) return 1.0F + x;
    if (p.x > upper_.x - kNear) return 3.0F - y;
    if (p.y < lower_.y + kNear) return 4.0F - x;
    return std::nullopt;
}

void Border::follow(float from, float to, Curve& outline) const {
    const float end = to < from ? to + 4.0F : to;
    for (int corner = static_cast<int>(from) + 1; static_cast<float>(corner) < end; ++corner) {
        append_straight(outline, corners()[static_cast<std::size_t>(corner % 4)]);
    }
}

std::optional<std::size_t> Outliner::unused_from(std::uint32_t vertex) const {
    const auto found =
        std::ranges::lower_bound(uses_, vertex, {}, [this](const Use& use) { return start(use); });
    for (auto use = found; use != uses_.end() && start(*use) == vertex; ++use) {
        const auto k = static_cast<std::size_t>(use - uses_.begin());
        if (used_[k] == 0) return k;
    }
    return std::nullopt;
}

void Outliner::join(std::size_t first) {
    const std::uint32_t goal = start(uses_[first]);
    Curve outline{curve(uses_[first]).start, {}};
    std::optional<std::size_t> next = first;
    std::uint32_t end = goal;
    while (next) {
        used_[*next] = 1;
        append(outline, curve(uses_[*next]));
        end = finish(uses_[*next]);
        if (end == goal) break;
        next = unused_from(end);
    }
    if (end == goal) {
        closed_.push_back(std::move(outline));
        return;
    }
    const Vec2f last = outline.pieces.back().end;
    const auto place = border_.place(outline.start);
    open_.push_back({std::move(outline), place, border_.place(last)});
}

/// Which run goes on where each one ends: along the border for those that leave the rectangle; for
/// those that end inside, at a line too thin to be found, one that starts near. Else itself.
std::vector<std::size_t> Outliner::follow_ups() const {
    constexpr float kNear = 4.0F;  // pixels
    struct Link {
        float way;
        std::size_t from, to;
    };
    std::vector<std::pair<float, std::size_t>> places, rows;  // of starts
    for (std::size_t k = 0; k < open_.size(); ++k) {
        if (open_[k].first) places.emplace_back(*open_[k].first, k);
        if (!open_[k].first) rows.emplace_back(open_[k].curve.start.y, k);
    }
    std::ranges::sort(places);
    std::ranges::sort(rows);
    std::vector<Link> links;
    for (std::size_t k = 0; k < open_.size(); ++k) {
        if (open_[k].last && !places.empty()) {
            const auto ahead = std::ranges::lower_bound(places, std::pair{*open_[k].last, k});
            links.push_back({0.0F, k, ahead == places.end() ? places[0].second : ahead->second});
        }
        if (open_[k].last) continue;
        const Vec2f end = open_[k].curve.pieces.back().end;
        auto row = std::ranges::lower_bound(rows, std::pair{end.y - kNear, std::size_t{0}});
        for (; row != rows.end() && row->first < end.y + kNear; ++row) {
            const float way = length(open_[row->second].curve.start - end);
            if (way < kNear) links.push_back({way, k, row->second});
        }
    }
    std::ranges::stable_sort(links, {}, &Link::way);
    constexpr auto kOpen = static_cast<std::size_t>(-1);
    std::vector<std::size_t> next(open_.size(), kOpen);
    std::vector<std::uint8_t> taken(open_.size(), 0);
    for (const Link& link : links) {
        if (next[link.from] != kOpen || taken[link.to] != 0) continue;
        next[link.from] = link.to;
        taken[link.to] = 1;
    }
    for (std::size_t k = 0; k < open_.size(); ++k) {
        if (next[k] == kOpen) next[k] = k;
    }
    return next;
}

void Outliner::close_open_runs() {
    const std::vector<std::size_t> next = follow_ups();
    std::vector<std::uint8_t> done(open_.size(), 0);
    for (std::size_t first = 0; first < open_.size(); ++first) {
        if (done[first] != 0) continue;
        Curve outline{open_[first].curve.start, {}};
        // May run into a cycle that does not come back to its start, and is closed then.
        for (std::size_t k = first; done[k] == 0; k = next[k]) {
            done[k] = 1;
            append_straight(outline, open_[k].curve.start);
            append(outline, open_[k].curve);
            const auto& goal = open_[next[k]].first;
            if (open_[k].last && goal) border_.follow(*open_[k].last, *goal, outline);
        }
        append_straight(outline, outline.start);
        closed_.push_back(std::move(outline));
    }
}

std::vector<Curve> Outliner::outlines(std::span<const Use> uses) {
    uses_.assign(uses.begin(), uses.end());
    std::ranges::stable_sort(uses_, {}, [this](const Use& use) { return start(use); });
    used_.assign(uses_.size(), 0);
    closed_.clear();
    open_.clear();
    std::vector<std::uint32_t> finishes;
    for (const Use& use : uses_) finishes.push_back(finish(use));
    std::ranges::sort(finishes);
    // Runs that start at the border first, or one could be entered in the middle.
    for (const bool open : {true, false}) {
        for (std::size_t k = 0; k < uses_.size(); ++k) {
            if (used_[k] != 0) continue;
            if (open && std::ranges::binary_search(finishes, start(uses_[k]))) continue;
            join(k);
        }
    }
    touched_border_ = touched_border_ || std::ranges::any_of(open_, [](const Open& run) {
                          return run.last.has_value();
                      });
    close_open_runs();
    return std::move(closed_);
}

}  // namespace ink

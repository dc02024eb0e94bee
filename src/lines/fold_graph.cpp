#include "lines/fold_graph.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "lines/segment_squares.h"

namespace ink {

using plane::length;

namespace {

std::vector<std::uint32_t> folds_among(std::span<const Segment> lines) {
    std::vector<std::uint32_t> folds;
    for (std::uint32_t k = 0; k < lines.size(); ++k) {
        if (lines[k].type == LineType::self_occlusion) folds.push_back(k);
    }
    return folds;
}

}  // namespace

FoldGraph::FoldGraph(std::span<const Segment> lines)
    : lines_(lines), folds_(folds_among(lines)), table_(2 * folds_.size()) {
    if (folds_.empty()) return;
    parents_.resize(lines.size());
    std::iota(parents_.begin(), parents_.end(), 0U);
    for (const std::uint32_t k : folds_) {
        for (const FoldEnd end : {FoldEnd{k, false}, FoldEnd{k, true}}) {
            const auto& meeting = table_.add(point(end), number(end));
            if (meeting.count > 1) unite(k, end_of(meeting.first).fold);
        }
    }
}

void FoldGraph::unite(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t x = root(a);
    const std::uint32_t y = root(b);
    parents_[std::max(x, y)] = std::min(x, y);
}

std::vector<std::uint32_t> FoldGraph::roots() const {
    // The root of a group is its first line: parents come before their children.
    std::vector<std::uint32_t> roots = parents_;
    for (const std::uint32_t k : folds_) roots[k] = roots[roots[k]];
    return roots;
}

std::vector<FoldEnd> FoldGraph::loose_ends() const {
    std::vector<FoldEnd> loose;
    table_.for_each_alone([&](std::uint32_t end) { loose.push_back(end_of(end)); });
    std::ranges::sort(loose, {}, [&](FoldEnd end) {
        const Vec2f p = point(end);
        return std::tuple(p.y, p.x);
    });
    return loose;
}

std::optional<FoldEnd> FoldGraph::next(FoldEnd end) const {
    const auto& meeting = table_.at(point(end));
    if (meeting.count != 2) return {};
    return end_of(meeting.other(number(end)));
}

Vec2f FoldGraph::back_from(FoldEnd end, float enough) const {
    float walked = 0.0F;
    for (int step = 0;; ++step) {
        const FoldEnd far{end.fold, !end.at_b};
        walked += length(point(far) - point(end));
        const std::optional<FoldEnd> beyond = next(far);
        if (walked >= enough || !beyond || step == 8) return point(far);
        end = *beyond;
    }
}

FoldGraph::NearEnd FoldGraph::end_near(FoldEnd towards, Vec2f from) const {
    constexpr int kMostSteps = 8;
    Vec2f at = plane::nearest_on(lines_[towards.fold], from);
    float away = 0.0F;
    for (int step = 0; step < kMostSteps; ++step) {
        const Vec2f to = point(towards);
        away += length(to - at);
        if (ends_at(to)) return {number(towards), away};
        const std::optional<FoldEnd> beyond = next(towards);
        if (!beyond) break;
        towards = {beyond->fold, !beyond->at_b};
        at = to;
    }
    return {};
}

}  // namespace ink

#include "lines/fold_crumbs.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "lines/segment_squares.h"

namespace ink {

using plane::length;

std::vector<std::size_t> FoldCrumbs::find(const FoldEndings& endings,
                                          std::span<const Segment> bridges,
                                          std::span<const std::uint32_t> owners) {
    for (const std::uint32_t k : graph_.folds()) {
        if (graph_.root(k) == k) roots_.push_back(k);
        group_of(k).length += length(lines_[k].b - lines_[k].a);
    }
    for (std::size_t n = 0; n < owners.size(); ++n) {
        group_of(owners[n]).length += length(bridges[n].b - bridges[n].a);
    }
    for (const std::uint32_t k : endings.loose) group_of(k).loose = true;
    for (const std::uint32_t k : endings.free) group_of(k).free = true;
    for (const std::uint32_t k : endings.stubs) group_of(k).stub = true;
    find_bumps();
    for (const std::uint32_t k : roots_) {
        Group& group = group_of(k);
        group.crumb = is_dot(k) || (!group.loose && !group.leaves);
    }
    unite_followers(endings.followers);
    std::erase_if(roots_, [&](std::uint32_t k) { return graph_.root(k) != k; });
    do {
        attach(endings.hangs);
    } while (judge());
    std::vector<std::size_t> crumbs;
    std::ranges::copy_if(graph_.folds(), std::back_inserter(crumbs),
                         [&](std::uint32_t k) { return has(k); });
    return crumbs;
}

/// One line in two pieces, neither of which is too shallow to count.
void FoldCrumbs::unite_followers(std::span<const FoldHang> followers) {
    std::vector<std::uint8_t> asked(lines_.size());
    for (const FoldHang& hang : followers) {
        asked[graph_.root(hang.fold)] = asked[graph_.root(hang.line)] = 1;
    }
    // And at once what will be asked for next, as a rule.
    measure([&](std::uint32_t root) { return asked[root] != 0 || may_be_shallow(groups_[root]); });
    const auto counts = [&](std::uint32_t fold) {
        const Group& group = group_of(fold);
        return group.length * group.depth >= settings_.follower_area * width_ * width_;
    };
    std::vector<FoldHang> united;
    std::ranges::copy_if(followers, std::back_inserter(united), [&](const FoldHang& hang) {
        return counts(hang.fold) && counts(hang.line);
    });
    for (const auto& [fold, line, at_b] : united) {
        const Group a = group_of(fold);
        const Group b = group_of(line);
        if (graph_.root(fold) == graph_.root(line)) continue;
        graph_.unite(fold, line);
        Group& both = group_of(fold);
        both.length = a.length + b.length;
        both.depth = std::max(a.depth, b.depth);
        both.measured = true;
        both.loose = a.loose || b.loose;
        both.free = a.free || b.free;
        both.stub = a.stub || b.stub;
    }
}

/// What hung on a crumb ends freely.
void FoldCrumbs::attach(std::span<const FoldHang> hangs) {
    for (const std::uint32_t root : roots_) groups_[root].attached = false;
    for (const auto& [fold, line, at_b] : hangs) {
        Group& group = group_of(fold);
        if (graph_.root(line) == graph_.root(fold)) continue;
        if (graph_.is_fold(line) && has(line)) {
            group.loose = group.free = true;
        } else {
            group.attached = true;
        }
    }
}

/// Whether a group is a ring that its own line fills.
bool FoldCrumbs::is_dot(std::uint32_t root) const {
    const Group& group = groups_[root];
    if (group.loose || group.stub || group.length >= settings_.shortest_stub * stroke_)
        return false;
    constexpr int kMostInDot = 64;  // segments
    std::optional<FoldEnd> end = FoldEnd{root, true};
    for (int step = 0; end && step < kMostInDot; ++step) {
        end = graph_.next(*end);
        if (!end) break;
        if (end->fold == root) return true;
        end->at_b = !end->at_b;
    }
    return false;
}

/// A fold that leaves an outline and comes back within half a stroke adds nothing but a bump to it.
void FoldCrumbs::find_bumps() {
    for (const std::uint32_t k : graph_.folds()) {
        Group& group = group_of(k);
        if (group.loose || group.leaves) continue;
        group.leaves = !runs_on_outline(lines_[k].a) || !runs_on_outline(lines_[k].b);
    }
}

/// Whether the stroke of an outline covers a point.
bool FoldCrumbs::runs_on_outline(Vec2f point) const {
    const float half = 0.5F * stroke_;
    bool covered = false;
    squares_.near(point, half + spacing_, [&](std::uint32_t k) {
        const LineType type = lines_[k].type;
        covered = covered || ((type == LineType::silhouette || type == LineType::boundary) &&
                              length(plane::nearest_on(lines_[k], point) - point) <= half);
    });
    return covered;
}

bool FoldCrumbs::is_short(const Group& group) const {
    return group.loose && group.length < settings_.longest_crumb * width_;
}

float FoldCrumbs::least_length(const Group& group) const {
    if (group.free) return settings_.shortest * width_;
    return group.loose || group.stub ? settings_.shortest_stub * width_ : 0.0F;
}

/// Whether its depth makes it a crumb or not.
bool FoldCrumbs::may_be_shallow(const Group& group) const {
    return is_short(group) && !group.crumb && group.length >= least_length(group);
}

/// Finds crumbs among groups that are none so far. What hung on one ends freely from then on, so
/// that there may be more: false if no group became one.
bool FoldCrumbs::judge() {
    measure([&](std::uint32_t root) { return may_be_shallow(groups_[root]); });
    bool any = false;
    for (const std::uint32_t root : roots_) {
        Group& group = groups_[root];
        if (group.crumb) continue;
        const float most = group.attached ? settings_.stub_area : settings_.crumb_area;
        group.crumb = group.length < least_length(group) ||
                      (is_short(group) && group.length * group.depth < most * width_ * width_);
        any |= group.crumb;
    }
    return any;
}

/// The greatest depth of each group that is asked for by its root, in pixels, unless it is known.
/// First of a few folds of each: mostly these are deep enough to tell that the group counts.
template <class Asked>
void FoldCrumbs::measure(Asked asked) {
    constexpr std::uint32_t kFew = 8;  // one of so many
    const auto wanted = [&](std::uint32_t root) { return !groups_[root].measured && asked(root); };
    if (std::ranges::none_of(roots_, wanted)) return;
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> rest;
    for (const std::uint32_t k : graph_.folds()) {
        if (!wanted(graph_.root(k))) continue;
        Group& group = group_of(k);
        (group.folds++ % kFew == 0 ? first : rest).push_back(k);
    }
    measure_all(first);
    const float enough = std::max(settings_.crumb_area, settings_.stub_area) * width_ * width_;
    const auto is_told = [&](std::uint32_t k) {
        return group_of(k).length * group_of(k).depth >= enough;
    };
    std::erase_if(rest, is_told);
    measure_all(rest);
    constexpr float kBottomless = 1e9F;  // beside nothing but another geometry
    for (const std::uint32_t k : first) {
        Group& group = group_of(k);
        group.measured = true;
        if (group.depth < 0.0F) group.depth = kBottomless;
    }
}

void FoldCrumbs::measure_all(std::vector<std::uint32_t>& folds) {
    if (folds.empty()) return;
    const std::vector<float> depths = probe_.depths_of(folds, loop_);
    for (std::size_t n = 0; n < folds.size(); ++n) {
        float& depth = group_of(folds[n]).depth;
        depth = std::max(depth, depths[n]);
    }
}

}  // namespace ink

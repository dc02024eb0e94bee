#include "lines/smooth_discs.h"

#include <algorithm>
#include <utility>

namespace ink {

namespace {

/// Bit i of `words` stays set where bit i + by of `from` is.
void and_shifted(const NodeBits* from, std::size_t count, int by, NodeBits* words) {
    if (by == 0) {
        for (std::size_t k = 0; k < count; ++k) words[k] &= from[k];
    } else if (by > 0) {
        for (std::size_t k = 0; k < count; ++k) {
            const NodeBits beyond = k + 1 < count ? from[k + 1] << (kNodesInWord - by) : 0;
            words[k] &= from[k] >> by | beyond;
        }
    } else {
        for (std::size_t k = 0; k < count; ++k) {
            const NodeBits before = k > 0 ? from[k - 1] >> (kNodesInWord + by) : 0;
            words[k] &= from[k] << -by | before;
        }
    }
}

}  // namespace

SmoothDiscs::SmoothDiscs(const RidgeGrid& grid, const Viewpoint& viewpoint,
                         std::vector<int> half_widths)
    : grid_(grid),
      viewpoint_(viewpoint),
      half_widths_(std::move(half_widths)),
      words_(words_for(grid.width)),
      rows_(2 * half_widths_.size() - 1),
      links_(words_),
      nodes_(words_) {
    const std::size_t widths = static_cast<std::size_t>(half_widths_[0]) + 1;
    for (Row& row : rows_) {
        row.across.resize(widths * words_);
        row.down.resize(widths * words_);
    }
    for (NodePlaces* places : {&places_, &places_below_}) {
        for (auto* plane : {&places->x, &places->y, &places->z}) {
            plane->resize(static_cast<std::size_t>(grid.width) + kLanes);
        }
    }
}

void SmoothDiscs::start(int row) {
    next_ = row;
    place_nodes(grid_, row - radius(), viewpoint_, places_below_);
    for (int j = row - radius(); j < row + radius(); ++j) enter(j);
}

void SmoothDiscs::enter(int j) {
    Row& to = row(j);
    const auto widths = half_widths_[0] + 1;
    const auto eroded = [&](std::vector<NodeBits>& words, int half_width) {
        return words.data() + static_cast<std::size_t>(half_width) * words_;
    };
    const std::size_t first = grid_.index(0, j);
    links_.back() = 0;
    std::swap(places_, places_below_);
    const NodeRow nodes{grid_, first, places_, 0};
    link_nodes(nodes, {grid_, first + 1, places_, 1}, grid_.width - 1, links_.data());
    std::fill_n(to.across.data(), words_, ~NodeBits{0});
    for (int w = 1; w < widths; ++w) {
        NodeBits* const words = eroded(to.across, w);
        std::copy_n(eroded(to.across, w - 1), words_, words);
        and_shifted(links_.data(), words_, w - 1, words);
        and_shifted(links_.data(), words_, -w, words);
    }
    if (j + 1 >= grid_.height) return;
    NodeBits* const links = to.down.data();
    place_nodes(grid_, j + 1, viewpoint_, places_below_);
    link_nodes(nodes, {grid_, grid_.index(0, j + 1), places_below_, 0}, grid_.width, links);
    for (int w = 1; w < widths; ++w) {
        NodeBits* const words = eroded(to.down, w);
        std::copy_n(eroded(to.down, w - 1), words_, words);
        and_shifted(links, words_, w, words);
        and_shifted(links, words_, -w, words);
    }
}

const std::vector<NodeBits>& SmoothDiscs::next() {
    const int j = next_++;
    enter(j + radius());
    std::ranges::fill(nodes_, ~NodeBits{0});
    const auto keep = [&](const std::vector<NodeBits>& eroded, int half_width) {
        and_shifted(eroded.data() + static_cast<std::size_t>(half_width) * words_, words_, 0,
                    nodes_.data());
    };
    for (int d = -radius(); d <= radius(); ++d) {
        const auto half_width = [&](int row) {
            return half_widths_[static_cast<std::size_t>(row < 0 ? -row : row)];
        };
        keep(row(j + d).across, half_width(d));
        if (d < radius()) keep(row(j + d).down, std::min(half_width(d), half_width(d + 1)));
    }
    return nodes_;
}

}  // namespace ink

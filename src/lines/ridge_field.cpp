#include "lines/ridge_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "lines/ridge_estimate-inl.h"

namespace ink {

RidgePattern::RidgePattern(int radius, float spacing) {
    // Some fifty points are enough: of a large disc every second node or so, and from there on
    // every other one of those, as on the black squares of a chessboard.
    const int stride = std::max(1, radius / 4);
    const bool sparse = radius >= 5 * stride;
    constexpr double kLeastReach = 2.25;  // for more points than a cubic has coefficients
    const double reach = std::max<double>(radius, kLeastReach);
    for (int j = 0; j <= radius; j += stride) {
        for (int i = 0; i <= radius; i += stride) {
            if ((i == 0 && j == 0) || std::hypot(i, j) > reach) continue;
            if (sparse && (i + j) / stride % 2 != 0) continue;
            points.push_back({i, j, {}});
        }
    }
    std::vector<Vec2f> all{{0, 0}};
    for (const Point& point : points) {
        const Vec2f place{static_cast<float>(point.i) * spacing,
                          static_cast<float>(point.j) * spacing};
        for (const float x : {place.x, -place.x}) {
            for (const float y : {place.y, -place.y}) {
                const bool again = (x == 0.0F && std::signbit(x)) || (y == 0.0F && std::signbit(y));
                if (!again) all.push_back({x, y});
            }
        }
    }
    const RidgeEstimator estimator(all, {});
    std::size_t n = 1;
    for (Point& point : points) {
        point.weights = estimator.weights()[n];
        n += (point.i > 0 ? 2U : 1U) * (point.j > 0 ? 2U : 1U);
    }
}

std::vector<int> RidgePattern::half_widths() const {
    int rows = 0;
    for (const Point& point : points) rows = std::max(rows, point.j);
    std::vector<int> widths(static_cast<std::size_t>(rows) + 1, 0);
    for (const Point& point : points) {
        for (int j = 0; j <= point.j; ++j) {
            int& width = widths[static_cast<std::size_t>(j)];
            width = std::max(width, point.i);
        }
    }
    return widths;
}

namespace {

struct EstimateRows {
    Lanes<float> slope, bend, along_x, along_y, strength;
};

INKTRACE_MULTIVERSION
void estimate_rows(const DerivativeRows& rows, const Lanes<std::int32_t>& wanted,
                   RidgeSettings settings, EstimateRows& __restrict out) {
    for (int i = 0; i < kLanes; ++i) {
        NormalDerivatives d;
        for (std::size_t k = 0; k < d.size(); ++k) {
            d[k] = {rows[k][0][i], rows[k][1][i], rows[k][2][i]};
        }
        const RidgeEstimate estimate = ridge_from(d, settings);
        out.slope[i] = estimate.slope;
        out.bend[i] = estimate.bend;
        out.along_x[i] = estimate.along.x;
        out.along_y[i] = estimate.along.y;
        out.strength[i] = wanted[i] != 0 ? estimate.strength : 0.0F;
    }
}

/// Sixteen bits from bit i on.
std::uint32_t bits_from(const std::vector<NodeBits>& words, int i) {
    const auto k = static_cast<std::size_t>(i / kNodesInWord);
    const int shift = i % kNodesInWord;
    NodeBits bits = words[k] >> shift;
    if (shift > kNodesInWord - kLanes && k + 1 < words.size()) {
        bits |= words[k + 1] << (kNodesInWord - shift);
    }
    return static_cast<std::uint32_t>(bits & ((NodeBits{1} << kLanes) - 1));
}

}  // namespace

RidgeField::RidgeField(const RidgeGrid& grid, const Viewpoint& viewpoint,
                       const RidgePattern& pattern, const RidgeSettings& settings)
    : grid_(grid),
      settings_(settings),
      discs_(grid, viewpoint, pattern.half_widths()),
      columns_(grid.width - 2 * discs_.radius()),
      crossed_down_(words_for(columns_)) {
    for (const RidgePattern::Point& point : pattern.points) {
        const std::ptrdiff_t down = static_cast<std::ptrdiff_t>(point.j) * grid.width;
        std::vector<MirroredPoints>& alike = point.j == 0   ? pattern_.on_x
                                             : point.i == 0 ? pattern_.on_y
                                                            : pattern_.off_axes;
        alike.push_back({{down + point.i, down - point.i}, point.weights});
    }
    for (Row* row : {&upper_, &lower_}) {
        // Sixteen at a time, and one beyond them for the next node of the last one.
        const std::size_t size = static_cast<std::size_t>(columns_) + 2 * kLanes;
        for (auto* plane :
             {&row->slope, &row->bend, &row->along_x, &row->along_y, &row->strength}) {
            plane->resize(size);
        }
        row->crossed.resize(words_for(columns_));
    }
}

void RidgeField::find(int first, int last, std::vector<RidgePiece>& pieces) {
    if (columns_ < 2) return;
    discs_.start(first);
    estimate_row(first, upper_);
    for (int j = first; j < last; ++j) {
        estimate_row(j + 1, lower_);
        cross_rows(upper_.from(0), lower_.from(0), columns_, crossed_down_.data());
        connect_rows(j, pieces);
        std::swap(upper_, lower_);
    }
}

void RidgeField::estimate_row(int j, Row& row) {
    const std::vector<NodeBits>& smooth = discs_.next();
    const std::size_t first = grid_.index(apron(), j);
    bool any = false;
    for (int i = 0; i < columns_; i += kLanes) {
        const auto at = static_cast<std::size_t>(i);
        std::uint32_t wanted = bits_from(smooth, apron() + i);
        if (columns_ - i < kLanes) wanted &= (1U << (columns_ - i)) - 1;
        if (wanted == 0) {
            std::fill_n(row.strength.data() + at, kLanes, 0.0F);
            continue;
        }
        any = true;
        estimate_some(first + at, wanted, row, at);
    }
    if (any) {
        cross_rows(row.from(0), row.from(1), columns_ - 1, row.crossed.data());
    } else {
        std::ranges::fill(row.crossed, NodeBits{0});
    }
}

/// Of sixteen nodes from `first` of the grid on.
void RidgeField::estimate_some(std::size_t first, std::uint32_t wanted, Row& row, std::size_t to) {
    DerivativeRows derivatives;
    differentiate(grid_, first, pattern_, derivatives);
    Lanes<std::int32_t> lanes;
    for (int i = 0; i < kLanes; ++i) lanes[i] = static_cast<std::int32_t>(wanted >> i & 1U);
    EstimateRows rows;
    estimate_rows(derivatives, lanes, settings_, rows);
    std::ranges::copy(rows.slope, row.slope.data() + to);
    std::ranges::copy(rows.bend, row.bend.data() + to);
    std::ranges::copy(rows.along_x, row.along_x.data() + to);
    std::ranges::copy(rows.along_y, row.along_y.data() + to);
    std::ranges::copy(rows.strength, row.strength.data() + to);
}

/// In the cells that a ridge enters on one side and leaves on another.
void RidgeField::connect_rows(int j, std::vector<RidgePiece>& pieces) {
    const std::size_t words = crossed_down_.size();
    for (std::size_t k = 0; k < words; ++k) {
        const NodeBits top = upper_.crossed[k];
        const NodeBits bottom = lower_.crossed[k];
        const NodeBits left = crossed_down_[k];
        const NodeBits right =
            left >> 1U | (k + 1 < words ? crossed_down_[k + 1] << (kNodesInWord - 1) : 0);
        const NodeBits any = top | bottom | left | right;
        const NodeBits all = top & bottom & left & right;
        NodeBits cells = any & ~all & ~(top ^ bottom ^ left ^ right);
        for (; cells != 0; cells &= cells - 1) {
            const int bit = std::countr_zero(cells);
            const auto has = [&](NodeBits sides) {
                return static_cast<std::uint32_t>(sides >> bit & 1U);
            };
            connect_cell(static_cast<int>(k) * kNodesInWord + bit, j,
                         has(top) | has(left) << 1U | has(right) << 2U | has(bottom) << 3U, pieces);
        }
    }
}

void RidgeField::connect_cell(int i, int j, std::uint32_t sides, std::vector<RidgePiece>& pieces) {
    const Crossing a = cross_side(i, j, std::countr_zero(sides));
    const Crossing b = cross_side(i, j, std::bit_width(sides) - 1);
    pieces.push_back(
        {a.point, b.point, 0.5F * (a.strength + b.strength), a.edge / 2, {a.edge, b.edge}});
}

/// Sides of a cell: 0 above, 1 on the left, 2 on the right, 3 below.
RidgeField::Crossing RidgeField::cross_side(int i, int j, int side) const {
    const int left = i + (side == 2 ? 1 : 0);
    const int right = i + (side == 1 ? 0 : 1);
    const Row& from = side == 3 ? lower_ : upper_;
    const Row& to = side == 0 ? upper_ : lower_;
    return cross({from, left, j + (side == 3 ? 1 : 0)}, {to, right, j + (side == 0 ? 0 : 1)});
}

RidgeField::Crossing RidgeField::cross(const Node& a, const Node& b) const {
    const auto m = static_cast<std::size_t>(a.i);
    const auto n = static_cast<std::size_t>(b.i);
    const float turn = a.row.along_x[m] * b.row.along_x[n] + a.row.along_y[m] * b.row.along_y[n];
    const float g = a.row.slope[m];
    const float h = b.row.slope[n] * (turn < 0.0F ? -1.0F : 1.0F);
    const float share = g / (g - h);
    const Vec2f from = grid_.point(a.i + apron(), a.j);
    const Vec2f to = grid_.point(b.i + apron(), b.j);
    const float strength = a.row.strength[m];
    return {from + (to - from) * share, strength + (b.row.strength[n] - strength) * share,
            2 * grid_.index(a.i + apron(), a.j) + (a.j == b.j ? 0U : 1U)};
}

}  // namespace ink

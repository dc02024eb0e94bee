#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "base/bounds.h"
#include "scene/particles.h"

namespace ink {

namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

/// Points sorted into the cells of a grid that has about as many cells as there are points.
class PointGrid {
  public:
    explicit PointGrid(const std::vector<Vec3f>& points) : points_(points) {
        Bounds3f box;
        for (const Vec3f& p : points) box.add(p);
        lower_ = box.lower;
        choose_cells(box.extent());
        begin_.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
        for (const Vec3f& p : points) ++begin_[cell(p) + 1];
        for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
        order_.resize(points.size());
        std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
        for (std::size_t i = 0; i < points.size(); ++i) {
            order_[next[cell(points[i])]++] = static_cast<std::uint32_t>(i);
        }
    }

    /// Distance to the nearest point that is elsewhere, among the cell of `p` and those about it;
    /// infinity where there is none.
    float nearest(Vec3f p) const {
        // More neighbours than any packing has: points lie on one another.
        constexpr std::size_t kMostCandidates = 4096;
        std::size_t looked_at = 0;
        float best = kNone;
        const std::array<std::size_t, 3> home = place(p);
        const auto range = [&](int axis) {
            const std::size_t at = home[static_cast<std::size_t>(axis)];
            const std::size_t last = cells_[static_cast<std::size_t>(axis)] - 1;
            return std::pair{at == 0 ? 0 : at - 1, std::min(at + 1, last)};
        };
        for (std::size_t z = range(2).first; z <= range(2).second; ++z) {
            for (std::size_t y = range(1).first; y <= range(1).second; ++y) {
                for (std::size_t x = range(0).first; x <= range(0).second; ++x) {
                    const std::size_t c = (z * cells_[1] + y) * cells_[0] + x;
                    for (std::uint32_t k = begin_[c]; k < begin_[c + 1]; ++k) {
                        if (++looked_at > kMostCandidates) return best;
                        const float distance = length(points_[order_[k]] - p);
                        if (distance > 0.0F) best = std::min(best, distance);
                    }
                }
            }
        }
        return best;
    }

  private:
    void choose_cells(Vec3f extent) {
        const std::array<float, 3> sides{extent.x, extent.y, extent.z};
        const float longest = *std::ranges::max_element(sides);
        // A plane of particles has cells in two directions only.
        constexpr float kFlat = 1e-4F;
        double volume = 1.0;
        int dimensions = 0;
        for (const float side : sides) {
            if (!(side > kFlat * longest)) continue;
            volume *= side;
            ++dimensions;
        }
        const double count = static_cast<double>(points_.size());
        const double size = dimensions == 0 ? 1.0 : std::pow(volume / count, 1.0 / dimensions);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool flat = !(sides[axis] > kFlat * longest);
            const double cells = flat || !(size > 0.0) ? 1.0 : std::floor(sides[axis] / size);
            cells_[axis] = static_cast<std::size_t>(std::clamp(cells, 1.0, count));
            scale_[axis] = flat ? 0.0 : static_cast<double>(cells_[axis]) / double{sides[axis]};
        }
    }
    std::array<std::size_t, 3> place(Vec3f p) const {
        const Vec3f d = p - lower_;
        const std::array<float, 3> offset{d.x, d.y, d.z};
        std::array<std::size_t, 3> at{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double along = std::max(offset[axis] * scale_[axis], 0.0);
            at[axis] = std::min(static_cast<std::size_t>(along), cells_[axis] - 1);
        }
        return at;
    }
    std::size_t cell(Vec3f p) const {
        const std::array<std::size_t, 3> at = place(p);
        return (at[2] * cells_[1] + at[1]) * cells_[0] + at[0];
    }

    const std::vector<Vec3f>& points_;
    Vec3f lower_;
    std::array<std::size_t, 3> cells_{1, 1, 1};
    std::array<double, 3> scale_{};  ///< cells per length
    std::vector<std::uint32_t> begin_, order_;
};

bool is_placed(Vec3f p) {
    constexpr float kLargest = 1e15F;
    return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;
}

}  // namespace

double touching_radius(const std::vector<Vec3f>& positions) {
    if (!std::ranges::all_of(positions, is_placed)) {
        std::vector<Vec3f> placed;
        std::ranges::copy_if(positions, std::back_inserter(placed), is_placed);
        return touching_radius(placed);
    }
    if (positions.size() < 2) return 0.5;
    const PointGrid grid(positions);
    constexpr std::size_t kSample = 2000;
    const std::size_t step = std::max<std::size_t>(positions.size() / kSample, 1);
    std::vector<float> distances;
    for (std::size_t i = 0; i < positions.size(); i += step) {
        const float distance = grid.nearest(positions[i]);
        if (distance < kNone) distances.push_back(distance);
    }
    if (distances.empty()) {
        Bounds3f box;
        for (const Vec3f& p : positions) box.add(p);
        const float diagonal = length(box.extent());
        return diagonal > 0.0F ? diagonal / 100.0 : 0.5;
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    return *middle / 2.0;
}

}  // namespace ink

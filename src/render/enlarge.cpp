#include "render/enlarge.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/enlarge_rows.h"
#include "render/face_tiling.h"

namespace ink {

namespace {

/// Place of a large picture's column or row among those of the small one, whose centres are at
/// whole numbers.
float place(int at, int large, int small, float factor) {
    const float from_middle = static_cast<float>(at) + 0.5F - 0.5F * static_cast<float>(large);
    return 0.5F * static_cast<float>(small) + from_middle / factor - 0.5F;
}

constexpr std::uint32_t kOne = 256;

/// Which side of a segment's line a point lies on.
float side_of(const Segment& segment, Vec2f point) {
    const Vec2f d = segment.b - segment.a;
    const Vec2f v = point - segment.a;
    return d.x * v.y - d.y * v.x;
}

/// Whether colours change across a line, from one side of its cell to another.
bool divides(const Segment& line) {
    return line.spans_cell && line.type != LineType::mesh && line.type != LineType::ridge;
}

/// A line that colours change across, and on which sides of it the corners of its cell lie.
class DividedCorners {
  public:
    DividedCorners(const Segment& line, const std::array<Vec2f, 4>& corners) : line_(&line) {
        for (std::size_t k = 0; k < 4; ++k) sides_[k] = side_of(line, corners[k]);
    }
    /// Those beyond the line from a point have no weight.
    void drop(Vec2f point, std::array<float, 4>& weights) const {
        const float side = side_of(*line_, point);
        for (std::size_t k = 0; k < 4; ++k) {
            if (side * sides_[k] < 0.0F) weights[k] = 0.0F;
        }
    }

  private:
    const Segment* line_;
    std::array<float, 4> sides_{};
};

/// A pixel of which some corners of its cell count, by their weights.
std::uint32_t mixed(const std::array<std::uint32_t, 4>& corners,
                    const std::array<float, 4>& weights) {
    std::array<float, 4> sum{};
    float all = 0.0F;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto alpha = static_cast<float>(corners[k] >> 24U);
        const float weight = weights[k] * alpha;
        for (unsigned c = 0; c < 3; ++c) {
            sum[c] += weight * static_cast<float>((corners[k] >> (8U * c)) & 0xFFU);
        }
        sum[3] += weight;
        all += weights[k];
    }
    std::uint32_t pixel = static_cast<std::uint32_t>(sum[3] / all + 0.5F) << 24U;
    for (unsigned c = 0; c < 3 && sum[3] > 0.0F; ++c) {
        pixel |= static_cast<std::uint32_t>(sum[c] / sum[3] + 0.5F) << (8U * c);
    }
    return pixel;
}

}  // namespace

Enlargement::Enlargement(Size large, double share)
    : large_(large),
      small_{1, std::clamp(static_cast<int>(std::lround(large.height * share)), 1, large.height)},
      factor_(static_cast<float>(large.height) / static_cast<float>(small_.height)) {
    small_.width =
        std::max(1, static_cast<int>(std::ceil(static_cast<float>(large.width) / factor_ - 1e-4F)));
}

PixelEnlarger::PixelEnlarger(const Enlargement& enlargement, const DisplayImage& pixels)
    : enlargement_(enlargement),
      pixels_(pixels),
      columns_(enlargement.large().width, pixels.size.width, enlargement.factor()),
      rows_(enlargement.large().height, pixels.size.height, enlargement.factor()) {}

PixelEnlarger::Between::Between(int large, int small, float factor) {
    const auto count = static_cast<std::size_t>(large);
    first.reserve(count);
    second.reserve(count);
    share.reserve(count);
    twice.reserve(count);
    for (int k = 0; k < large; ++k) {
        const float at =
            std::clamp(place(k, large, small, factor), 0.0F, static_cast<float>(small - 1));
        first.push_back(static_cast<int>(at));
        second.push_back(std::min(first.back() + 1, small - 1));
        const float of_second = at - static_cast<float>(first.back());
        share.push_back(static_cast<std::uint32_t>(of_second * static_cast<float>(kOne)));
        twice.push_back(share.back() | share.back() << 16U);
    }
}

void PixelEnlarger::enlarge_row(int y, Film& film) const {
    const auto width = static_cast<std::size_t>(pixels_.size.width);
    const auto row = static_cast<std::size_t>(y);
    const std::uint32_t* const pixels = pixels_.pixels.data();
    thread_local std::vector<std::uint32_t> mixed;
    mixed.resize(width + kBeyondRow);
    const auto row_of = [&](const std::vector<std::int32_t>& rows) {
        return std::span(pixels + static_cast<std::size_t>(rows[row]) * width, width);
    };
    mix_rows(row_of(rows_.first), row_of(rows_.second), rows_.share[row], mixed.data());
    std::fill_n(mixed.data() + width, kBeyondRow, mixed[width - 1]);
    mix_columns(mixed.data(), columns_.first, columns_.twice.data(), film.display_row(y).data());
}

void PixelEnlarger::sharpen(const Tile& tile, std::span<const Segment> lines, Film& film,
                            FaceTiling* faces) const {
    const auto cell_of = [](const Segment& s) {
        return std::pair{static_cast<int>(std::floor((s.a.x + s.b.x) * 0.5F - 0.5F)),
                         static_cast<int>(std::floor((s.a.y + s.b.y) * 0.5F - 0.5F))};
    };
    for (std::size_t first = 0; first < lines.size();) {
        const auto cell = cell_of(lines[first]);
        std::size_t last = first + 1;
        while (last < lines.size() && cell_of(lines[last]) == cell) ++last;
        const auto [x, y] = cell;
        if (x >= tile.x0 && x < tile.x1 && y >= tile.y0 && y < tile.y1) {
            sharpen_cell(x, y, lines.subspan(first, last - first), film, faces);
        }
        first = last;
    }
}

void PixelEnlarger::sharpen_cell(int column, int row, std::span<const Segment> lines, Film& film,
                                 FaceTiling* faces) const {
    thread_local std::vector<DividedCorners> dividing;
    dividing.clear();
    const Size size = pixels_.size;
    std::array<std::uint32_t, 4> corners;
    std::array<Vec2f, 4> places;
    for (std::size_t k = 0; k < 4; ++k) {
        const int i = column + static_cast<int>(k % 2);
        const int j = row + static_cast<int>(k / 2);
        places[k] = {static_cast<float>(i) + 0.5F, static_cast<float>(j) + 0.5F};
        corners[k] = pixels_.pixels[static_cast<std::size_t>(std::clamp(j, 0, size.height - 1)) *
                                        static_cast<std::size_t>(size.width) +
                                    static_cast<std::size_t>(std::clamp(i, 0, size.width - 1))];
    }
    for (const Segment& line : lines) {
        if (divides(line)) dividing.emplace_back(line, places);
    }
    if (dividing.empty()) return;
    // Pixels whose centres lie in the cell.
    const Vec2f lower = enlargement_.enlarged(places[0]);
    const Vec2f upper = enlargement_.enlarged(places[3]);
    const auto first_of = [](float at) { return static_cast<int>(std::ceil(at - 0.5F)); };
    const Size large = enlargement_.large();
    for (int y = std::max(first_of(lower.y), 0); y < std::min(first_of(upper.y), large.height);
         ++y) {
        for (int x = std::max(first_of(lower.x), 0); x < std::min(first_of(upper.x), large.width);
             ++x) {
            const Vec2f point =
                enlargement_.shrunk({static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F});
            const float right = point.x - places[0].x;
            const float below = point.y - places[0].y;
            std::array<float, 4> weights{(1 - right) * (1 - below), right * (1 - below),
                                         (1 - right) * below, right * below};
            const auto heaviest = [&] {
                return static_cast<int>(std::ranges::max_element(weights) - weights.begin());
            };
            const int nearest = heaviest();
            for (const DividedCorners& line : dividing) line.drop(point, weights);
            constexpr float kLeast = 1e-3F;
            if (weights[0] + weights[1] + weights[2] + weights[3] < kLeast) continue;
            film.display_row(y)[static_cast<std::size_t>(x)] = mixed(corners, weights);
            if (faces == nullptr) continue;
            const int seen = heaviest();
            if (seen != nearest) faces->look_at(x, y, column + seen % 2, row + seen / 2);
        }
    }
}

}  // namespace ink

#include "render/enlarge.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

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

/// Whether colours change across a line, from one side of its cell to another.
bool divides(const Segment& line) {
    return line.spans_cell && line.type != LineType::mesh && line.type != LineType::ridge;
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
    thread_local std::vector<DividingLine> dividing;
    dividing.clear();
    const CellCorners corners = corners_of(column, row);
    for (const Segment& line : lines) {
        if (divides(line)) dividing.emplace_back(line, corners);
    }
    if (dividing.empty()) return;
    // Pixels whose centres lie in the cell.
    const Vec2f lower = enlargement_.enlarged(corners.places[0]);
    const Vec2f upper = enlargement_.enlarged(corners.places[3]);
    const auto first_of = [](float at) { return static_cast<int>(std::ceil(at - 0.5F)); };
    const Size large = enlargement_.large();
    const Tile cell{std::max(first_of(lower.x), 0), std::max(first_of(lower.y), 0),
                    std::min(first_of(upper.x), large.width),
                    std::min(first_of(upper.y), large.height)};
    MixedPixels mixed;
    for (int y = cell.y0; y < cell.y1; y += kBlockSide) {
        for (int x = cell.x0; x < cell.x1; x += kBlockSide) {
            const auto [at_x, at_y] = shrunk_block(x, y);
            mix_corners(corners, dividing, at_x, at_y, mixed);
            for (; mixed.known != 0; mixed.known &= mixed.known - 1) {
                const int i = std::countr_zero(mixed.known);
                const int px = x + i % kBlockSide;
                const int py = y + i / kBlockSide;
                if (px >= cell.x1 || py >= cell.y1) continue;
                film.display_row(py)[static_cast<std::size_t>(px)] = mixed.pixels[i];
                if (faces == nullptr || mixed.seen[i] == mixed.nearest[i]) continue;
                faces->look_at(px, py, column + mixed.seen[i] % 2, row + mixed.seen[i] / 2);
            }
        }
    }
}

CellCorners PixelEnlarger::corners_of(int column, int row) const {
    CellCorners corners;
    const Size size = pixels_.size;
    for (std::size_t k = 0; k < 4; ++k) {
        const int i = column + static_cast<int>(k % 2);
        const int j = row + static_cast<int>(k / 2);
        corners.places[k] = {static_cast<float>(i) + 0.5F, static_cast<float>(j) + 0.5F};
        corners.pixels[k] =
            pixels_.pixels[static_cast<std::size_t>(std::clamp(j, 0, size.height - 1)) *
                               static_cast<std::size_t>(size.width) +
                           static_cast<std::size_t>(std::clamp(i, 0, size.width - 1))];
    }
    return corners;
}

/// Where the centres of 4 x 4 pixels of the large picture lie in the small one.
std::pair<Lanes<float>, Lanes<float>> PixelEnlarger::shrunk_block(int x, int y) const {
    std::pair<Lanes<float>, Lanes<float>> places;
    for (int i = 0; i < kLanes; ++i) {
        const Vec2f point = enlargement_.shrunk({static_cast<float>(x + i % kBlockSide) + 0.5F,
                                                 static_cast<float>(y + i / kBlockSide) + 0.5F});
        places.first[i] = point.x;
        places.second[i] = point.y;
    }
    return places;
}

}  // namespace ink

#include "render/edge_smoothing.h"

#include <algorithm>
#include <cmath>

#include <hwy/highway.h>

namespace ink {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Four lanes are what every processor has.
using FourLanes = hn::FixedTag<float, 4>;
using Four = hn::Vec<FourLanes>;
constexpr FourLanes kFour;
constexpr hn::FixedTag<std::int32_t, 4> kFourIntegers;

Four set(float value) { return hn::Set(kFour, value); }

/// square_coverage (lines/coverage.h) of four squares.
Four covered(Four inside, Vec2f normal) {
    const float wide = std::max(std::abs(normal.x), std::abs(normal.y));
    const float narrow = std::min(std::abs(normal.x), std::abs(normal.y));
    const Four reach = set(0.5F * (wide + narrow));
    const Four off = hn::Min(hn::Abs(inside), reach);
    const Four rest = hn::Sub(reach, off);
    const Four flat = hn::Sub(set(0.5F), hn::Mul(off, set(1.0F / wide)));
    const Four corner =
        hn::Mul(hn::Mul(rest, rest), set(1.0F / (2.0F * std::max(wide * narrow, 1e-6F))));
    const Four outer = hn::IfThenElse(hn::Le(off, set(0.5F * (wide - narrow))), flat, corner);
    return hn::IfThenElse(hn::Ge(inside, set(0.0F)), hn::Sub(set(1.0F), outer), outer);
}

constexpr float kFixedPoint = 1 << 22;
constexpr float kMostChange = 64.0F;

int floor_divide(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

bool is_zero(const ColorShift& shift) { return (shift[0] | shift[1] | shift[2] | shift[3]) == 0; }

void add_to(ColorShift& sum, const ColorShift& shift) {
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += shift[c];
}

float shifted(float value, std::int32_t shift, float most) {
    return std::min(std::max(value + static_cast<float>(shift) * (1.0F / kFixedPoint), 0.0F), most);
}

}  // namespace

void EdgeSmoothing::begin(const Tile& tile) {
    tile_ = tile;
    // Cells reach over pixels to the right and below.
    const auto blocks = [](int pixels) {
        return static_cast<std::size_t>((pixels + kBlockSide) / kBlockSide);
    };
    across_ = blocks(tile.x1 - tile.x0);
    const std::size_t size = across_ * blocks(tile.y1 - tile.y0);
    shifts_.resize(size);
    touched_.assign(size, 0);
    any_ = false;
}

void EdgeSmoothing::add(const Segment& segment, const PixelColor& left, const PixelColor& right) {
    // The four corners of the cell side by side, then the four channels of each.
    const auto change =
        hn::Clamp(hn::Sub(hn::LoadU(kFour, right.data()), hn::LoadU(kFour, left.data())),
                  set(-kMostChange), set(kMostChange));
    if (hn::AllTrue(kFour, hn::Eq(change, set(0.0F)))) return;
    const Vec2f d = segment.b - segment.a;
    const float length = std::sqrt(d.x * d.x + d.y * d.y);
    if (length == 0.0F) return;
    const auto q = static_cast<float>(q_);
    // Towards the segment's left: see Segment.
    const Vec2f normal{d.y / length, -d.x / length};
    const Vec2f middle = (segment.a + segment.b) * 0.5F;
    const auto cell_x = static_cast<int>(std::floor(middle.x * q - 0.5F));
    const auto cell_y = static_cast<int>(std::floor(middle.y * q - 0.5F));

    alignas(16) constexpr std::array<float, 4> kX{0.0F, 1.0F, 0.0F, 1.0F};
    alignas(16) constexpr std::array<float, 4> kY{0.0F, 0.0F, 1.0F, 1.0F};
    const float spacing = 1.0F / q;
    const auto to_left = [&](Four x, Four y) {
        return hn::Add(hn::Mul(hn::Sub(x, set(segment.a.x)), set(normal.x)),
                       hn::Mul(hn::Sub(y, set(segment.a.y)), set(normal.y)));
    };
    // A place in the cell, in spacings from its first corner.
    const auto place = [&](int cell, Four inside) {
        return hn::Mul(hn::Add(set(static_cast<float>(cell) + 0.5F), inside), set(spacing));
    };
    const Four x = hn::Load(kFour, kX.data());
    const Four y = hn::Load(kFour, kY.data());
    const auto on_left = hn::Gt(to_left(place(cell_x, x), place(cell_y, y)), set(0.0F));
    const auto quarter = [&](Four corner) {  // its middle
        return hn::Add(hn::Mul(corner, set(0.5F)), set(0.25F));
    };
    // In units of the quarter's side.
    const Four inside =
        hn::Mul(to_left(place(cell_x, quarter(x)), place(cell_y, quarter(y))), set(2.0F * q));
    const Four beyond = covered(hn::IfThenElse(on_left, hn::Neg(inside), inside), normal);
    // Towards the right side's colour for corners on the left, and back.
    const Four area = hn::Mul(beyond, set(0.25F / (q * q) * kFixedPoint));
    alignas(16) std::array<float, 4> scale;
    hn::Store(hn::IfThenElse(on_left, area, hn::Neg(area)), kFour, scale.data());

    for (int corner = 0; corner < 4; ++corner) {
        const auto n = static_cast<std::size_t>(corner);
        if (scale[n] == 0.0F) continue;
        const int i = cell_x + corner % 2;
        const int j = cell_y + corner / 2;
        const int pixel_x = (q_ == 1 ? i : floor_divide(i, q_)) - tile_.x0;
        const int pixel_y = (q_ == 1 ? j : floor_divide(j, q_)) - tile_.y0;
        if (pixel_x < 0 || pixel_y < 0 || pixel_x > tile_.x1 - tile_.x0 ||
            pixel_y > tile_.y1 - tile_.y0) {
            continue;
        }
        std::int32_t* const sum = shift_of(pixel_x, pixel_y).data();
        const auto added = hn::ConvertTo(
            kFourIntegers, hn::Floor(hn::Add(hn::Mul(change, set(scale[n])), set(0.5F))));
        hn::StoreU(hn::Add(hn::LoadU(kFourIntegers, sum), added), kFourIntegers, sum);
    }
}

/// Of a pixel, by its place in the tile, for what adds to it.
ColorShift& EdgeSmoothing::shift_of(int x, int y) {
    const auto column = static_cast<unsigned>(x);
    const auto row = static_cast<unsigned>(y);
    const std::size_t k = row / kBlockSide * across_ + column / kBlockSide;
    if (touched_[k] == 0) {
        touched_[k] = 1;
        shifts_[k] = {};
        any_ = true;
    }
    return shifts_[k][row % kBlockSide * kBlockSide + column % kBlockSide];
}

void EdgeSmoothing::apply(int x, int y, ColorPacket& colors) const {
    const ShiftBlock& shifts = shifts_[block(x, y)];
    const int first_row = y == tile_.y0 ? 1 : 0;
    const int first_column = x == tile_.x0 ? 1 : 0;
    for (int lane = 0; lane < kLanes; ++lane) {
        const ColorShift& shift = shifts[static_cast<std::size_t>(lane)];
        if (lane / kBlockSide < first_row || lane % kBlockSide < first_column || is_zero(shift)) {
            continue;
        }
        colors.r[lane] = shifted(colors.r[lane], shift[0], kInfinity);
        colors.g[lane] = shifted(colors.g[lane], shift[1], kInfinity);
        colors.b[lane] = shifted(colors.b[lane], shift[2], kInfinity);
        colors.a[lane] = shifted(colors.a[lane], shift[3], 1.0F);
    }
}

ColorShift EdgeSmoothing::shift_at(int x, int y) const {
    const std::size_t k = block(x, y);
    if (touched_[k] == 0) return {};
    const int lane = (y - tile_.y0) % kBlockSide * kBlockSide + (x - tile_.x0) % kBlockSide;
    return shifts_[k][static_cast<std::size_t>(lane)];
}

void EdgeSmoothing::take_fringe(Fringe& fringe) const {
    if (!any_) return;
    for (int x = tile_.x0; x < tile_.x1; ++x) fringe.own.push_back(shift_at(x, tile_.y0));
    for (int y = tile_.y0 + 1; y < tile_.y1; ++y) fringe.own.push_back(shift_at(tile_.x0, y));
    for (int y = tile_.y0; y < tile_.y1; ++y) fringe.right.push_back(shift_at(tile_.x1, y));
    for (int x = tile_.x0; x <= tile_.x1; ++x) fringe.below.push_back(shift_at(x, tile_.y1));
}

void finish_fringe(std::span<const Tile> tiles, const std::vector<const Fringe*>& fringes,
                   std::size_t across, std::size_t index, const PixelColor& background,
                   Film& film) {
    const Tile& tile = tiles[index];
    const Fringe& fringe = *fringes[index];
    const auto neighbour = [&](bool left, bool above) -> const Fringe* {
        if ((left && index % across == 0) || (above && index < across)) return nullptr;
        return fringes[index - (left ? 1 : 0) - (above ? across : 0)];
    };
    const Fringe* const left = neighbour(true, false);
    const Fringe* const above = neighbour(false, true);
    const Fringe* const corner = neighbour(true, true);
    const auto width = static_cast<std::size_t>(tile.x1 - tile.x0);
    const auto finish = [&](std::size_t k, int x, int y) {
        if (x < 0 || y < 0 || x >= film.size().width || y >= film.size().height) return;
        ColorShift sum{};
        const auto column = static_cast<std::size_t>(x - tile.x0);
        const auto row = static_cast<std::size_t>(y - tile.y0);
        if (!fringe.own.empty()) add_to(sum, fringe.own[k]);
        if (column == 0 && left != nullptr && !left->right.empty()) add_to(sum, left->right[row]);
        if (row == 0 && above != nullptr && !above->below.empty()) {
            add_to(sum, above->below[column]);
        }
        if (row == 0 && column == 0 && corner != nullptr && !corner->below.empty()) {
            add_to(sum, corner->below.back());
        }
        if (is_zero(sum)) return;
        PixelColor color = fringe.colors.empty() ? background : fringe.colors[k];
        for (std::size_t c = 0; c < color.size(); ++c) {
            color[c] = shifted(color[c], sum[c], c == 3 ? 1.0F : kInfinity);
        }
        film.put_pixel(x, y, color);
    };
    for (int x = tile.x0; x < tile.x1; ++x) {
        finish(static_cast<std::size_t>(x - tile.x0), x, tile.y0);
    }
    for (int y = tile.y0 + 1; y < tile.y1; ++y) {
        finish(width + static_cast<std::size_t>(y - tile.y0 - 1), tile.x0, y);
    }
}

}  // namespace ink

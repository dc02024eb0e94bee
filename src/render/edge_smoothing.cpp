#include "render/edge_smoothing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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

int floor_divide(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

/// Of a pixel on the fringe that no line may change.
constexpr ColorShift kLeft{std::numeric_limits<std::int32_t>::min(), 0, 0, 0};

bool is_zero(const ColorShift& shift) { return (shift[0] | shift[1] | shift[2] | shift[3]) == 0; }

void add_to(ColorShift& sum, const ColorShift& shift) {
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += shift[c];
}

float shifted(float value, std::int32_t shift, float most) {
    return std::min(std::max(value + static_cast<float>(shift) * (1.0F / kShiftScale), 0.0F), most);
}

}  // namespace

void EdgeSmoothing::begin(const Tile& tile) {
    clear_touched();
    tile_ = tile;
    // Cells reach over pixels to the right and below.
    const auto blocks = [](int pixels) {
        return static_cast<std::size_t>((pixels + kBlockSide) / kBlockSide);
    };
    across_ = blocks(tile.x1 - tile.x0);
    stride_ = across_ * kBlockSide;
    const std::size_t size = across_ * blocks(tile.y1 - tile.y0);
    if (shifts_.size() < size * kLanes) shifts_.resize(size * kLanes);
    touched_.assign(size, 0);
    any_ = false;
    waiting_ = 0;
}

void EdgeSmoothing::clear_touched() {
    if (!any_) return;
    for (std::size_t k = 0; k < touched_.size(); ++k) {
        if (touched_[k] == 0) continue;
        ColorShift* row =
            shifts_.data() + k / across_ * kBlockSide * stride_ + k % across_ * kBlockSide;
        for (int j = 0; j < kBlockSide; ++j, row += stride_)
            std::fill_n(row, kBlockSide, ColorShift{});
    }
}

void EdgeSmoothing::finish() {
    if (waiting_ == 0) return;
    find_corner_shares(ends_, q_, shares_);
    std::uint32_t left = (1U << waiting_) - 1;
    if (q_ == 1) {
        any_ = true;
        left = spread_shares(shares_, changes_, waiting_,
                             {shifts_.data(), stride_, touched_.data(), across_, tile_.x0, tile_.y0,
                              tile_.x1 - tile_.x0, tile_.y1 - tile_.y0});
    }
    for (; left != 0; left &= left - 1) spread_beyond(std::countr_zero(left));
    waiting_ = 0;
}

/// Adds one of the waiting segments' colour changes to the pixels at the corners of its cell, which
/// may lie beyond the tile's border: towards the right side's colour for corners on the left, and
/// back.
void EdgeSmoothing::spread_beyond(int k) {
    const PixelColor& change = changes_[static_cast<std::size_t>(k)];
    for (int corner = 0; corner < 4; ++corner) {
        const int x = floor_divide(shares_.cell_x[k] + corner % 2, q_) - tile_.x0;
        const int y = floor_divide(shares_.cell_y[k] + corner / 2, q_) - tile_.y0;
        if (x < 0 || y < 0 || x > tile_.x1 - tile_.x0 || y > tile_.y1 - tile_.y0) continue;
        const float share = shares_.area[static_cast<std::size_t>(corner)][k] * kShiftScale;
        ColorShift& sum = shifts_[pixel(x, y)];
        for (std::size_t c = 0; c < sum.size(); ++c) {
            sum[c] += static_cast<std::int32_t>(std::floor(change[c] * share + 0.5F));
        }
        touch(x, y);
        any_ = true;
    }
}

void EdgeSmoothing::leave(int i, int j) {
    const int column = floor_divide(i, q_) - tile_.x0;
    const int row = floor_divide(j, q_) - tile_.y0;
    if (column < 0 || row < 0 || column >= tile_.x1 - tile_.x0 || row >= tile_.y1 - tile_.y0)
        return;
    touch(column, row);
    any_ = true;
    // Other tiles may add to the fringe.
    shifts_[pixel(column, row)] = column == 0 || row == 0 ? kLeft : ColorShift{};
}

void EdgeSmoothing::apply(int x, int y, ColorPacket& colors) const {
    const ColorShift* const shifts = shifts_.data() + pixel(x - tile_.x0, y - tile_.y0);
    const auto inside =
        hn::Gt(hn::Iota(kFourIntegers, 0), hn::Set(kFourIntegers, x == tile_.x0 ? 0 : -1));
    for (int row = y == tile_.y0 ? 1 : 0; row < kBlockSide; ++row) {
        const auto first = static_cast<std::size_t>(row * kBlockSide);
        // Four pixels of four channels into four channels of four pixels.
        const auto load = [&](std::size_t pixel) {
            const auto line = static_cast<std::size_t>(row) * stride_;
            return hn::LoadU(kFourIntegers, shifts[line + pixel].data());
        };
        const auto lower = [&](std::size_t pixel) {
            return hn::InterleaveLower(kFourIntegers, load(pixel), load(pixel + 1));
        };
        const auto upper = [&](std::size_t pixel) {
            return hn::InterleaveUpper(kFourIntegers, load(pixel), load(pixel + 1));
        };
        const auto shift = [&](Lanes<float>& channel, auto by, float most) {
            float* const values = channel.data() + first;
            const auto change = hn::Mul(hn::ConvertTo(kFour, hn::IfThenElseZero(inside, by)),
                                        set(1.0F / kShiftScale));
            const auto sum = hn::Add(hn::Load(kFour, values), change);
            hn::Store(hn::Min(hn::Max(sum, set(0.0F)), set(most)), kFour, values);
        };
        const auto rg01 = lower(0);
        const auto rg23 = lower(2);
        const auto ba01 = upper(0);
        const auto ba23 = upper(2);
        shift(colors.r, hn::ConcatLowerLower(kFourIntegers, rg23, rg01), kInfinity);
        shift(colors.g, hn::ConcatUpperUpper(kFourIntegers, rg23, rg01), kInfinity);
        shift(colors.b, hn::ConcatLowerLower(kFourIntegers, ba23, ba01), kInfinity);
        shift(colors.a, hn::ConcatUpperUpper(kFourIntegers, ba23, ba01), 1.0F);
    }
}

void EdgeSmoothing::copy_fringe(Fringe& fringe) const {
    if (!any_) return;
    const int width = tile_.x1 - tile_.x0;
    const int height = tile_.y1 - tile_.y0;
    const auto row = [&](int y, int count, std::vector<ColorShift>& to) {
        to.insert(to.end(), &shifts_[pixel(0, y)], &shifts_[pixel(0, y)] + count);
    };
    const auto column = [&](int x, int first, std::vector<ColorShift>& to) {
        for (int y = first; y < height; ++y) to.push_back(shifts_[pixel(x, y)]);
    };
    fringe.own.reserve(static_cast<std::size_t>(width + height - 1));
    row(0, width, fringe.own);
    column(0, 1, fringe.own);
    fringe.right.reserve(static_cast<std::size_t>(height));
    column(width, 0, fringe.right);
    row(height, width + 1, fringe.below);
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
        if (!fringe.own.empty()) {
            if (fringe.own[k] == kLeft) return;
            add_to(sum, fringe.own[k]);
        }
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

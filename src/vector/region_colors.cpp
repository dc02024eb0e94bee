#include "vector/region_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/color.h"
#include "base/parallel.h"

namespace ink {

namespace {

/// Pixels [x0, x1) of a row.
struct Run {
    int y;
    int x0;
    int x1;
};

/// The pixels whose centres a region covers, row by row.
class RegionPixels {
  public:
    explicit RegionPixels(Size size) : size_(size) {}

    void cover(const Region& region);
    /// By rows, then columns.
    std::span<const Run> runs() const { return runs_; }
    /// Those with eight neighbours that are covered as well, on which no other region has a share.
    std::vector<Run> inner_runs() const;

  private:
    void add_edge(Vec2d a, Vec2d b);
    void add_outline(const Curve& outline);

    struct Hit {
        int y;
        double x;
    };
    Size size_;
    std::vector<Hit> hits_;  ///< where outlines cross the middle of a row
    std::vector<Run> runs_;
};

void RegionPixels::add_edge(Vec2d a, Vec2d b) {
    const Vec2d top = a.y < b.y ? a : b;
    const Vec2d bottom = a.y < b.y ? b : a;
    const int first = std::max(static_cast<int>(std::ceil(top.y - 0.5)), 0);
    const int last = std::min(static_cast<int>(std::ceil(bottom.y - 0.5)), size_.height);
    for (int y = first; y < last; ++y) {
        const double share = (y + 0.5 - top.y) / (bottom.y - top.y);
        hits_.push_back({y, top.x + (bottom.x - top.x) * share});
    }
}

void RegionPixels::add_outline(const Curve& outline) {
    constexpr double kStep = 2.0;  // pixels, over which a curve is as good as straight
    Vec2f start = outline.start;
    for (const CurvePiece& piece : outline.pieces) {
        const double size = static_cast<double>(length(piece.control1 - start) +
                                                length(piece.control2 - piece.control1) +
                                                length(piece.end - piece.control2));
        const int steps = piece.straight ? 1 : std::clamp(static_cast<int>(size / kStep), 2, 64);
        Vec2d at = to_double(start);
        for (int k = 1; k <= steps; ++k) {
            const Vec2d next = k == steps ? to_double(piece.end)
                                          : point_at(start, piece, static_cast<double>(k) / steps);
            add_edge(at, next);
            at = next;
        }
        start = piece.end;
    }
}

void RegionPixels::cover(const Region& region) {
    hits_.clear();
    runs_.clear();
    for (const Curve& outline : region.outlines) add_outline(outline);
    std::ranges::sort(
        hits_, [](const Hit& a, const Hit& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    for (std::size_t k = 0; k + 1 < hits_.size(); k += 2) {
        const auto column = [&](double x) {
            return static_cast<int>(std::ceil(std::clamp(x - 0.5, 0.0, double{65536.0})));
        };
        const int first = column(hits_[k].x);
        const int last = std::min(column(hits_[k + 1].x), size_.width);
        if (hits_[k].y == hits_[k + 1].y && first < last)
            runs_.push_back({hits_[k].y, first, last});
    }
}

std::vector<Run> RegionPixels::inner_runs() const {
    const auto row = [&](int y) { return std::ranges::equal_range(runs_, y, {}, &Run::y); };
    std::vector<Run> inner;
    for (const Run& run : runs_) {
        for (const Run& above : row(run.y - 1)) {
            for (const Run& below : row(run.y + 1)) {
                const int x0 = std::max({run.x0, above.x0, below.x0}) + 1;
                const int x1 = std::min({run.x1, above.x1, below.x1}) - 1;
                if (x0 < x1) inner.push_back({run.y, x0, x1});
            }
        }
    }
    return inner;
}

std::array<float, 256> decoding_table() {
    std::array<float, 256> table{};
    for (std::size_t k = 0; k < table.size(); ++k) {
        table[k] = srgb_decode(static_cast<float>(k) / 255.0F);
    }
    return table;
}

std::uint8_t encode(double linear) {
    return static_cast<std::uint8_t>(std::lround(srgb_encode(static_cast<float>(linear)) * 255.0F));
}

/// A mean of pixels in linear light, weighted by alpha.
struct MeanColor {
    const std::array<float, 256>& decode;
    std::array<double, 3> sum{};
    double weight = 0.0;

    void add(std::uint32_t pixel) {
        const double alpha = (pixel >> 24U) / 255.0;
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += alpha * static_cast<double>(decode[pixel >> (8U * c) & 255U]);
        }
        weight += alpha;
    }
    Rgb8 color() const {
        const double scale = weight > 0.0 ? 1.0 / weight : 0.0;
        return {encode(sum[0] * scale), encode(sum[1] * scale), encode(sum[2] * scale)};
    }
};

}  // namespace

void color_regions(std::span<Region> regions, const DisplayImage& image, int threads) {
    static const std::array<float, 256> kDecode = decoding_table();
    if (image.pixels.empty()) return;
    const auto pixel = [&](int x, int y) {
        return image
            .pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size.width) +
                    static_cast<std::size_t>(x)];
    };
    constexpr std::size_t kGrain = 64;
    parallel_for(
        (regions.size() + kGrain - 1) / kGrain, threads, [&](std::size_t group, std::size_t) {
            RegionPixels pixels(image.size);
            const std::size_t end = std::min(regions.size(), (group + 1) * kGrain);
            for (std::size_t k = group * kGrain; k < end; ++k) {
                Region& region = regions[k];
                MeanColor mean{kDecode};
                const auto add = [&](std::span<const Run> runs) {
                    for (const Run& run : runs) {
                        for (int x = run.x0; x < run.x1; ++x) mean.add(pixel(x, run.y));
                    }
                };
                pixels.cover(region);
                add(pixels.inner_runs());
                if (mean.weight == 0.0) add(pixels.runs());
                if (mean.weight == 0.0 && !region.outlines.empty()) {
                    const Vec2f at = region.outlines.front().start;
                    mean.add(pixel(std::clamp(static_cast<int>(at.x), 0, image.size.width - 1),
                                   std::clamp(static_cast<int>(at.y), 0, image.size.height - 1)));
                }
                region.color = mean.color();
            }
        });
}

}  // namespace ink

#include "lines/ink.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "lines/coverage.h"

namespace ink {

namespace {

constexpr int kProfileEntries = 512;

/// The lines between a mesh's faces run up to its outline, and in front of it where the surface
/// turns away. Taking them to lie this much farther behind, in a scene of size 1, keeps them below
/// the outline, and above what is well behind.
constexpr float kMeshBehind = 0.1F;

/// A segment made ready for the loop over pixels.
struct Stroke {
    Vec2f a, along;  ///< start and unit direction
    float length, half, strength, t;
    const float* profile;  ///< null: solid
};

/// A band this wide reaches beyond every pixel that its far edge could cut.
constexpr float kWideHalf = 0.7072F;

/// Pixels of a row that are drawn at once. Segments are short.
constexpr int kRun = 8;

/// Pixels of a row, from the one whose centre is (x, y) on. What a pixel gets does not depend on
/// where the run begins. Round ends fall off as the band does across: exactly so where the line
/// goes on, nearly straight, and by less than 1/16 of a pixel elsewhere; so no end claims more than
/// the band, or it would widen the lines that go on from it.
template <bool kWide>
INKTRACE_INLINE void draw_run(const Stroke& stroke, const SquareCoverage& band, float x, float y,
                              float* coverage, float* t) {
    const auto [a, along, length, half, strength, stroke_t, profile] = stroke;
    const float ry = y - a.y;
    // Copies, which the compiler knows to be apart.
    std::array<float, kRun> most;
    std::array<float, kRun> nearest;
    std::copy_n(coverage, kRun, most.data());
    std::copy_n(t, kRun, nearest.data());
    for (std::size_t i = 0; i < kRun; ++i) {
        const float rx = (x + static_cast<float>(i)) - a.x;
        const float s = rx * along.x + ry * along.y;
        const float across = ry * along.x - rx * along.y;
        const float beyond = std::max(std::max(-s, s - length), 0.0F);
        const float distance = std::sqrt(across * across + beyond * beyond);
        const float area =
            kWide ? band(half - distance) : band(half - distance) - band(-half - distance);
        const float ink = area * strength;
        most[i] = std::max(most[i], ink);
        nearest[i] = std::min(nearest[i], ink > 0.0F ? stroke_t : kInfinity);
    }
    std::copy_n(most.data(), kRun, coverage);
    std::copy_n(nearest.data(), kRun, t);
}

/// What a stroke may reach of the tile: pixels [left, right] x [top, bottom].
struct Reach {
    int left, right, top, bottom;
};

/// Draws on the rows of a tile whose upper left pixel has its centre at (x0, y0); `stride` is the
/// length of a row in `coverage` and `t`.
INKTRACE_MULTIVERSION
void draw_solid(const Stroke& stroke, const Reach& reach, float x0, float y0, std::size_t stride,
                float* coverage, float* t) {
    const auto [a, along, length, half, strength, stroke_t, profile] = stroke;
    const SquareCoverage band(along.y, along.x);
    // Along a row the band takes this much to either side of its middle.
    const float steep = std::abs(along.y);
    const float drift = steep > 0.05F ? along.x / along.y : 0.0F;
    const float side = steep > 0.05F ? (half + 0.75F) / steep : kInfinity;
    for (int row = reach.top; row <= reach.bottom; ++row) {
        const float y = y0 + static_cast<float>(row);
        const float middle = a.x + (y - a.y) * drift - x0;
        const int first = static_cast<int>(std::max(middle - side, static_cast<float>(reach.left)));
        const int last = static_cast<int>(std::min(middle + side, static_cast<float>(reach.right)));
        const std::size_t k = static_cast<std::size_t>(row) * stride;
        for (int i = first; i <= last; i += kRun) {
            const float x = x0 + static_cast<float>(i);
            const std::size_t n = k + static_cast<std::size_t>(i);
            if (half >= kWideHalf) {
                draw_run<true>(stroke, band, x, y, coverage + n, t + n);
            } else {
                draw_run<false>(stroke, band, x, y, coverage + n, t + n);
            }
        }
    }
}

INKTRACE_MULTIVERSION
void cover(const Lanes<float>& distance, const Lanes<float>& nx, const Lanes<float>& ny, float half,
           Lanes<float>& inks) {
    for (int i = 0; i < kLanes; ++i) {
        const float near = std::min(distance[i], 1e6F);
        inks[i] = band_coverage(near, half, nx[i], ny[i]);
    }
}

void draw_soft(const Stroke& stroke, const Reach& reach, float x0, float y0, std::size_t stride,
               float* coverage, float* t) {
    for (int row = reach.top; row <= reach.bottom; ++row) {
        for (int column = reach.left; column <= reach.right; ++column) {
            const float rx = x0 + static_cast<float>(column) - stroke.a.x;
            const float ry = y0 + static_cast<float>(row) - stroke.a.y;
            const float s =
                std::clamp(rx * stroke.along.x + ry * stroke.along.y, 0.0F, stroke.length);
            const float u =
                std::hypot(rx - s * stroke.along.x, ry - s * stroke.along.y) / stroke.half;
            if (u >= 1.0F) continue;
            const std::size_t k =
                static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column);
            const float ink =
                stroke.profile[static_cast<int>(u * kProfileEntries)] * stroke.strength;
            t[k] = std::min(t[k], stroke.t);
            coverage[k] = std::max(coverage[k], ink);
        }
    }
}

Stroke make_stroke(const Segment& segment, float width, const float* profile) {
    const Vec2f d = segment.b - segment.a;
    const float length = std::sqrt(d.x * d.x + d.y * d.y);
    const Vec2f along = length > 0.0F ? d * (1.0F / length) : Vec2f{1.0F, 0.0F};
    const float t = segment.t + (segment.type == LineType::mesh ? kMeshBehind : 0.0F);
    return {segment.a, along, length, 0.5F * width, segment.strength, t, profile};
}

}  // namespace

float InkSettings::widest() const {
    float widest = 0.0F;
    for (const LineStyle& style : styles) widest = std::max(widest, style.width_px);
    return widest;
}

float InkSettings::reach() const {
    return 0.5F * widest() + 0.75F;  // half a pixel's diagonal
}

InkTile::InkTile(const InkSettings& settings) : settings_(settings) {
    for (const LineStyle& style : settings.styles) {
        const auto found = std::ranges::find_if(layers_, [&](const Layer& layer) {
            return layer.color == style.color && layer.opacity == style.opacity;
        });
        layer_of_style_.push_back(static_cast<std::size_t>(found - layers_.begin()));
        if (found == layers_.end()) layers_.push_back({style.color, style.opacity, false, {}, {}});
    }
    if (settings.profile.kind == Metric::Kind::solid) return;
    for (int k = 0; k < kProfileEntries; ++k) {
        profile_.push_back(straight_edge_strength(settings.profile, (k + 0.5) / kProfileEntries));
    }
}

void InkTile::begin(int x0, int y0, int width, int height) {
    x0_ = x0;
    y0_ = y0;
    width_ = width;
    height_ = height;
    // Whole runs, and one more, which loops may write to.
    stride_ = (width + kLanes - 1) / kLanes * kLanes + kLanes;
    touched_.assign(plane_size() / kLanes, 0);
    for (Layer& layer : layers_) layer.used = false;
    empty_ = true;
}

void InkTile::draw(const Segment& segment, std::size_t style, float width_scale) {
    const float width = settings_.styles[style].width_px * width_scale;
    const float reach = 0.5F * width + 0.75F;
    const auto first = [&](float a, float b, int origin) {
        return std::max(static_cast<int>(std::floor(std::min(a, b) - reach)) - origin, 0);
    };
    const auto last = [&](float a, float b, int origin, int size) {
        return std::min(static_cast<int>(std::floor(std::max(a, b) + reach)) - origin, size - 1);
    };
    const Reach pixels{
        first(segment.a.x, segment.b.x, x0_), last(segment.a.x, segment.b.x, x0_, width_),
        first(segment.a.y, segment.b.y, y0_), last(segment.a.y, segment.b.y, y0_, height_)};
    if (pixels.left > pixels.right || pixels.top > pixels.bottom) return;

    Layer& layer = layer_of(style);
    const Stroke stroke = make_stroke(segment, width, profile_.empty() ? nullptr : profile_.data());
    for (int y = pixels.top; y <= pixels.bottom; ++y) {
        for (int x = pixels.left; x <= pixels.right; x += kLanes) touch(x, y);
        touch(pixels.right, y);
    }
    (profile_.empty() ? draw_solid : draw_soft)(
        stroke, pixels, static_cast<float>(x0_) + 0.5F, static_cast<float>(y0_) + 0.5F,
        static_cast<std::size_t>(stride_), layer.coverage.data(), layer.t.data());
}

InkTile::Layer& InkTile::layer_of(std::size_t style) {
    Layer& layer = layers_[layer_of_style_[style]];
    if (!layer.used) {
        layer.coverage.assign(plane_size(), 0.0F);
        layer.t.assign(plane_size(), kInfinity);
        layer.used = true;
        empty_ = false;
    }
    return layer;
}

void InkTile::draw_faces(int x, int y, const Lanes<float>& distance, const Lanes<float>& nx,
                         const Lanes<float>& ny, const Lanes<float>& t, std::size_t style,
                         float width) {
    Layer& layer = layer_of(style);
    Lanes<float> inks;
    if (profile_.empty()) {
        cover(distance, nx, ny, 0.5F * width, inks);
    } else {
        for (int i = 0; i < kLanes; ++i) {
            const float u = distance[i] / (0.5F * width);
            inks[i] = u < 1.0F ? profile_[static_cast<std::size_t>(u * kProfileEntries)] : 0.0F;
        }
    }
    for (int i = 0; i < kLanes; ++i) {
        const int column = x + i % kBlockSide;
        const int row = y + i / kBlockSide;
        if (inks[i] <= 0.0F || column >= width_ || row >= height_) continue;
        const std::size_t k = touch(column, row);
        layer.coverage[k] = std::max(layer.coverage[k], inks[i]);
        layer.t[k] = std::min(layer.t[k], t[i] + kMeshBehind);
    }
}

void InkTile::finish() {
    if (empty_) return;
    std::vector<const Layer*> used;
    for (const Layer& layer : layers_) {
        if (layer.used) used.push_back(&layer);
    }
    alpha_.resize(plane_size());
    if (used.size() == 1) return finish_alone(*used.front());

    uniform_.reset();
    std::ranges::fill(alpha_, 0.0F);
    for (auto& plane : color_) plane.resize(plane_size());
    for (std::size_t run = 0; run < touched_.size(); ++run) {
        if (touched_[run] == 0) continue;
        for (std::size_t k = run * kLanes; k < (run + 1) * kLanes; ++k) finish_pixel(k, used);
    }
}

void InkTile::finish_alone(const Layer& layer) {
    uniform_ = layer.color;
    for (std::size_t k = 0; k < alpha_.size(); ++k) alpha_[k] = layer.coverage[k] * layer.opacity;
}

/// The inks of a pixel over each other, front to back. Among equally near ones the first style's
/// lies on top.
void InkTile::finish_pixel(std::size_t k, std::span<const Layer* const> used) {
    here_.clear();
    for (const Layer* layer : used) {
        if (layer->coverage[k] == 0.0F) continue;
        here_.insert(std::ranges::upper_bound(here_, layer->t[k], {},
                                              [&](const Layer* other) { return other->t[k]; }),
                     layer);
    }
    float clear = 1.0F;  // what the inks so far let through
    Color color{0.0F, 0.0F, 0.0F};
    for (const Layer* layer : here_) {
        const float ink = clear * layer->coverage[k] * layer->opacity;
        color.r += ink * layer->color.r;
        color.g += ink * layer->color.g;
        color.b += ink * layer->color.b;
        clear -= ink;
    }
    alpha_[k] = 1.0F - clear;
    color_[0][k] = color.r;
    color_[1][k] = color.g;
    color_[2][k] = color.b;
}

}  // namespace ink

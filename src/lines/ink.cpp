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

template <bool kWide>
INKTRACE_INLINE float coverage_at(float distance, float half, float nx, float ny) {
    return kWide ? square_coverage(half - distance, nx, ny) : band_coverage(distance, half, nx, ny);
}

/// Sixteen pixels of a row, from the one whose centre is (x, y) on.
template <bool kWide>
INKTRACE_INLINE void draw_run(const Stroke& stroke, float x, float y, float* coverage, float* t) {
    const auto [a, along, length, half, strength, stroke_t, profile] = stroke;
    const float ry = y - a.y;
    const float left = x - a.x;
    Lanes<float> inks;
    for (int i = 0; i < kLanes; ++i) {
        const float rx = left + static_cast<float>(i);
        const float s = std::min(std::max(rx * along.x + ry * along.y, 0.0F), length);
        const float vx = rx - s * along.x;
        const float vy = ry - s * along.y;
        const float distance = std::sqrt(vx * vx + vy * vy);
        // On the line itself any normal of it will do.
        const bool off = distance > 1e-4F;
        const float inverse = 1.0F / std::max(distance, 1e-4F);
        const float nx = off ? vx * inverse : -along.y;
        const float ny = off ? vy * inverse : along.x;
        // The round end of a segment must not claim more than its band does, or it would widen the
        // lines that go on from it.
        const float across = std::abs(ry * along.x - rx * along.y);
        const float band = coverage_at<kWide>(across, half, -along.y, along.x);
        inks[i] = std::min(coverage_at<kWide>(distance, half, nx, ny), band) * strength;
    }
    for (int i = 0; i < kLanes; ++i) coverage[i] = std::max(coverage[i], inks[i]);
    for (int i = 0; i < kLanes; ++i) t[i] = inks[i] > 0.0F ? std::min(t[i], stroke_t) : t[i];
}

/// Such runs one below the other, `stride` floats apart.
INKTRACE_MULTIVERSION
void draw_solid(const Stroke& stroke, float x, float y, int rows, std::size_t stride,
                float* coverage, float* t) {
    for (int row = 0; row < rows; ++row) {
        const float below = y + static_cast<float>(row);
        if (stroke.half >= kWideHalf) {
            draw_run<true>(stroke, x, below, coverage, t);
        } else {
            draw_run<false>(stroke, x, below, coverage, t);
        }
        coverage += stride;
        t += stride;
    }
}

void draw_soft(const Stroke& stroke, float x, float y, int rows, std::size_t stride,
               float* coverage, float* t) {
    for (int n = 0; n < rows * kLanes; ++n) {
        const std::size_t i =
            static_cast<std::size_t>(n / kLanes) * stride + static_cast<std::size_t>(n % kLanes);
        const float rx = x + static_cast<float>(n % kLanes) - stroke.a.x;
        const float ry = y + static_cast<float>(n / kLanes) - stroke.a.y;
        const float s = std::clamp(rx * stroke.along.x + ry * stroke.along.y, 0.0F, stroke.length);
        const float u = std::hypot(rx - s * stroke.along.x, ry - s * stroke.along.y) / stroke.half;
        if (u >= 1.0F) continue;
        const float ink = stroke.profile[static_cast<int>(u * kProfileEntries)] * stroke.strength;
        t[i] = std::min(t[i], stroke.t);
        coverage[i] = std::max(coverage[i], ink);
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
    const int left = first(segment.a.x, segment.b.x, x0_);
    const int right = last(segment.a.x, segment.b.x, x0_, width_);
    const int top = first(segment.a.y, segment.b.y, y0_);
    const int bottom = last(segment.a.y, segment.b.y, y0_, height_);
    if (left > right || top > bottom) return;

    Layer& layer = layers_[layer_of_style_[style]];
    if (!layer.used) {
        layer.coverage.assign(plane_size(), 0.0F);
        layer.t.assign(plane_size(), std::numeric_limits<float>::infinity());
        layer.used = true;
        empty_ = false;
    }
    const Stroke stroke = make_stroke(segment, width, profile_.empty() ? nullptr : profile_.data());
    for (int x = left; x <= right; x += kLanes) {
        for (int y = top; y <= bottom; ++y) {
            touch(x + kLanes - 1, y);
            touch(x, y);
        }
        const std::size_t k = index(x, top);
        (profile_.empty() ? draw_solid : draw_soft)(
            stroke, static_cast<float>(x0_ + x) + 0.5F, static_cast<float>(y0_ + top) + 0.5F,
            bottom - top + 1, static_cast<std::size_t>(stride_), layer.coverage.data() + k,
            layer.t.data() + k);
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

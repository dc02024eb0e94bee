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

/// A segment made ready for the loop over pixels.
struct Stroke {
    Vec2f a, along;  ///< start and unit direction
    float length, half, strength, t;
    const float* profile;  ///< null: solid
};

/// Sixteen pixels of a row, from the one whose centre is (x, y) on.
INKTRACE_MULTIVERSION
void draw_solid(const Stroke& stroke, float x, float y, float* coverage, float* t) {
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
        const float band = band_coverage(across, half, -along.y, along.x);
        inks[i] = std::min(band_coverage(distance, half, nx, ny), band) * strength;
    }
    for (int i = 0; i < kLanes; ++i) coverage[i] = std::max(coverage[i], inks[i]);
    for (int i = 0; i < kLanes; ++i) t[i] = inks[i] > 0.0F ? std::min(t[i], stroke_t) : t[i];
}

void draw_soft(const Stroke& stroke, float x, float y, float* coverage, float* t) {
    for (int i = 0; i < kLanes; ++i) {
        const float rx = x + static_cast<float>(i) - stroke.a.x;
        const float ry = y - stroke.a.y;
        const float s = std::clamp(rx * stroke.along.x + ry * stroke.along.y, 0.0F, stroke.length);
        const float u = std::hypot(rx - s * stroke.along.x, ry - s * stroke.along.y) / stroke.half;
        if (u >= 1.0F) continue;
        const float ink = stroke.profile[static_cast<int>(u * kProfileEntries)] * stroke.strength;
        t[i] = std::min(t[i], stroke.t);
        coverage[i] = std::max(coverage[i], ink);
    }
}

Stroke make_stroke(const Segment& segment, const LineStyle& style, const float* profile) {
    const Vec2f d = segment.b - segment.a;
    const float length = std::hypot(d.x, d.y);
    const Vec2f along = length > 0.0F ? d * (1.0F / length) : Vec2f{1.0F, 0.0F};
    return {segment.a, along, length, 0.5F * style.width_px, segment.strength, segment.t, profile};
}

bool same_ink(const LineStyle& a, const LineStyle& b) {
    return a.color == b.color && a.opacity == b.opacity;
}

}  // namespace

float InkSettings::reach() const {
    float widest = 0.0F;
    for (const LineStyle& style : styles) widest = std::max(widest, style.width_px);
    return 0.5F * widest + 0.75F;  // half a pixel's diagonal
}

InkTile::InkTile(const InkSettings& settings) : settings_(settings) {
    for (std::size_t type = 0; type < kLineTypes; ++type) {
        const LineStyle& style = settings.styles[type];
        const auto found = std::ranges::find_if(
            layers_, [&](const Layer& layer) { return same_ink(layer.style, style); });
        layer_of_type_[type] = static_cast<std::size_t>(found - layers_.begin());
        if (found == layers_.end()) layers_.push_back({style, false, {}, {}});
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

void InkTile::draw(const Segment& segment) {
    const auto type = static_cast<std::size_t>(segment.type);
    const LineStyle& style = settings_.styles[type];
    const float reach = 0.5F * style.width_px + 0.75F;
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

    Layer& layer = layers_[layer_of_type_[type]];
    if (!layer.used) {
        layer.coverage.assign(plane_size(), 0.0F);
        layer.t.assign(plane_size(), std::numeric_limits<float>::infinity());
        layer.used = true;
        empty_ = false;
    }
    const Stroke stroke = make_stroke(segment, style, profile_.empty() ? nullptr : profile_.data());
    for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; x += kLanes) {
            touch(x + kLanes - 1, y);
            const std::size_t k = touch(x, y);
            (profile_.empty() ? draw_solid : draw_soft)(
                stroke, static_cast<float>(x0_ + x) + 0.5F, static_cast<float>(y0_ + y) + 0.5F,
                layer.coverage.data() + k, layer.t.data() + k);
        }
    }
}

void InkTile::finish() {
    if (empty_) return;
    const std::size_t size = plane_size();
    const auto used = std::ranges::count_if(layers_, &Layer::used);
    bool first = true;
    for (const Layer& layer : layers_) {
        if (!layer.used) continue;
        if (!first) {
            for (std::size_t k = 0; k < size; ++k) {
                if (layer.coverage[k] > 0.0F) lay(layer, k);
            }
            continue;
        }
        first = false;
        const auto [r, g, b] = layer.style.color;
        const float opacity = layer.style.opacity;
        alpha_.resize(size);
        for (std::size_t k = 0; k < size; ++k) alpha_[k] = layer.coverage[k] * opacity;
        uniform_ = used == 1 ? std::optional(layer.style.color) : std::nullopt;
        if (uniform_) return;
        t_ = layer.t;
        for (auto& plane : color_) plane.resize(size);
        for (std::size_t k = 0; k < size; ++k) color_[0][k] = alpha_[k] * r;
        for (std::size_t k = 0; k < size; ++k) color_[1][k] = alpha_[k] * g;
        for (std::size_t k = 0; k < size; ++k) color_[2][k] = alpha_[k] * b;
    }
}

/// Over what a pixel has so far if this ink is nearer, else under it.
void InkTile::lay(const Layer& layer, std::size_t k) {
    const float ink = layer.coverage[k] * layer.style.opacity;
    const bool over = layer.t[k] <= t_[k];
    const float below = over ? 1.0F - ink : 1.0F;
    const float added = over ? ink : ink * (1.0F - alpha_[k]);
    alpha_[k] = alpha_[k] * below + added;
    color_[0][k] = color_[0][k] * below + added * layer.style.color.r;
    color_[1][k] = color_[1][k] * below + added * layer.style.color.g;
    color_[2][k] = color_[2][k] * below + added * layer.style.color.b;
    t_[k] = std::min(t_[k], layer.t[k]);
}

}  // namespace ink

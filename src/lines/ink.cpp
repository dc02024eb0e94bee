#include "lines/ink.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "lines/coverage.h"
#include "lines/ink_kernels.h"

namespace ink {

namespace {

constexpr int kProfileSteps = 512;

INKTRACE_MULTIVERSION
void cover(const NearestLines& lines, float half, Lanes<float>& inks) {
    for (int i = 0; i < kLanes; ++i) {
        const float near = std::min(lines.distance[i], 1e6F);
        inks[i] = band_coverage(near, half, lines.nx[i], lines.ny[i]);
    }
}

/// Puts ink on a block. `t` is null where it does not matter. False if there is none.
INKTRACE_MULTIVERSION
bool add_ink(const Lanes<float>& inks, const Lanes<float>& strength, const Lanes<float>& behind,
             Lanes<float>& coverage, Lanes<float>* t) {
    std::int32_t any = 0;
    for (int i = 0; i < kLanes; ++i) any |= inks[i] > 0.0F ? 1 : 0;
    for (int i = 0; i < kLanes; ++i) {
        coverage[i] = std::max(coverage[i], inks[i] * strength[i]);
    }
    if (t == nullptr) return any != 0;
    Lanes<float>& nearest = *t;
    for (int i = 0; i < kLanes; ++i) {
        const float at = inks[i] > 0.0F ? behind[i] + kMeshBehind : kInfinity;
        nearest[i] = std::min(nearest[i], at);
    }
    return any != 0;
}

}  // namespace

float InkSettings::widest() const {
    float widest = 0.0F;
    for (const LineStyle& style : styles) widest = std::max(widest, style.width_px);
    return widest;
}

bool InkSettings::has_several_inks() const {
    return std::ranges::any_of(styles, [this](const LineStyle& style) {
        return style.color != styles.front().color || style.opacity != styles.front().opacity;
    });
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
        if (found != layers_.end()) continue;
        Layer& layer = layers_.emplace_back();
        layer.color = style.color;
        layer.opacity = style.opacity;
    }
    if (settings.profile.kind == Metric::Kind::solid) return;
    for (int k = 0; k <= kProfileSteps; ++k) {
        const double u = static_cast<double>(k) / kProfileSteps;
        profile_.push_back(straight_edge_strength(settings.profile, u));
    }
    profile_.push_back(0.0F);
}

void InkTile::begin(int x0, int y0, int width, int height) {
    x0_ = x0;
    y0_ = y0;
    width_ = width;
    height_ = height;
    const auto blocks = [](int pixels) {
        return static_cast<std::size_t>((pixels + kBlockSide - 1) / kBlockSide);
    };
    across_ = blocks(width);
    touched_.assign(across_ * blocks(height), 0);
    for (Layer& layer : layers_) layer.used = false;
    empty_ = true;
    waiting_.count = 0;
    waiting_.width = width;
    waiting_.height = height;
}

void InkTile::draw(const InkStroke& stroke, float width_scale) {
    const int lane = waiting_.count++;
    StrokeLanes& strokes = waiting_.strokes;
    strokes.ax[lane] = stroke.a.x;
    strokes.ay[lane] = stroke.a.y;
    strokes.bx[lane] = stroke.b.x;
    strokes.by[lane] = stroke.b.y;
    strokes.width[lane] = settings_.styles[stroke.style].width_px * width_scale;
    strokes.strength[lane] = stroke.strength;
    strokes.t[lane] = stroke.t;
    waiting_.planes[static_cast<std::size_t>(lane)] = &layer_of(stroke.style).planes;
    if (waiting_.count == kLanes) draw_waiting();
}

void InkTile::draw_waiting() {
    if (waiting_.count == 0) return;
    if (profile_.empty()) {
        draw_solid(waiting_);
    } else {
        draw_soft(waiting_, profile_);
    }
    waiting_.count = 0;
}

/// Clears it.
void InkTile::start(Layer& layer) {
    // What lies on top matters only where inks differ.
    const bool alone = layers_.size() == 1;
    layer.coverage.assign(blocks(), {});
    if (!alone) layer.t.assign(blocks(), Lanes<float>::filled(kInfinity));
    layer.planes = {};
    layer.planes.x0 = static_cast<float>(x0_) + 0.5F;
    layer.planes.y0 = static_cast<float>(y0_) + 0.5F;
    layer.planes.across = across_;
    layer.planes.coverage = layer.coverage.data();
    layer.planes.t = alone ? nullptr : layer.t.data();
    layer.planes.touched = touched_.data();
    if (profile_.empty()) {
        const std::size_t stride = across_ * kBlockSide + kInkWindowAcross - 1;
        const std::size_t pixels = stride * (blocks() / across_ * kBlockSide + kInkWindowDown - 1);
        layer.narrow.assign(pixels, 0.0F);
        if (!alone) layer.narrow_t.assign(pixels, kInfinity);
        layer.planes.narrow = layer.narrow.data();
        layer.planes.narrow_t = alone ? nullptr : layer.narrow_t.data();
        layer.planes.stride = stride;
    } else {
        layer.squared.assign(blocks(), Lanes<float>::filled(kInfinity));
        layer.planes.squared = layer.squared.data();
    }
    layer.used = true;
    empty_ = false;
}

void InkTile::draw_faces(int x, int y, const NearestLines& lines, const Lanes<float>& strength,
                         std::size_t style, float width) {
    Layer& layer = layer_of(style);
    Lanes<float> inks;
    if (profile_.empty()) {
        cover(lines, 0.5F * width, inks);
    } else {
        for (int i = 0; i < kLanes; ++i) {
            const float place = std::min(lines.distance[i] / (0.5F * width), 1.0F) * kProfileSteps;
            const auto entry = static_cast<std::size_t>(place);
            inks[i] = profile_[entry] +
                      (profile_[entry + 1] - profile_[entry]) * (place - static_cast<float>(entry));
        }
    }
    const std::size_t k = index(x, y) / kLanes;
    const bool any = add_ink(inks, strength, lines.t, layer.coverage[k],
                             layer.t.empty() ? nullptr : &layer.t[k]);
    if (any && touched_[k] == 0) touched_[k] = kTouched;
}

void InkTile::draw_borders(int x, int y, const Lanes<std::uint32_t>& codes, float reach,
                           const Lanes<float>& depths, std::size_t style, float width) {
    Layer& layer = layer_of(style);
    const std::size_t k = index(x, y) / kLanes;
    if (ink::draw_borders(codes, reach, 0.5F * width, depths, kMeshBehind, layer.coverage[k],
                          layer.t[k]) &&
        touched_[k] == 0) {
        touched_[k] = kTouched;
    }
}

void InkTile::finish() {
    draw_waiting();
    if (empty_) return;
    used_.clear();
    for (Layer& layer : layers_) {
        if (!layer.used) continue;
        if (profile_.empty()) {
            finish_solid(layer.planes, blocks());
        } else {
            finish_soft(layer.planes, blocks(), profile_);
        }
        used_.push_back(&layer);
    }
    alpha_.resize(blocks());
    if (used_.size() == 1) return finish_alone(*used_.front());

    uniform_.reset();
    std::ranges::fill(alpha_, Lanes<float>{});
    for (auto& plane : color_) plane.resize(blocks() * kLanes);
    for (std::size_t block = 0; block < blocks(); ++block) {
        if (touched_[block] == 0) continue;
        for (std::size_t k = block * kLanes; k < (block + 1) * kLanes; ++k) finish_pixel(k, used_);
    }
}

void InkTile::finish_alone(const Layer& layer) {
    uniform_ = layer.color;
    for (std::size_t k = 0; k < alpha_.size(); ++k) {
        if (touched_[k] == 0) {
            alpha_[k] = {};
            continue;
        }
        for (int i = 0; i < kLanes; ++i) alpha_[k][i] = layer.coverage[k][i] * layer.opacity;
    }
}

/// The inks of a pixel over each other, front to back. Among equally near ones the first style's
/// lies on top. Where there is one ink only, the sums are what `finish_alone` gives to the last
/// bit: which other inks are on its tile has no say.
void InkTile::finish_pixel(std::size_t k, std::span<const Layer* const> used) {
    const std::size_t block = k / kLanes;
    const auto lane = static_cast<int>(k % kLanes);
    here_.clear();
    for (const Layer* layer : used) {
        if (layer->coverage[block][lane] == 0.0F) continue;
        const auto depth = [&](const Layer* of) { return of->t[block][lane]; };
        here_.insert(std::ranges::upper_bound(here_, depth(layer), {}, depth), layer);
    }
    float clear = 1.0F;  // what the inks so far let through
    float alpha = 0.0F;
    Color color{0.0F, 0.0F, 0.0F};
    for (const Layer* layer : here_) {
        const float ink = clear * layer->coverage[block][lane] * layer->opacity;
        color.r += ink * layer->color.r;
        color.g += ink * layer->color.g;
        color.b += ink * layer->color.b;
        alpha += ink;
        clear -= ink;
    }
    alpha_[block][lane] = alpha;
    color_[0][k] = color.r;
    color_[1][k] = color.g;
    color_[2][k] = color.b;
}

}  // namespace ink

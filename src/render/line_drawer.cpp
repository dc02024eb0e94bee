#include "render/line_drawer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>

#include <hwy/highway.h>

#include "base/timer.h"
#include "lines/coverage.h"

namespace ink {

void LineDrawer::draw(const Tile& tile, const std::vector<TileLines>& found) {
    const Timer timer(stats_.lines_ms);
    if (edges_.pipeline.aovs && edges_.pipeline.aovs->wants_line_planes()) {
        write_planes(tile, found);
    }
    if (!edges_.draw_lines) return;
    {
        const Timer phase(stats_.ink_ms);
        gather(tile, found);
        if (near_.empty() && !face_edges_ && borders_ == nullptr && tiling_ == nullptr) return;
        ink_.begin(tile.x0, tile.y0, tile.x1 - tile.x0, tile.y1 - tile.y0);
        thinning_.scales_at(middles_, scales_);
        for (std::size_t k = 0; k < near_.size(); ++k) {
            const InkStroke& stroke = *near_[k];
            ink_.draw(stroke,
                      stroke.direct ? scales_[k] * stroke.width_scale : width_scale(stroke));
            if (stroke.gap > 0.0F) leave_gap(stroke);
        }
        if (face_edges_) {
            face_edges_->enter(tile);
            ink_faces(tile, *face_edges_);
        }
        if (tiling_ != nullptr && !one_pass_) ink_faces(tile, *tiling_);
        if (borders_ != nullptr && !one_pass_) ink_borders(tile);
        ink_.finish();
    }
    if (!one_pass_) return write(tile);
    if (borders_ != nullptr) write_with_faces(tile, *borders_);
    if (tiling_ != nullptr) write_with_faces(tile, *tiling_);
}

/// Whether lines between faces are inked and laid on the film in one pass.
bool LineDrawer::goes_in_one_pass() const {
    if (borders_ == nullptr && tiling_ == nullptr) return false;
    return !edges_.ink.has_several_inks() && !edges_.styles_by_object && !edges_.cues_depth() &&
           edges_.ink.profile.kind == Metric::Kind::solid;
}

float LineDrawer::width_scale(const InkStroke& stroke) const {
    return thinning_.scale_at((stroke.a + stroke.b) * 0.5F, stroke.direct ? 0 : 1) *
           stroke.width_scale;
}

/// Covers what lies far behind a line with paper, on the far side, up to a halo beyond the line.
void LineDrawer::leave_gap(const InkStroke& stroke) {
    // In shares of the scene: from where gaps begin to where they are whole. Chosen by eye, so that
    // neighbouring atoms of a protein have none and the next chain behind does.
    constexpr float kLeast = 0.03F;
    constexpr float kWhole = 0.10F;
    const float far = (stroke.gap / edges_.depth_range - kLeast) / (kWhole - kLeast);
    if (far <= 0.0F) return;
    const Vec2f along = stroke.b - stroke.a;
    const float size = length(along);
    if (size == 0.0F) return;
    const LineStyle& style = edges_.ink.styles[stroke.style];
    const float reach =
        0.5F * style.width_px * width_scale(stroke) + edges_.halo_px * std::min(far, 1.0F);
    // The left side of a segment is at (dy, -dx), see Segment.
    const Vec2f left{along.y / size, -along.x / size};
    const Vec2f shift = left * (stroke.left_in_front ? -0.5F * reach : 0.5F * reach);
    InkStroke paper = stroke;
    paper.a = stroke.a + shift;
    paper.b = stroke.b + shift;
    paper.t += 1e-3F * edges_.depth_range;  // behind the line, before all that is far
    paper.strength = 1.0F;
    paper.style = static_cast<std::uint32_t>(edges_.halo_style);
    ink_.draw(paper, reach / edges_.ink.styles[edges_.halo_style].width_px);
}

/// What distance leaves of the ink of lines between faces in a block; returns what it leaves of
/// their width, which is that of the nearest of them.
float LineDrawer::cue_depth(int x, int y, const NearestEdges& nearest,
                            Lanes<float>& strength) const {
    strength.fill(1.0F);
    if (!edges_.cues_depth()) return 1.0F;
    const Settings& settings = edges_.pipeline.settings;
    float least = 1.0F;
    for (int i = 0; i < kLanes; ++i) {
        if (nearest.distance[i] == kInfinity) continue;
        const Vec2f centre{static_cast<float>(x + i % kBlockSide) + 0.5F,
                           static_cast<float>(y + i / kBlockSide) + 0.5F};
        const float depth = edges_.depth_at(centre, nearest.t[i]);
        strength[i] = 1.0F - static_cast<float>(settings.line_fade) * depth;
        least = std::min(least, depth);
    }
    return 1.0F - static_cast<float>(settings.line_taper) * least;
}

/// Finds the blocks of the tile that see faces, and how wide lines are there.
template <class Faces>
void LineDrawer::gather_blocks(const Tile& tile, const Faces& faces) {
    middles_.clear();
    sees_.clear();
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        for (int x = tile.x0; x < tile.x1; x += kBlockSide) {
            sees_.push_back(faces.sees(x, y));
            if (!sees_.back()) continue;
            middles_.push_back({static_cast<float>(x) + 0.5F * kBlockSide,
                                static_cast<float>(y) + 0.5F * kBlockSide});
        }
    }
    scales_.resize(middles_.size());
    thinning_.scales_at(middles_, scales_);
}

/// Calls `draw(x, y, nearest edges, strength, style, width)` for each block of the tile that has
/// lines between faces, once a style.
template <class Faces, class Draw>
void LineDrawer::for_each_face_block(const Tile& tile, Faces& faces, Draw draw) {
    gather_blocks(tile, faces);
    NearestEdges nearest;
    const float* scale_of_block = scales_.data();
    auto sees = sees_.begin();
    const float reach = edges_.ink.reach();
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        for (int x = tile.x0; x < tile.x1; x += kBlockSide) {
            if (!*sees++) continue;
            const float thinned = *scale_of_block++;
            if (!faces.measure(x, y, reach, nearest)) continue;
            Lanes<float> strength;
            const float scale = cue_depth(x, y, nearest, strength) * thinned;
            const auto draw_style = [&](std::uint32_t object, const NearestEdges& edges) {
                const std::size_t style = edges_.style_of(LineType::mesh, object);
                draw(x, y, edges, strength, style, edges_.ink.styles[style].width_px * scale);
            };
            if (!edges_.styles_by_object) {
                draw_style(0, nearest);
                continue;
            }
            for (NearestEdges rest = nearest;;) {
                const auto* first = std::ranges::find_if(
                    rest.distance, [](float distance) { return distance < kInfinity; });
                if (first == rest.distance.end()) break;
                const auto lane = static_cast<int>(first - rest.distance.begin());
                const std::uint32_t object = object_of(rest.triangle[lane]);
                NearestEdges own = rest;
                for (int i = 0; i < kLanes; ++i) {
                    const bool is_own =
                        rest.distance[i] < kInfinity && object_of(rest.triangle[i]) == object;
                    (is_own ? rest : own).distance[i] = kInfinity;
                }
                draw_style(object, own);
            }
        }
    }
}

template <class Faces>
void LineDrawer::ink_faces(const Tile& tile, Faces& faces) {
    for_each_face_block(tile, faces,
                        [&](int x, int y, const NearestEdges& edges, const Lanes<float>& strength,
                            std::size_t style, float width) {
                            ink_.draw_faces(x - tile.x0, y - tile.y0, edges, strength, style,
                                            width);
                        });
}

void LineDrawer::ink_borders(const Tile& tile) {
    gather_blocks(tile, *borders_);
    const std::size_t style = edges_.style_of(LineType::mesh, 0);
    const float width = edges_.ink.styles[style].width_px;
    for (std::size_t k = 0; k < middles_.size(); ++k) {
        const auto x = static_cast<int>(middles_[k].x) - kBlockSide / 2;
        const auto y = static_cast<int>(middles_[k].y) - kBlockSide / 2;
        ink_.draw_borders(x - tile.x0, y - tile.y0, borders_->codes(x, y), borders_->reach(),
                          borders_->depths(x, y), style, width * scales_[k]);
    }
}

void LineDrawer::write_planes(const Tile& tile, const std::vector<TileLines>& found) {
    planes_.begin(tile.x0, tile.y0, tile.x1 - tile.x0, tile.y1 - tile.y0);
    if (edges_.draw_lines) {
        for_each_near_tile(tile, found, [&](const TileLines& lines, bool) {
            for (const Segment& segment : lines.segments) {
                if (!edges_.wanted.has(segment.type) || segment.for_data) continue;
                const InkStroke stroke = make_ink_stroke(segment, edges_.style_of(segment));
                const LineStyle& style = edges_.ink.styles[stroke.style];
                planes_.add(segment, style.width_px * width_scale(stroke));
            }
        });
    }
    if (face_edges_ && edges_.draw_lines) add_face_planes(tile);
    edges_.pipeline.aovs->put_lines(tile.x0, tile.y0, tile.x1, tile.y1, planes_);
}

void LineDrawer::add_face_planes(const Tile& tile) {
    face_edges_->enter(tile);
    for_each_face_block(
        tile, *face_edges_,
        [&](int x, int y, const NearestEdges& edges, const Lanes<float>&, std::size_t,
            float width) {
            for (int i = 0; i < kLanes; ++i) {
                const int column = x + i % kBlockSide - tile.x0;
                const int row = y + i / kBlockSide - tile.y0;
                if (edges.distance[i] == kInfinity || x + i % kBlockSide >= tile.x1 ||
                    y + i / kBlockSide >= tile.y1) {
                    continue;
                }
                const FaceMap::Triangle seen = faces_->triangle(edges.triangle[i]);
                const GeometryId id = edges_.pipeline.ids.resolve(seen.object, seen.primitive);
                planes_.add(column, row, edges.distance[i], width,
                            {edges.t[i], LineType::mesh, id, id});
            }
        });
}

/// Tiles whose lines may reach a tile, which is one of them as far as it lies on the film. A
/// segment leaves its tile by less than a pixel. `visit(lines, own)` tells whether it is the tile
/// itself.
template <class Visit>
void LineDrawer::for_each_near_tile(const Tile& tile, const std::vector<TileLines>& found,
                                    Visit visit) {
    const int side = edges_.pipeline.settings.tile;
    const auto reach = static_cast<int>(edges_.stroke_reach());
    const auto across = static_cast<int>(edges_.search_tiles_across());
    const int down = static_cast<int>(found.size()) / across;
    const auto column = [&](int x) {
        return std::clamp((x + edges_.margin) / side, 0, across - 1);
    };
    const auto row = [&](int y) { return std::clamp((y + edges_.margin) / side, 0, down - 1); };
    const auto own = static_cast<std::size_t>(row(tile.y0) * across + column(tile.x0));
    for (int j = row(tile.y0 - reach); j <= row(tile.y1 + reach); ++j) {
        for (int i = column(tile.x0 - reach); i <= column(tile.x1 + reach); ++i) {
            const auto index = static_cast<std::size_t>(j * across + i);
            visit(found[index], index == own);
        }
    }
}

/// The strokes that can change pixels of a tile.
void LineDrawer::gather(const Tile& tile, const std::vector<TileLines>& found) {
    namespace hn = hwy::HWY_NAMESPACE;
    // Four lanes are what every processor has.
    constexpr hn::FixedTag<float, 4> kEnds;
    const float reach = edges_.stroke_reach();
    const float left = static_cast<float>(tile.x0) - reach;
    const float right = static_cast<float>(tile.x1) + reach;
    const float top = static_cast<float>(tile.y0) - reach;
    const float bottom = static_cast<float>(tile.y1) + reach;
    const std::array<float, 4> first{left, top, left, top};
    const std::array<float, 4> last{right, bottom, right, bottom};
    const auto lower = hn::LoadU(kEnds, first.data());
    const auto upper = hn::LoadU(kEnds, last.data());
    std::size_t most = 0;
    for_each_near_tile(tile, found, [&](const TileLines& lines, bool own) {
        most += lines.strokes.size() - (own ? 0 : lines.inner);
    });
    near_.resize(most);
    middles_.resize(most + 1);  // each is written with what the next will overwrite
    std::size_t count = 0;
    for_each_near_tile(tile, found, [&](const TileLines& lines, bool own) {
        const std::span<const InkStroke> all = lines.strokes;
        for (const InkStroke& s : own ? all : all.subspan(lines.inner)) {
            std::array<float, 4> ends;
            static_assert(offsetof(InkStroke, b) == sizeof(Vec2f));
            std::memcpy(ends.data(), &s, sizeof(ends));
            const auto from_a = hn::LoadU(kEnds, ends.data());
            const auto from_b = hn::Shuffle1032(from_a);
            const auto near = hn::And(hn::Gt(hn::Max(from_a, from_b), lower),
                                      hn::Lt(hn::Min(from_a, from_b), upper));
            const auto middle = hn::Mul(hn::Add(from_a, from_b), hn::Set(kEnds, 0.5F));
            hn::StoreU(middle, kEnds, &middles_[count].x);
            near_[count] = &s;
            count += hn::AllTrue(kEnds, near) ? 1 : 0;
        }
    });
    near_.resize(count);
    middles_.resize(count);
    scales_.resize(count);
}

void LineDrawer::write(const Tile& tile) {
    if (ink_.empty()) return;
    const Timer phase(stats_.blend_ms);
    const auto across = ink_.blocks_across();
    for (std::size_t k = 0; k < ink_.blocks(); ++k) {
        if (!ink_.touched(k)) continue;
        const int x = tile.x0 + static_cast<int>(k % across) * kBlockSide;
        const int y = tile.y0 + static_cast<int>(k / across) * kBlockSide;
        BlockInk ink{ink_.alpha_of_block(k), ink_.uniform_color(), {}};
        for (std::size_t c = 0; c < 3 && !ink.color; ++c) {
            ink.colors[c] = ink_.color()[c].data() + k * kLanes;
        }
        lay(x, y, ink);
    }
}

/// Where all lines have one ink, that of lines between faces needs no layer to be gathered in: it
/// goes from what is kept of a row of blocks' faces straight to their pixels.
template <class Faces>
void LineDrawer::write_with_faces(const Tile& tile, const Faces& faces) {
    const Timer phase(stats_.blend_ms);
    gather_blocks(tile, faces);
    const LineStyle& style = edges_.ink.styles[edges_.style_of(LineType::mesh, 0)];
    RowBands bands{.half = {}, .opacity = style.opacity};
    std::array<Lanes<float>, kLanes> alphas;
    const float* scale_of_block = scales_.data();
    std::size_t k = 0;
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        prefetch_row(tile, y + kBlockSide, faces);
        for (int x0 = tile.x0; x0 < tile.x1; x0 += kLanes * kBlockSide) {
            LaneBits seeing = 0;
            LaneBits inked = 0;
            for (int i = 0; i < kLanes && x0 + i * kBlockSide < tile.x1; ++i, ++k) {
                const LaneBits bit = LaneBits{1} << i;
                Lanes<float>& alpha = alphas[static_cast<std::size_t>(i)];
                const bool stroked = ink_.touched(k);
                if (stroked) {
                    alpha = ink_.alpha_of_block(k);
                    inked |= bit;
                }
                if (!sees_[k]) continue;
                if (!stroked) alpha.fill(0.0F);
                bands.half[i] = 0.5F * (style.width_px * *scale_of_block++);
                seeing |= bit;
            }
            if (seeing != 0) inked |= faces.ink(x0, y, seeing, bands, alphas);
            for (; inked != 0; inked &= inked - 1) {
                const auto i = static_cast<std::size_t>(std::countr_zero(inked));
                lay(x0 + static_cast<int>(i) * kBlockSide, y, {alphas[i], style.color, {}});
            }
        }
    }
}

/// Says that a row of blocks of the tile will be written soon.
template <class Faces>
void LineDrawer::prefetch_row(const Tile& tile, int y, const Faces& faces) const {
    constexpr int kPixels = 64 / sizeof(std::uint32_t);  // to a cache line
    if (y >= tile.y1) return;
    for (int x = tile.x0; x < tile.x1; x += kBlockSide) faces.prefetch(x, y);
    Film& film = edges_.pipeline.film;
    if (film.display().pixels.empty()) return;
    for (int row = y; row < std::min(y + kBlockSide, tile.y1); ++row) {
        for (int x = tile.x0; x < tile.x1; x += kPixels) {
            __builtin_prefetch(film.display_row(row).data() + x);
        }
    }
}

void LineDrawer::lay(int x, int y, const BlockInk& ink) {
    edges_.pipeline.film.lay_ink(x, y, ink);
    if (edges_.pipeline.aovs) edges_.pipeline.aovs->put_strength(Block{x, y}, ink.alpha);
}

}  // namespace ink

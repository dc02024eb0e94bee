#include "render/line_drawer.h"

#include <algorithm>
#include <cmath>

#include "lines/coverage.h"

namespace ink {

namespace {

int floor_divide(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

}  // namespace

void LineDrawer::draw(const Tile& tile, const std::vector<std::vector<ColoredSegment>>& found) {
    const Timer timer(stats_.lines_ms);
    gather(tile, found);
    if (edges_.pipeline.aovs && edges_.pipeline.aovs->wants_line_planes()) write_planes(tile);
    if (near_.empty() && !face_edges_) return;

    ink_.begin(tile.x0, tile.y0, tile.x1 - tile.x0, tile.y1 - tile.y0);
    if (edges_.smooth_shading) {
        for (auto& plane : shift_) plane.assign(ink_.plane_size(), 0);
        for (const ColoredSegment* line : near_) smooth(tile, *line);
    }
    if (edges_.draw_lines) {
        for (const ColoredSegment* line : near_) {
            if (edges_.wanted.has(line->segment.type)) ink(line->segment);
        }
        if (face_edges_) ink_faces(tile);
        ink_.finish();
    }
    write(tile);
}

float LineDrawer::width_scale_of(const Segment& segment) const {
    return thinning_.scale_at((segment.a + segment.b) * 0.5F, segment.level);
}

void LineDrawer::ink(const Segment& segment) {
    ink_.draw(segment, edges_.style_of(segment), width_scale_of(segment));
}

/// Calls `draw(x, y, nearest edges, style, width)` for each block of the tile that has lines
/// between faces, once a style.
template <class Draw>
void LineDrawer::for_each_face_block(const Tile& tile, Draw draw) {
    face_edges_->begin();
    NearestEdges nearest;
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        for (int x = tile.x0; x < tile.x1; x += kBlockSide) {
            if (!face_edges_->measure(x, y, edges_.ink.reach(), nearest)) continue;
            const float scale = thinning_.scale_at({static_cast<float>(x) + 0.5F * kBlockSide,
                                                    static_cast<float>(y) + 0.5F * kBlockSide},
                                                   0);
            const auto draw_style = [&](std::uint32_t object, const NearestEdges& edges) {
                const std::size_t style = edges_.style_of(LineType::mesh, object);
                draw(x, y, edges, style, edges_.ink.styles[style].width_px * scale);
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
                const std::uint32_t object = faces_->triangle(rest.triangle[lane]).object;
                NearestEdges own = rest;
                for (int i = 0; i < kLanes; ++i) {
                    const bool is_own = rest.distance[i] < kInfinity &&
                                        faces_->triangle(rest.triangle[i]).object == object;
                    (is_own ? rest : own).distance[i] = kInfinity;
                }
                draw_style(object, own);
            }
        }
    }
}

void LineDrawer::ink_faces(const Tile& tile) {
    for_each_face_block(
        tile, [&](int x, int y, const NearestEdges& edges, std::size_t style, float width) {
            ink_.draw_faces(x - tile.x0, y - tile.y0, edges.distance, edges.nx, edges.ny, edges.t,
                            style, width);
        });
}

void LineDrawer::write_planes(const Tile& tile) {
    planes_.begin(tile.x0, tile.y0, tile.x1 - tile.x0, tile.y1 - tile.y0);
    for (const ColoredSegment* line : near_) {
        const Segment& segment = line->segment;
        if (!edges_.draw_lines || !edges_.wanted.has(segment.type)) continue;
        const LineStyle& style = edges_.ink.styles[edges_.style_of(segment)];
        planes_.add(segment, style.width_px * width_scale_of(segment));
    }
    if (face_edges_ && edges_.draw_lines) add_face_planes(tile);
    edges_.pipeline.aovs->put_lines(tile.x0, tile.y0, tile.x1, tile.y1, planes_);
}

void LineDrawer::add_face_planes(const Tile& tile) {
    for_each_face_block(
        tile, [&](int x, int y, const NearestEdges& edges, std::size_t, float width) {
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

/// The segments that can change pixels of a tile.
void LineDrawer::gather(const Tile& tile, const std::vector<std::vector<ColoredSegment>>& found) {
    near_.clear();
    // Tiles were searched on the same raster, moved by the margin; a segment leaves its tile by
    // less than a pixel.
    const int side = edges_.pipeline.settings.tile;
    const int reach = static_cast<int>(std::ceil(edges_.ink.reach())) + 1;
    const Size size = edges_.pipeline.film.size();
    const int across = (size.width + 2 * edges_.margin + side - 1) / side;
    const int down = (size.height + 2 * edges_.margin + side - 1) / side;
    const auto column = [&](int x) {
        return std::clamp((x + edges_.margin) / side, 0, across - 1);
    };
    const auto row = [&](int y) { return std::clamp((y + edges_.margin) / side, 0, down - 1); };
    for (int j = row(tile.y0 - reach); j <= row(tile.y1 + reach); ++j) {
        for (int i = column(tile.x0 - reach); i <= column(tile.x1 + reach); ++i) {
            for (const ColoredSegment& line : found[static_cast<std::size_t>(j * across + i)]) {
                const Segment& s = line.segment;
                const bool near = std::max(s.a.x, s.b.x) > static_cast<float>(tile.x0 - reach) &&
                                  std::min(s.a.x, s.b.x) < static_cast<float>(tile.x1 + reach) &&
                                  std::max(s.a.y, s.b.y) > static_cast<float>(tile.y0 - reach) &&
                                  std::min(s.a.y, s.b.y) < static_cast<float>(tile.y1 + reach);
                if (near) near_.push_back(&line);
            }
        }
    }
}

/// A lattice point stands for a square of the lattice's spacing. Of each quarter of the four
/// squares about a cell that the segment crosses, the area beyond the segment takes the other
/// side's colour.
void LineDrawer::smooth(const Tile& tile, const ColoredSegment& line) {
    const Segment& segment = line.segment;
    // The two sides of a line on a smooth surface have one colour.
    if (!segment.spans_cell || segment.type == LineType::mesh) return;
    const Vec2f d = segment.b - segment.a;
    const float length = std::sqrt(d.x * d.x + d.y * d.y);
    if (length == 0.0F) return;
    const auto q = static_cast<float>(edges_.q);
    // Towards the segment's left: see Segment.
    const Vec2f normal{d.y / length, -d.x / length};
    const Vec2f middle = (segment.a + segment.b) * 0.5F;
    const int cell_x = static_cast<int>(std::floor(middle.x * q - 0.5F));
    const int cell_y = static_cast<int>(std::floor(middle.y * q - 0.5F));
    for (int corner = 0; corner < 4; ++corner) {
        const int i = cell_x + corner % 2;
        const int j = cell_y + corner / 2;
        const int x = floor_divide(i, edges_.q) - tile.x0;
        const int y = floor_divide(j, edges_.q) - tile.y0;
        if (x < 0 || y < 0 || x >= tile.x1 - tile.x0 || y >= tile.y1 - tile.y0) continue;
        const Vec2f point{(static_cast<float>(i) + 0.5F) / q, (static_cast<float>(j) + 0.5F) / q};
        const Vec2f quarter = point + Vec2f{(corner % 2 == 0 ? 0.25F : -0.25F) / q,
                                            (corner / 2 == 0 ? 0.25F : -0.25F) / q};
        const auto left_of = [&](Vec2f p) {
            return (p.x - segment.a.x) * normal.x + (p.y - segment.a.y) * normal.y;
        };
        const bool on_left = left_of(point) > 0.0F;
        // In units of the quarter's side.
        const float to_left = left_of(quarter) * 2.0F * q;
        const float beyond = square_coverage(on_left ? -to_left : to_left, normal.x, normal.y);
        const float area = beyond * 0.25F / (q * q);
        if (area == 0.0F) continue;
        const std::size_t k = ink_.touch(x, y);
        const auto& own = on_left ? line.left : line.right;
        const auto& other = on_left ? line.right : line.left;
        for (std::size_t c = 0; c < 4; ++c) {
            const float change = std::clamp(other[c] - own[c], -kMostChange, kMostChange);
            shift_[c][k] +=
                static_cast<std::int32_t>(std::floor(area * change * kFixedPoint + 0.5F));
        }
    }
}

void LineDrawer::write(const Tile& tile) {
    Film& film = edges_.pipeline.film;
    for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; x += kLanes) {
            if (!ink_.touched(x - tile.x0, y - tile.y0)) continue;
            const std::size_t k = ink_.index(x - tile.x0, y - tile.y0);
            Film::TouchUp change{};
            if (edges_.smooth_shading) {
                for (std::size_t c = 0; c < 4; ++c) {
                    for (int i = 0; i < kLanes; ++i) {
                        shift_run_[c][i] =
                            static_cast<float>(shift_[c][k + static_cast<std::size_t>(i)]) /
                            kFixedPoint;
                    }
                    change.shift[c] = shift_run_[c].data();
                }
            }
            if (!ink_.empty()) {
                change.ink_alpha = ink_.alpha() + k;
                change.ink_color = ink_.uniform_color();
                for (std::size_t c = 0; c < 3 && !change.ink_color; ++c) {
                    change.ink_colors[c] = ink_.color()[c].data() + k;
                }
            }
            const int count = std::min(kLanes, tile.x1 - x);
            film.touch_up(x, y, count, change);
            if (edges_.pipeline.aovs && !ink_.empty()) {
                edges_.pipeline.aovs->put_strength(x, y, count, change.ink_alpha);
            }
        }
    }
}

}  // namespace ink

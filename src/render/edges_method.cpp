#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "base/multiversion.h"
#include "base/parallel.h"
#include "lines/connect.h"
#include "lines/coverage.h"
#include "lines/detect.h"
#include "lines/ink.h"
#include "lines/locate.h"
#include "render/pipeline.h"
#include "render/tiles.h"
#include "sampling/sampler.h"
#include "sampling/samples.h"

namespace ink {

namespace {

/// A line segment on its way from the pass that finds lines to the pass that draws them.
struct ColoredSegment {
    Segment segment;
    std::array<float, 4> left, right;  ///< colours of the two sides, linear, premultiplied
};

/// The method's fixed parts, shared by all tiles.
struct Edges {
    explicit Edges(const Pipeline& shared);

    const Pipeline& pipeline;
    int q;  ///< lattice points along a pixel's side
    bool draw_lines;
    bool smooth_shading;  ///< blend the colours of pixels that a line cuts
    DetectSettings detect;
    LocateSettings locate;
    LineTypes wanted;
    InkSettings ink;
    Viewpoint viewpoint;
    int margin;  ///< pixels searched beyond the film's edge, for lines that reach in
    std::vector<Tile> search_tiles, draw_tiles;
};

InkSettings ink_settings(const Settings& settings, Color color) {
    InkSettings ink;
    ink.profile = settings.profile();
    ink.styles.fill({static_cast<float>(settings.line_width_px()), color, 1.0F});
    return ink;
}

Edges::Edges(const Pipeline& shared)
    : pipeline(shared),
      q(shared.settings.lattice_points()),
      draw_lines(shared.settings.draws_lines()),
      smooth_shading(shared.settings.smoothing().kind == AntiAliasing::Kind::edges),
      wanted(shared.settings.lines),
      ink(ink_settings(shared.settings, shared.film.line_color())) {
    // A sharp corner can look like a jump before it is located.
    detect.depths =
        smooth_shading || wanted.has(LineType::self_occlusion) || wanted.has(LineType::crease);
    detect.normals = smooth_shading || wanted.has(LineType::crease);
    const Camera& camera = shared.camera;
    detect.least_jump = 0.2F * camera.least_footprint() / static_cast<float>(q);
    viewpoint = {camera.eye(), -camera.back(), camera.orthographic()};
    const int reach = static_cast<int>(std::ceil(draw_lines ? ink.reach() : 1.0F)) + 1;
    margin = (reach + kBlockSide - 1) / kBlockSide * kBlockSide;
    const Size size = shared.settings.size;
    draw_tiles = cut_into_tiles(size, shared.settings.tile);
    search_tiles =
        cut_into_tiles({size.width + 2 * margin, size.height + 2 * margin}, shared.settings.tile);
    for (Tile& tile : search_tiles) {
        tile = {tile.x0 - margin, tile.y0 - margin, tile.x1 - margin, tile.y1 - margin};
    }
}

/// Finds the lines of one tile after another. Arrays over blocks have one entry a block that is
/// near the scene.
class LineFinder {
  public:
    explicit LineFinder(const Edges& edges)
        : edges_(edges),
          sampler_(edges.pipeline.tracer, edges.pipeline.camera, edges.q),
          pixel_sampler_(edges.pipeline.tracer, edges.pipeline.camera),
          locator_(edges.viewpoint, edges.locate),
          sample_([this](std::span<const Vec2f> points, std::span<Sample> out) {
              sample(points, out);
          }) {}

    /// Design: trace the lattice, detect, locate, connect. Shades the tile's pixels on the way.
    std::vector<ColoredSegment> search(const Tile& tile) {
        trace_lattice(tile);
        shade(tile);
        return find_lines();
    }

    RenderStats stats() const {
        RenderStats result = stats_;
        result.rays = sampler_.rays();
        return result;
    }

  private:
    void trace_lattice(const Tile& tile);
    void fill_grid(std::size_t block);
    void shade(const Tile& tile);
    void put_pixels(int x, int y);
    void put_aovs(Block block);
    std::vector<ColoredSegment> find_lines();
    void sample(std::span<const Vec2f> points, std::span<Sample> out);
    std::uint32_t block_index(int i, int j) const;
    std::array<float, 4> color_at(int i, int j) const;

    static constexpr std::uint32_t kEmptyBlock = 0xFFFFFFFFU;

    const Edges& edges_;
    Sampler sampler_;
    Sampler pixel_sampler_;
    Locator locator_;
    SampleFunction sample_;
    Connector connector_;
    SampleGrid grid_;
    int blocks_across_ = 0;
    std::vector<std::uint32_t> block_at_;  ///< of the tile's blocks, row by row; or kEmptyBlock
    std::vector<Block> blocks_;
    std::vector<HitPacket> hits_;
    std::vector<NormalPacket> normals_;
    std::vector<ColorPacket> colors_;
    std::vector<std::uint8_t> seen_;
    std::vector<HitPacket> point_hits_;
    std::vector<SuspectEdge> suspects_;
    std::vector<Crossing> crossings_;
    std::vector<Segment> segments_;
    RenderStats stats_;
};

int floor_divide(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

bool near_scene(const Camera& camera, const Block& block, int q) {
    const Camera::ScreenBox& box = camera.scene_box();
    const float scale = 1.0F / static_cast<float>(q);
    const auto left = static_cast<float>(block.x) * scale;
    const auto top = static_cast<float>(block.y) * scale;
    const float side = kBlockSide * scale;
    return left + side > box.left && left < box.right && top + side > box.top && top < box.bottom;
}

void LineFinder::trace_lattice(const Tile& tile) {
    const Timer timer(stats_.trace_ms);
    const int q = edges_.q;
    // Cells hang on their upper left point, so the tile needs one more column and row of points.
    grid_.x0 = tile.x0 * q;
    grid_.y0 = tile.y0 * q;
    grid_.spacing = 1.0F / static_cast<float>(q);
    grid_.resize((tile.x1 - tile.x0) * q + 1, (tile.y1 - tile.y0) * q + 1);
    std::ranges::fill(grid_.id, kBackground);

    blocks_across_ = (grid_.width + kBlockSide - 1) / kBlockSide;
    const int blocks_down = (grid_.height + kBlockSide - 1) / kBlockSide;
    block_at_.clear();
    blocks_.clear();
    for (int j = 0; j < blocks_down; ++j) {
        for (int i = 0; i < blocks_across_; ++i) {
            const Block block{grid_.x0 + i * kBlockSide, grid_.y0 + j * kBlockSide,
                              std::min(kBlockSide, grid_.width - i * kBlockSide),
                              std::min(kBlockSide, grid_.height - j * kBlockSide)};
            const bool near = near_scene(edges_.pipeline.camera, block, q);
            block_at_.push_back(near ? static_cast<std::uint32_t>(blocks_.size()) : kEmptyBlock);
            if (near) blocks_.push_back(block);
        }
    }
    hits_.resize(blocks_.size());
    normals_.resize(blocks_.size());
    sampler_.trace_blocks(blocks_, {}, hits_);
    constexpr std::size_t kAhead = 4;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
        if (k + kAhead < blocks_.size()) edges_.pipeline.shader.prefetch(hits_[k + kAhead]);
        if (std::ranges::all_of(hits_[k].object, [](auto object) { return object == kNoObject; })) {
            continue;  // the grid is background so far
        }
        edges_.pipeline.shader.smooth(hits_[k], normals_[k]);
        fill_grid(k);
    }
}

/// Positions and IDs of a packet.
INKTRACE_MULTIVERSION
void locate_hits(const RayPacket& rays, const HitPacket& hits, const NormalPacket& normals,
                 std::array<Lanes<float>, 7>& values) {
    for (int i = 0; i < kLanes; ++i) {
        const bool hit = hits.object[i] != kNoObject;
        const float t = hit ? hits.t[i] : 0.0F;
        values[0][i] = rays.origin_x[i] + t * rays.dir_x[i];
        values[1][i] = rays.origin_y[i] + t * rays.dir_y[i];
        values[2][i] = rays.origin_z[i] + t * rays.dir_z[i];
        values[3][i] = hit ? normals.x[i] : 0.0F;
        values[4][i] = hit ? normals.y[i] : 0.0F;
        values[5][i] = hit ? normals.z[i] : 0.0F;
        values[6][i] = t;
    }
}

void LineFinder::fill_grid(std::size_t block) {
    Lanes<GeometryId> ids;
    std::array<Lanes<float>, 7> values;
    edges_.pipeline.ids.resolve(hits_[block], ids);
    const Shader& shader = edges_.pipeline.shader;
    NormalPacket separate;
    if (shader.has_line_normals()) shader.line_normals(hits_[block], separate);
    const NormalPacket& normals = shader.has_line_normals() ? separate : normals_[block];
    locate_hits(sampler_.packets()[block], hits_[block], normals, values);
    const int i0 = blocks_[block].x - grid_.x0;
    const int j0 = blocks_[block].y - grid_.y0;
    const int block_columns = blocks_[block].columns;
    const int block_rows = blocks_[block].rows;
    const std::array<float*, 7> planes{grid_.px.data(), grid_.py.data(), grid_.pz.data(),
                                       grid_.nx.data(), grid_.ny.data(), grid_.nz.data(),
                                       grid_.t.data()};
    // A size known to the compiler makes each row one move.
    const auto copy_rows = [&](const auto* from, auto* to, auto count) {
        for (int j = 0; j < block_rows; ++j) {
            std::copy_n(from + j * kBlockSide, count(), to + grid_.index(i0, j0 + j));
        }
    };
    const auto copy_plane = [&](const auto* from, auto* to) {
        if (block_columns == kBlockSide) {
            copy_rows(from, to, [] { return kBlockSide; });
        } else {
            copy_rows(from, to, [&] { return block_columns; });
        }
    };
    copy_plane(ids.data(), grid_.id.data());
    for (std::size_t k = 0; k < planes.size(); ++k) copy_plane(values[k].data(), planes[k]);
}

void LineFinder::shade(const Tile& tile) {
    const Timer timer(stats_.shade_ms);
    const Pipeline& pipeline = edges_.pipeline;
    colors_.resize(blocks_.size());
    seen_.resize(blocks_.size());
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
        seen_[k] = pipeline.shader.shade(hits_[k], normals_[k], colors_[k]) ? 1 : 0;
    }
    const Size size = pipeline.film.size();
    for (int y = std::max(tile.y0, 0); y < std::min(tile.y1, size.height); y += kBlockSide) {
        for (int x = std::max(tile.x0, 0); x < std::min(tile.x1, size.width); x += kBlockSide) {
            put_pixels(x, y);
            if (pipeline.aovs) put_aovs({x, y});
        }
    }
}

/// The block of pixels at (x, y): one lattice block, or the mean over q x q of them.
void LineFinder::put_pixels(int x, int y) {
    Film& film = edges_.pipeline.film;
    const int q = edges_.q;
    const int i0 = (x * q - grid_.x0) / kBlockSide;
    const int j0 = (y * q - grid_.y0) / kBlockSide;
    bool any = false;
    for (int n = 0; n < q * q; ++n) {
        const std::uint32_t k = block_index(i0 + n % q, j0 + n / q);
        any |= k != kEmptyBlock && seen_[k] != 0;
    }
    if (!any) return film.put_background(x, y);
    if (q == 1) return film.put(x, y, colors_[block_index(i0, j0)]);

    ColorPacket mean{};
    const float weight = 1.0F / static_cast<float>(q * q);
    for (int lane = 0; lane < kLanes; ++lane) {
        std::array<float, 4> sum{};
        for (int n = 0; n < q * q; ++n) {
            const int i = (x + lane % kBlockSide) * q + n % q - grid_.x0;
            const int j = (y + lane / kBlockSide) * q + n / q - grid_.y0;
            const std::array<float, 4> color = color_at(i, j);
            for (std::size_t c = 0; c < 4; ++c) sum[c] += color[c] * weight;
        }
        mean.r[lane] = sum[0];
        mean.g[lane] = sum[1];
        mean.b[lane] = sum[2];
        mean.a[lane] = sum[3];
    }
    film.put(x, y, mean);
}

/// What pixel centres see, whatever the lattice.
void LineFinder::put_aovs(Block block) {
    std::array<HitPacket, 1> hits;
    pixel_sampler_.trace_blocks(std::array{block}, {}, hits);
    edges_.pipeline.aovs->put(block, {}, hits[0]);
}

std::uint32_t LineFinder::block_index(int i, int j) const {
    return block_at_[static_cast<std::size_t>(j) * static_cast<std::size_t>(blocks_across_) +
                     static_cast<std::size_t>(i)];
}

/// Linear, premultiplied colour of a point of the grid.
std::array<float, 4> LineFinder::color_at(int i, int j) const {
    const std::uint32_t k = block_index(i / kBlockSide, j / kBlockSide);
    const bool empty = k == kEmptyBlock;
    const ColorPacket& colors = empty ? edges_.pipeline.shader.background() : colors_[k];
    const int lane = empty ? 0 : j % kBlockSide * kBlockSide + i % kBlockSide;
    return {colors.r[lane], colors.g[lane], colors.b[lane], colors.a[lane]};
}

std::vector<ColoredSegment> LineFinder::find_lines() {
    const Timer timer(stats_.lines_ms);
    if (!edges_.draw_lines && !edges_.smooth_shading) return {};
    detect(grid_, edges_.detect, suspects_);
    locator_.locate(grid_, suspects_, sample_, crossings_);
    connector_.connect(grid_, suspects_, crossings_, segments_);
    stats_.crossings += crossings_.size();

    std::vector<ColoredSegment> found;
    found.reserve(segments_.size());
    for (const Segment& segment : segments_) {
        const auto color = [&](std::uint32_t index) {
            const auto width = static_cast<std::uint32_t>(grid_.width);
            return color_at(static_cast<int>(index % width), static_cast<int>(index / width));
        };
        found.push_back({segment, color(segment.left_sample), color(segment.right_sample)});
    }
    return found;
}

/// More samples, for the bisection.
void LineFinder::sample(std::span<const Vec2f> points, std::span<Sample> out) {
    if (points.empty()) return;
    sampler_.trace_points(points, point_hits_);
    NormalPacket normals;
    Lanes<GeometryId> ids;
    std::array<Lanes<float>, 7> values;
    for (std::size_t k = 0; k < point_hits_.size(); ++k) {
        edges_.pipeline.shader.line_normals(point_hits_[k], normals);
        edges_.pipeline.ids.resolve(point_hits_[k], ids);
        locate_hits(sampler_.packets()[k], point_hits_[k], normals, values);
        const std::size_t first = k * kLanes;
        const std::size_t count = std::min<std::size_t>(kLanes, points.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
            const int i = static_cast<int>(n);
            out[first + n] = {ids[i],
                              {values[0][i], values[1][i], values[2][i]},
                              {values[3][i], values[4][i], values[5][i]},
                              values[6][i]};
        }
    }
}

/// Draws the lines of one tile after another.
class LineDrawer {
  public:
    explicit LineDrawer(const Edges& edges) : edges_(edges), ink_(edges.ink) {}

    void draw(const Tile& tile, const std::vector<std::vector<ColoredSegment>>& found);

    RenderStats stats() const { return stats_; }

  private:
    static constexpr float kFixedPoint = 1 << 22;
    static constexpr float kMostChange = 64.0F;

    void gather(const Tile& tile, const std::vector<std::vector<ColoredSegment>>& found);
    void smooth(const Tile& tile, const ColoredSegment& line);
    void write(const Tile& tile);

    const Edges& edges_;
    InkTile ink_;
    std::vector<const ColoredSegment*> near_;  ///< segments within reach of the tile
    /// What smoothing adds to each pixel's colour: linear, premultiplied R, G, B, A. In fixed
    /// point, for a sum that does not depend on the order of segments, and so not on the tiles.
    std::array<std::vector<std::int32_t>, 4> shift_;
    std::array<Lanes<float>, 4> shift_run_;
    RenderStats stats_;
};

void LineDrawer::draw(const Tile& tile, const std::vector<std::vector<ColoredSegment>>& found) {
    const Timer timer(stats_.lines_ms);
    gather(tile, found);
    if (near_.empty()) return;

    ink_.begin(tile.x0, tile.y0, tile.x1 - tile.x0, tile.y1 - tile.y0);
    if (edges_.smooth_shading) {
        for (auto& plane : shift_) plane.assign(ink_.plane_size(), 0);
        for (const ColoredSegment* line : near_) smooth(tile, *line);
    }
    if (edges_.draw_lines) {
        for (const ColoredSegment* line : near_) {
            if (edges_.wanted.has(line->segment.type)) ink_.draw(line->segment);
        }
        ink_.finish();
    }
    write(tile);
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
    if (!segment.spans_cell) return;
    const Vec2f d = segment.b - segment.a;
    const float length = std::hypot(d.x, d.y);
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
            shift_[c][k] += static_cast<std::int32_t>(std::lround(area * change * kFixedPoint));
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

template <class Worker>
RenderStats total_of(const std::vector<std::unique_ptr<Worker>>& workers) {
    RenderStats total;
    for (const auto& worker : workers) {
        if (worker) total += worker->stats();
    }
    return total;
}

}  // namespace

RenderStats render_edges(const Pipeline& pipeline, const RenderControl& control) {
    const Edges edges(pipeline);
    const int threads =
        pipeline.settings.threads > 0 ? pipeline.settings.threads : hardware_threads();
    WorkLoop loop(threads, control, edges.search_tiles.size() + edges.draw_tiles.size());
    const auto pool = static_cast<std::size_t>(threads);

    std::vector<std::vector<ColoredSegment>> found(edges.search_tiles.size());
    std::vector<std::unique_ptr<LineFinder>> finders(pool);
    loop.run(edges.search_tiles.size(), [&](std::size_t i, std::size_t worker) {
        if (!finders[worker]) finders[worker] = std::make_unique<LineFinder>(edges);
        found[i] = finders[worker]->search(edges.search_tiles[i]);
    });

    std::vector<std::unique_ptr<LineDrawer>> drawers(pool);
    loop.run(edges.draw_tiles.size(), [&](std::size_t i, std::size_t worker) {
        if (!drawers[worker]) drawers[worker] = std::make_unique<LineDrawer>(edges);
        drawers[worker]->draw(edges.draw_tiles[i], found);
    });

    RenderStats total = total_of(finders);
    total += total_of(drawers);
    return total.mean_over(threads);
}

}  // namespace ink

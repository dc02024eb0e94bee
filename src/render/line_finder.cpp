#include "render/line_finder.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/multiversion.h"
#include "base/timer.h"
#include "render/block_mean.h"

namespace ink {

namespace {

constexpr std::size_t kMostPointsInPixel = std::size_t{kMostLatticePoints} * kMostLatticePoints;

}  // namespace

/// Linear, premultiplied colour of a point of the grid.
INKTRACE_INLINE PixelColor LineFinder::color_at(int i, int j) const {
    const auto [k, place] = lattice_.place_of(i, j);
    const bool empty = k == LatticeBlocks::kEmpty;
    const ColorPacket& colors = empty ? edges_.pipeline.shader.background() : colors_[k];
    const int lane = empty ? 0 : place;
    return {colors.r[lane], colors.g[lane], colors.b[lane], colors.a[lane]};
}

/// What is seen in a mirror must not thin the lines of the mirror.
INKTRACE_INLINE void LineFinder::count(const InkStroke& stroke) {
    const float width = edges_.ink.styles[stroke.style].width_px * stroke.width_scale;
    density_.add(stroke, width);
    if (specular_ && stroke.direct) direct_density_.add(stroke, width);
}

INKTRACE_INLINE void LineFinder::keep_stroke(const Segment& segment) {
    if (!edges_.wanted.has(segment.type) || segment.for_data) return;
    const InkStroke stroke = make_ink_stroke(segment, edges_.style_of(segment));
    // Those between faces are counted by add_face_density.
    if (segment.type != LineType::mesh) count(stroke);
    if (!edges_.draw_lines) return;
    const bool inner = std::min(stroke.a.x, stroke.b.x) >= inner_.left &&
                       std::max(stroke.a.x, stroke.b.x) <= inner_.right &&
                       std::min(stroke.a.y, stroke.b.y) >= inner_.top &&
                       std::max(stroke.a.y, stroke.b.y) <= inner_.bottom;
    (inner ? strokes_ : outer_strokes_).push_back(stroke);
}

/// Whether a point of the grid saw a ball or the background, and which.
INKTRACE_INLINE bool LineFinder::see_ball(int i, int j, BallHit& hit) const {
    const auto [block, lane] = lattice_.place_of(i, j);
    if (block == LatticeBlocks::kEmpty) return true;
    const HitPacket& hits = hits_[block];
    const std::uint32_t object = hits.object[lane];
    if (object == kNoObject) return true;
    hit.id = grid_.id[grid_.index(i, j)];
    hit.surface = {object, hits.primitive[lane]};
    hit.t = hits.t[lane];
    hit.ball = edges_.surfaces.ball(object, hits.primitive[lane]);
    return static_cast<bool>(hit.ball);
}

MeshQueries LineFinder::mesh_queries() {
    return {.cross =
                [this](std::span<const SeenPair> pairs, std::span<MeshCrossing> crossings,
                       std::vector<SurfaceKey>& expected) {
                    mesh_crosser_.cross(pairs, crossings, expected);
                },
            .id_of =
                [this](SurfaceKey key) {
                    return edges_.pipeline.ids.resolve(key.object, key.primitive);
                },
            .identify = identify_,
            .describe = describe_,
            .sample = sample_};
}

TileLines LineFinder::search(const Tile& tile) {
    found_ = {};
    strokes_.clear();
    outer_strokes_.clear();
    const float reach = edges_.stroke_reach();
    inner_ = {static_cast<float>(tile.x0) + reach, static_cast<float>(tile.y0) + reach,
              static_cast<float>(tile.x1) - reach, static_cast<float>(tile.y1) - reach};
    smoothing_.begin(tile);
    trace_lattice(tile);
    if (faces_ != nullptr) map_faces(tile);
    if (ridges_ != nullptr) keep_for_ridges(tile);
    find_lines();
    if (specular_) add_specular();
    // Smoothing goes by what points see: whether one on the next tile's border looks into a slit,
    // that tile alone may know.
    if (front_ && (edges_.find_lines || edges_.smooth_shading)) close_slits();
    if (front_) put_pixels(tile);
    found_.inner = strokes_.size();
    found_.strokes.reserve(strokes_.size() + outer_strokes_.size());  // no more than they are
    found_.strokes.insert(found_.strokes.end(), strokes_.begin(), strokes_.end());
    found_.strokes.insert(found_.strokes.end(), outer_strokes_.begin(), outer_strokes_.end());
    return std::move(found_);
}

void LineFinder::put_pixels(const Tile& tile) {
    const Timer timer(stats_.shade_ms);
    const Timer phase(stats_.film_ms);
    const Size size = edges_.pipeline.film.size();
    const int x0 = std::max(tile.x0, 0);
    const int x1 = std::min(tile.x1, size.width);
    const int y1 = x0 < x1 ? std::min(tile.y1, size.height) : 0;  // it may lie beside the picture
    for (int y = std::max(tile.y0, 0); y < y1; y += kBlockSide) {
        gather_row(x0, x1, y);
        edges_.pipeline.film.put_row(x0, y, block_row_);
        for (int x = x0; edges_.pipeline.aovs && x < x1; x += kBlockSide) put_aovs({x, y});
    }
    Film::finish_rows();
    if (smooths_) keep_fringe(tile);
}

/// A row of blocks of pixels, null where they are background.
void LineFinder::gather_row(int x0, int x1, int y) {
    const bool changes = smooths_ && smoothing_.changes_any();
    const auto count = static_cast<std::size_t>((x1 - x0 + kBlockSide - 1) / kBlockSide);
    block_row_.assign(count, nullptr);
    if (!saw_anything_ && !changes) return;
    mixed_.clear();
    mixed_.reserve(count);  // what points to them stays
    const bool as_traced = edges_.q == 1;
    if (as_traced) {
        const std::span<const std::uint32_t> blocks =
            lattice_.blocks((x0 - grid_.x0) / kBlockSide, (y - grid_.y0) / kBlockSide, count);
        for (std::size_t n = 0; n < count; ++n) {
            const std::uint32_t k = blocks[n];
            if (k != LatticeBlocks::kEmpty && seen_[k] != 0) block_row_[n] = &colors_[k];
        }
        if (!changes) return;
    }
    for (std::size_t n = 0; n < count; ++n) {
        const int x = x0 + static_cast<int>(n) * kBlockSide;
        if (!as_traced || (changes && smoothing_.changes(x, y))) block_row_[n] = mixed_block(x, y);
    }
}

/// The block of pixels at (x, y): the mean over q x q blocks of the lattice, and what lines change.
/// Null if it is background.
const ColorPacket* LineFinder::mixed_block(int x, int y) {
    const int q = edges_.q;
    const int i0 = (x * q - grid_.x0) / kBlockSide;
    const int j0 = (y * q - grid_.y0) / kBlockSide;
    const bool changes = smooths_ && smoothing_.changes(x, y);
    const ColorPacket& background = edges_.pipeline.shader.background();
    std::array<const ColorPacket*, kMostPointsInPixel> blocks;
    bool any = false;
    std::size_t count = 0;
    for (int j = 0; j < q; ++j) {
        for (int i = 0; i < q; ++i) {
            const std::uint32_t k = lattice_.block(i0 + i, j0 + j);
            blocks[count++] = k == LatticeBlocks::kEmpty ? &background : &colors_[k];
            any |= k != LatticeBlocks::kEmpty && seen_[k] != 0;
        }
    }
    if (!any && !changes) return nullptr;
    ColorPacket& mean = mixed_.emplace_back(q == 1 ? *blocks[0] : mean_of_blocks(blocks, q));
    if (changes) smoothing_.apply(x, y, mean);
    return &mean;
}

/// Linear, premultiplied colour of a pixel, counted from the tile's first one, before smoothing.
PixelColor LineFinder::pixel_color(int x, int y) const {
    const int q = edges_.q;
    const float weight = 1.0F / static_cast<float>(q * q);
    PixelColor sum{};
    for (int n = 0; n < q * q; ++n) {
        const PixelColor color = color_at(x * q + n % q, y * q + n / q);
        for (std::size_t c = 0; c < 4; ++c) sum[c] += color[c] * weight;
    }
    return sum;
}

/// Keeps what is needed to finish the pixels to which lines of other tiles may add.
void LineFinder::keep_fringe(const Tile& tile) {
    Fringe& fringe = found_.fringe;
    smoothing_.copy_fringe(fringe);
    if (!saw_anything_) return;
    const int width = tile.x1 - tile.x0;
    const int height = tile.y1 - tile.y0;
    fringe.colors.reserve(static_cast<std::size_t>(width + height - 1));
    if (edges_.q > 1) {
        for (int x = 0; x < width; ++x) fringe.colors.push_back(pixel_color(x, 0));
        for (int y = 1; y < height; ++y) fringe.colors.push_back(pixel_color(0, y));
        return;
    }
    // Block by block, every `step`th of a block's pixels.
    const auto add = [&](int x, int y, int first, int step, int past) {
        const std::uint32_t k = lattice_.block(x / kBlockSide, y / kBlockSide);
        const ColorPacket& own =
            k == LatticeBlocks::kEmpty ? edges_.pipeline.shader.background() : colors_[k];
        for (int lane = first; lane < past * step; lane += step) {
            fringe.colors.push_back({own.r[lane], own.g[lane], own.b[lane], own.a[lane]});
        }
    };
    for (int x = 0; x < width; x += kBlockSide) add(x, 0, 0, 1, std::min(width - x, kBlockSide));
    for (int y = 0; y < height; y += kBlockSide) {
        add(0, y, y == 0 ? kBlockSide : 0, kBlockSide, std::min(height - y, kBlockSide));
    }
}

/// What pixel centres see, whatever the lattice.
void LineFinder::put_aovs(Block block) {
    std::array<HitPacket, 1> hits;
    pixel_sampler_.trace_blocks(std::array{block}, {}, hits);
    edges_.pipeline.aovs->put(block, {}, hits[0]);
}

void LineFinder::find_lines() {
    const Timer timer(stats_.lines_ms);
    if (!edges_.find_lines && !edges_.smooth_shading) return;
    if (front_ && edges_.tones) measure_brightness();
    {
        const Timer phase(stats_.detect_ms);
        DetectSettings settings = edges_.detect;
        if (ids_only_) settings.depths = settings.normals = false;
        suspects_.clear();
        if (saw_anything_ && fills_grid_) detect(grid_, settings, suspects_);
        if (saw_anything_ && !fills_grid_) detect(sample_blocks(), settings, suspects_);
        if (!ids_only_) drop_smooth();
        if (!fills_grid_) put_ends();
    }
    {
        const Timer phase(stats_.locate_ms);
        locate();
        if (crosses_faces()) cross_faces();
    }
    {
        const Timer phase(stats_.connect_ms);
        connector_.connect(grid_, suspects_, crossings_, segments_, face_cells());
        if (front_ && edges_.tones) find_tones();
        if (crosses_faces()) drop_unmarked_faces();
        stats_.crossings += crossings_.size();
    }
    keep();
}

/// While the sampler has the rays of the lattice.
void LineFinder::measure_brightness() {
    brightness_.assign(grid_.id.size(), 1.0F);
    Lanes<float> bright;
    for (std::size_t k = 0; k < lattice_.size(); ++k) {
        edges_.pipeline.shader.brightness(
            {sampler_.packets()[k], sampler_.points()[k], hits_[k], normals_[k]}, bright);
        const Block& block = lattice_[k];
        for (int j = 0; j < block.rows; ++j) {
            for (int i = 0; i < block.columns; ++i) {
                brightness_[grid_.index(block.x - grid_.x0 + i, block.y - grid_.y0 + j)] =
                    bright[j * block.across + i];
            }
        }
    }
}

void LineFinder::find_tones() {
    tone_connector_.connect(grid_, brightness_, suspects_, crossings_, toned_);
    // Lines between faces divide none.
    for (Segment segment : segments_) {
        if (segment.type != LineType::mesh) continue;
        Tones::double_ids(segment);
        toned_.push_back(segment);
    }
}

/// Keeps the segments at hand, and smooths the shading along them.
void LineFinder::keep() {
    if (edges_.attenuates_lines()) {
        for (Segment& segment : segments_) edges_.attenuate(segment);
    }
    if (edges_.halo_px > 0.0F && front_) {
        for (Segment& segment : segments_) segment.gap = gap_behind(segment);
    }
    if (keeps_segments_) {
        found_.segments.insert(found_.segments.end(), segments_.begin(), segments_.end());
    }
    if (front_ && edges_.find_lines) {
        const Timer phase(stats_.connect_ms);
        for (const Segment& segment : segments_) keep_stroke(segment);
    }
    if (smooths_) smooth();
}

void LineFinder::smooth() {
    const Timer phase(stats_.blend_ms);
    const auto width = static_cast<std::uint64_t>(grid_.width);
    // Divides by the width: exact while width times index stays below 2^32.
    const std::uint64_t per_width = (std::uint64_t{1} << 32U) / width + 1;
    const auto color = [&](std::uint64_t index) {
        const std::uint64_t row = (index * per_width) >> 32U;
        return color_at(static_cast<int>(index - row * width), static_cast<int>(row));
    };
    for (const Segment& segment : segments_) {
        // The two sides of a line on a smooth surface have one colour.
        if (!segment.spans_cell || segment.type == LineType::mesh) continue;
        smoothing_.add(segment, color(segment.left_sample), color(segment.right_sample));
    }
    smoothing_.finish();
}

/// Zero where the background is what lies behind, or nothing does.
float LineFinder::gap_behind(const Segment& segment) const {
    if (segment.level > 0) return 0.0F;
    const std::uint32_t far = segment.left_in_front ? segment.right_sample : segment.left_sample;
    if (grid_.id[far] == kBackground) return 0.0F;
    return std::max(grid_.t[far] - segment.t, 0.0F);
}

void LineFinder::add_specular() {
    const Timer timer(stats_.lines_ms);
    if (!edges_.find_lines && !edges_.smooth_shading) return;
    segments_.clear();
    specular_->search(suspects_, crossings_, segments_);
    keep();
}

/// Between balls and between meshes by computing, between others by asking for samples.
void LineFinder::locate() {
    crossings_.clear();
    others_.clear();
    mesh_edges_.clear();
    ball_locator_.begin();
    const bool one_set = ids_only_ && edges_.balls;
    if (one_set) ball_locator_.add(grid_, suspects_, *edges_.balls);
    for (std::uint32_t k = 0; !one_set && k < suspects_.size(); ++k) {
        const SuspectEdge& edge = suspects_[k];
        const int i = edge.i + (edge.down ? 0 : 1);
        const int j = edge.j + (edge.down ? 1 : 0);
        MeshEdge meshes{k, {}, {}};
        if (front_ && edges_.has_meshes && see_mesh(edge.i, edge.j, meshes.first) &&
            see_mesh(i, j, meshes.second)) {
            mesh_edges_.push_back(meshes);
            continue;
        }
        BallHit first;
        BallHit second;
        if (front_ && see_ball(edge.i, edge.j, first) && see_ball(i, j, second) &&
            first.surface != second.surface) {
            ball_locator_.add(k, grid_.point(edge.i, edge.j), grid_.point(i, j), first, second);
        } else {
            others_.push_back(k);
        }
    }
    ball_locator_.locate(identify_, crossings_, others_);
    mesh_locator_.locate(grid_, suspects_, mesh_edges_, crossings_, others_);
    locator_.locate_some(grid_, suspects_, others_, describe_, sample_, crossings_);
}

/// What a lattice point sees through a slit too narrow for a line would be a speck in the picture:
/// it takes the colour of what is beside it. Only by edges that begin in it, which belong to its
/// own tile, and from what its neighbour sees itself: all that, no tile but its own need know.
void LineFinder::close_slits() {
    closed_.clear();
    for (const auto slits : {mesh_locator_.slits(), locator_.slits()}) {
        for (const std::uint32_t k : slits) {
            const SuspectEdge& edge = suspects_[k];
            const LatticeBlocks::Place place = lattice_.place_of(edge.i, edge.j);
            if (place.packet == LatticeBlocks::kEmpty) continue;
            const int i = edge.i + (edge.down ? 0 : 1);
            const int j = edge.j + (edge.down ? 1 : 0);
            closed_.push_back({place, edge.down, color_at(i, j)});
            // What lines change is reckoned from what the point saw.
            if (smooths_) smoothing_.leave(grid_.x0 + edge.i, grid_.y0 + edge.j);
        }
    }
    // Where slits run on both sides, the one on the right counts.
    std::ranges::stable_partition(closed_, &ClosedPoint::down);
    for (const auto& [place, down, color] : closed_) {
        ColorPacket& colors = colors_[place.packet];
        colors.r[place.lane] = color[0];
        colors.g[place.lane] = color[1];
        colors.b[place.lane] = color[2];
        colors.a[place.lane] = color[3];
        seen_[place.packet] = 1;
    }
}

/// Whether a point of the grid saw a mesh that can be walked on or the background, and where.
bool LineFinder::see_mesh(int i, int j, SurfaceKey& key) const {
    const auto [block, lane] = lattice_.place_of(i, j);
    if (block == LatticeBlocks::kEmpty) return true;
    const std::uint32_t object = hits_[block].object[lane];
    if (object == kNoObject) return true;
    key = {object, hits_[block].primitive[lane]};
    return edges_.mesh_walk.knows(object);
}

void LineFinder::identify(std::span<const Vec2f> points, std::span<SurfaceKey> out) {
    if (points.empty()) return;
    sampler_.identify_points(points, point_hits_);
    for (std::size_t n = 0; n < points.size(); ++n) {
        const HitPacket& hits = point_hits_[n / kLanes];
        const auto lane = static_cast<int>(n % kLanes);
        const bool miss = hits.object[lane] == kNoObject;
        out[sampler_.order()[n]] =
            miss ? SurfaceKey{} : SurfaceKey{hits.object[lane], hits.primitive[lane]};
    }
}

/// Drops suspects where the scene rules out a line that the samples alone let suspect.
void LineFinder::drop_smooth() {
    const auto number = [&](int i, int j) {
        if (fills_grid_) return grid_.surface[grid_.index(i, j)];
        const LatticeBlocks::Place place = lattice_.place_of(i, j);
        return surfaces_[place.packet][place.lane];
    };
    first_numbers_.clear();
    second_numbers_.clear();
    for (const SuspectEdge& edge : suspects_) {
        if (edge.suspicion == Suspicion::id) continue;
        first_numbers_.push_back(number(edge.i, edge.j));
        second_numbers_.push_back(
            number(edge.i + (edge.down ? 0 : 1), edge.j + (edge.down ? 1 : 0)));
    }
    smooth_edges_.resize(first_numbers_.size());
    edges_.surfaces.find_smooth_edges(edges_.viewpoint, first_numbers_, second_numbers_,
                                      smooth_edges_);
    std::size_t next = 0;
    std::erase_if(suspects_, [&](const SuspectEdge& edge) {
        if (edge.suspicion == Suspicion::id) return false;
        const std::size_t k = next++;
        return smooth_edges_[k] != Mesh::kNoTwin ||
               (first_numbers_[k] >= SampleGrid::kUnknownSurface && is_smooth(edge));
    });
}

bool LineFinder::is_smooth(const SuspectEdge& edge) const {
    const int i = edge.i + (edge.down ? 0 : 1);
    const int j = edge.j + (edge.down ? 1 : 0);
    const LatticeHit a = hit_at(edge.i, edge.j);
    const LatticeHit b = hit_at(i, j);
    // Of meshes, no places are needed.
    if (!fills_grid_) return edges_.surfaces.smooth_between(*a.hits, a.lane, *b.hits, b.lane);
    const auto position = [&](std::size_t k) -> Vec3f {
        return {grid_.px[k], grid_.py[k], grid_.pz[k]};
    };
    const Vec3f at_a = position(grid_.index(edge.i, edge.j));
    const Vec3f at_b = position(grid_.index(i, j));
    return edges_.surfaces.smooth_between(*a.hits, a.lane, &at_a, *b.hits, b.lane, &at_b);
}

}  // namespace ink

#include "render/line_finder.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/multiversion.h"
#include "base/timer.h"

namespace ink {

/// A few blocks at a time, so that the hits of a block are still in the nearest cache when it is
/// shaded and its samples go to the grid.
void LineFinder::trace_lattice(const Tile& tile) {
    LapTimer timer;
    const int q = edges_.q;
    // Cells hang on their upper left point, so the tile needs one more column and row of points.
    grid_.x0 = tile.x0 * q;
    grid_.y0 = tile.y0 * q;
    grid_.spacing = 1.0F / static_cast<float>(q);
    grid_.resize((tile.x1 - tile.x0) * q + 1, (tile.y1 - tile.y0) * q + 1);
    if (fills_grid_) std::ranges::fill(grid_.id, kBackground);
    if (fills_grid_ && !ids_only_) grid_.surface.resize(grid_.id.size());

    // The last column and row of blocks reach beyond the grid, but for strips.
    const float beyond = static_cast<float>(lays_strips() ? 1 : kBlockSide) * grid_.spacing;
    sampler_.enter({static_cast<float>(tile.x0), static_cast<float>(tile.y0),
                    static_cast<float>(tile.x1) + beyond, static_cast<float>(tile.y1) + beyond});

    // Of points that are shaded with an eye to their neighbours, all tiles must see the same ones.
    lattice_.lay(grid_, sampler_, lays_strips(), edges_.pipeline.shader.compares_neighbours());
    make_room();
    seen_.assign(lattice_.size(), 0);
    sampler_.find_blocks(lattice_.packets(), {});
    saw_anything_ = false;
    if (face_density_) face_density_->enter(grid_.x0, grid_.y0, grid_.width, grid_.height);
    const std::size_t run = takes_shades_ ? 32 : 16;  // rays take as much room as all else
    for (std::size_t first = 0; first < lattice_.size(); first += run) {
        const std::size_t count = std::min(run, lattice_.size() - first);
        take(first, count);
        timer.lap(stats_.trace_ms);
        if (borders_ != nullptr) {
            map_borders(first, count);
            timer.lap(stats_.lines_ms);
        }
        if (tiling_ != nullptr) {
            map_tiling(first, count);
            timer.lap(stats_.lines_ms);
        }
        if (front_) shade(first, count);
        timer.lap(stats_.shade_ms);
    }
    if (!specular_) return;
    specular_->follow(grid_,
                      {lattice_.packets(), sampler_.packets(), sampler_.points(), hits_, normals_},
                      colors_);
    timer.lap(stats_.shade_ms);
}

void LineFinder::make_room() {
    hits_.resize(std::max(hits_.size(), lattice_.size()));
    colors_.resize(hits_.size());
    // Strips are cut into so many blocks.
    const std::size_t cut = kLanes / kBlockSide * lattice_.strips();
    normals_.resize(hits_.size() + cut);
    if (takes_shades_ && !ids_only_) places_.resize(normals_.size());
    if (fills_grid_) return;
    ids_.resize(normals_.size());
    surfaces_.resize(normals_.size());
}

/// Whether points of one more column and row than blocks have are traced in strips.
bool LineFinder::lays_strips() const {
    return sampler_.rays_travel_alone() && !specular_ &&
           !edges_.pipeline.shader.compares_neighbours();
}

/// Whether nothing needs more of the lattice than where it hit, and one normal.
bool LineFinder::can_take_shades() const {
    const Shader& shader = edges_.pipeline.shader;
    return shader.needs_normals_only() && !shader.has_line_normals() && !edges_.tones && !specular_;
}

/// Their hits, normals and samples.
void LineFinder::take(std::size_t first, std::size_t count) {
    const auto hits = std::span(hits_).subspan(first, count);
    if (takes_shades_) {
        const auto places =
            ids_only_ ? std::span<PlacePacket>() : std::span(places_).subspan(first, count);
        sampler_.take_shades(first, hits, std::span(normals_).subspan(first, count), places);
    } else {
        sampler_.take_hits(first, hits);
        for (const HitPacket& packet : hits) edges_.pipeline.shader.prefetch(packet);
    }
    if (!fills_grid_) name_samples(first, count);
    for (std::size_t k = first; k < first + count; ++k) {
        if (std::ranges::all_of(hits_[k].object, [](auto object) { return object == kNoObject; })) {
            continue;  // the grid is background so far
        }
        saw_anything_ = true;
        if (!fills_grid_) continue;
        if (!takes_shades_) edges_.pipeline.shader.smooth(hits_[k], normals_[k]);
        fill_grid(k);
    }
}

namespace {

/// Positions, normals and t of a packet.
INKTRACE_INLINE void locate_lanes(const RayPacket& rays, const HitPacket& hits,
                                  const NormalPacket& normals,
                                  std::array<Lanes<float>, 7>& __restrict values) {
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

INKTRACE_MULTIVERSION
void locate_hits(const RayPacket& rays, const HitPacket& hits, const NormalPacket& normals,
                 std::array<Lanes<float>, 7>& __restrict values) {
    locate_lanes(rays, hits, normals, values);
}

/// Where places are known.
INKTRACE_MULTIVERSION
void copy_hits(const PlacePacket& places, const HitPacket& hits, const NormalPacket& normals,
               std::array<Lanes<float>, 7>& __restrict values) {
    for (int i = 0; i < kLanes; ++i) {
        const bool hit = hits.object[i] != kNoObject;
        values[0][i] = places.x[i];
        values[1][i] = places.y[i];
        values[2][i] = places.z[i];
        values[3][i] = normals.x[i];
        values[4][i] = normals.y[i];
        values[5][i] = normals.z[i];
        values[6][i] = hit ? hits.t[i] : 0.0F;
    }
}

}  // namespace

void LineFinder::fill_grid(std::size_t block) {
    Lanes<GeometryId> ids;
    edges_.pipeline.ids.resolve(hits_[block], ids);
    if (ids_only_) {
        copy_to_grid(block, ids.data(), grid_.id.data());
        if (edges_.balls) copy_to_grid(block, hits_[block].t.data(), grid_.t.data());
        return;
    }
    std::array<Lanes<float>, 7> values;
    const Shader& shader = edges_.pipeline.shader;
    NormalPacket separate;
    if (shader.has_line_normals()) shader.line_normals(hits_[block], separate);
    const NormalPacket& normals = shader.has_line_normals() ? separate : normals_[block];
    if (takes_shades_) {
        copy_hits(places_[block], hits_[block], normals, values);
    } else {
        locate_hits(sampler_.packets()[block], hits_[block], normals, values);
    }
    copy_to_grid(block, ids.data(), grid_.id.data());
    const std::array<float*, 7> planes{grid_.px.data(), grid_.py.data(), grid_.pz.data(),
                                       grid_.nx.data(), grid_.ny.data(), grid_.nz.data(),
                                       grid_.t.data()};
    for (std::size_t k = 0; k < planes.size(); ++k) {
        copy_to_grid(block, values[k].data(), planes[k]);
    }
    Lanes<std::uint32_t> surfaces;
    edges_.surfaces.number(hits_[block], surfaces);
    copy_to_grid(block, surfaces.data(), grid_.surface.data());
}

/// Copies the values of a block to their places in a plane of the grid.
template <class T>
void LineFinder::copy_to_grid(std::size_t block, const T* from, T* plane) const {
    const Block& place = lattice_[block];
    T* to = plane + grid_.index(place.x - grid_.x0, place.y - grid_.y0);
    if (place.columns == kBlockSide && place.rows == kBlockSide) {
        for (int j = 0; j < kBlockSide; ++j) {
            std::copy_n(from + j * kBlockSide, kBlockSide, to + j * grid_.width);
        }
        return;
    }
    for (int j = 0; j < place.rows; ++j) {
        // A size known to the compiler makes each row one move.
        if (place.columns == kBlockSide) {
            std::copy_n(from, kBlockSide, to);
        } else {
            std::copy_n(from, place.columns, to);
        }
        from += place.across;
        to += grid_.width;
    }
}

/// IDs and surfaces of samples, for where the grid is not filled.
void LineFinder::name_samples(std::size_t first, std::size_t count) {
    edges_.pipeline.ids.resolve(std::span(hits_).subspan(first, count), ids_.data() + first);
    for (std::size_t k = first; k < first + count; ++k) {
        edges_.surfaces.number(hits_[k], surfaces_[k]);
    }
}

/// The samples as they were traced, and what strips add to them.
SampleBlocks LineFinder::sample_blocks() {
    const auto blocks_for = [](int points) { return (points + kBlockSide - 1) / kBlockSide; };
    const int across = blocks_for(grid_.width);
    const int down = blocks_for(grid_.height);
    cut_ = lattice_.size();
    sample_block_at_.clear();
    for (int j = 0; j < down; ++j) {
        for (int i = 0; i < across; ++i) {
            const auto [k, lane] = lattice_.place_of(i * kBlockSide, j * kBlockSide);
            const bool cuts = k != LatticeBlocks::kEmpty && lattice_[k].is_strip();
            sample_block_at_.push_back(cuts ? cut_strip(k, lane) : k);
        }
    }
    static_assert(LatticeBlocks::kEmpty == SampleBlocks::kNothing);
    return {grid_.width, grid_.height,     across,         down,           sample_block_at_,
            ids_.data(), surfaces_.data(), places_.data(), normals_.data()};
}

/// Four samples of a strip, from the one in a lane on, as the first column or row of a block.
std::uint32_t LineFinder::cut_strip(std::uint32_t strip, int first) {
    const bool down = lattice_[strip].across == 1;
    const std::size_t to = cut_++;
    for (int n = 0; n < kBlockSide; ++n) {
        const int from = first + n;
        const int lane = down ? n * kBlockSide : n;
        ids_[to][lane] = ids_[strip][from];
        surfaces_[to][lane] = surfaces_[strip][from];
        for (const auto axis : {&Vec3Lanes::x, &Vec3Lanes::y, &Vec3Lanes::z}) {
            (places_[to].*axis)[lane] = (places_[strip].*axis)[from];
            (normals_[to].*axis)[lane] = (normals_[strip].*axis)[from];
        }
    }
    return static_cast<std::uint32_t>(to);
}

/// Fills the grid where edges are suspect, but for places and normals, which `describe` adds.
void LineFinder::put_ends() {
    for (const SuspectEdge& edge : suspects_) {
        put_end(edge.i, edge.j);
        put_end(edge.i + (edge.down ? 0 : 1), edge.j + (edge.down ? 1 : 0));
    }
}

void LineFinder::put_end(int i, int j) {
    const std::size_t n = grid_.index(i, j);
    const auto [k, lane] = lattice_.place_of(i, j);
    const GeometryId id = k == LatticeBlocks::kEmpty ? kBackground : ids_[k][lane];
    grid_.id[n] = id;
    grid_.t[n] = id == kBackground ? 0.0F : hits_[k].t[lane];
}

void LineFinder::keep_for_ridges(const Tile& tile) {
    const Timer timer(stats_.lines_ms);
    const Timer phase(stats_.ridges_ms);
    ridges_->keep(tile, {lattice_.packets(), hits_, normals_, saw_anything_});
}

void LineFinder::shade(std::size_t first, std::size_t count) {
    const Pipeline& pipeline = edges_.pipeline;
    for (std::size_t k = first; k < first + count; ++k) {
        if (takes_shades_) {
            seen_[k] =
                pipeline.shader.shade(hits_[k], normals_[k], lattice_[k].is_strip(), colors_[k])
                    ? 1
                    : 0;
            continue;
        }
        const SurfacePacket surface{sampler_.packets()[k], sampler_.points()[k], hits_[k],
                                    normals_[k]};
        seen_[k] = pipeline.shader.shade(surface, colors_[k]) ? 1 : 0;
    }
}

void LineFinder::describe(std::size_t point, Sample& sample) const {
    if (sample.id == kBackground) return;
    const auto width = static_cast<std::size_t>(grid_.width);
    const auto i = static_cast<int>(point % width);
    const auto j = static_cast<int>(point / width);
    if (!fills_grid_) {
        const auto [k, lane] = lattice_.place_of(i, j);
        sample.position = {places_[k].x[lane], places_[k].y[lane], places_[k].z[lane]};
        sample.normal = {normals_[k].x[lane], normals_[k].y[lane], normals_[k].z[lane]};
    }
    const LatticeHit hit = hit_at(i, j);
    edges_.surfaces.describe(*hit.hits, hit.lane, sample);
    if (!front_) sample.ball = {};  // its outline and seams may lie on another layer
    if (!ids_only_) return;
    // Rarely asked for: the ray is made once more.
    const Vec2f place = grid_.point(i, j);
    RayPacket ray;
    edges_.pipeline.camera.make_rays(Lanes<float>::filled(place.x), Lanes<float>::filled(place.y),
                                     ray);
    sample.t = hit.hits->t[hit.lane];
    sample.position = Vec3f{ray.origin_x[0], ray.origin_y[0], ray.origin_z[0]} +
                      Vec3f{ray.dir_x[0], ray.dir_y[0], ray.dir_z[0]} * sample.t;
    sample.normal = sample.facet;
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
            Sample& sample = out[sampler_.order()[first + n]];
            sample = {ids[i],
                      {values[0][i], values[1][i], values[2][i]},
                      {values[3][i], values[4][i], values[5][i]},
                      values[6][i]};
            edges_.surfaces.describe(point_hits_[k], i, sample);
            if (!front_) sample.ball = {};
        }
    }
}

}  // namespace ink

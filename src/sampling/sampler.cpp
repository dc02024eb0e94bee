#include "sampling/sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/multiversion.h"

namespace ink {

namespace {

/// The points of a block, not shifted.
INKTRACE_INLINE void lay_points(float spacing, Block block, PointPacket& points) {
    const int mask = block.across - 1;
    const int shift = std::countr_zero(static_cast<unsigned>(block.across));
    for (int i = 0; i < kLanes; ++i) {
        const int column = i & mask;
        const int row = i >> shift;
        points.x[i] = (static_cast<float>(block.x + column) + 0.5F) * spacing;
        points.y[i] = (static_cast<float>(block.y + row) + 0.5F) * spacing;
        points.active[i] =
            -static_cast<int>(block.whole || (column < block.columns && row < block.rows));
    }
}

INKTRACE_INLINE void shift(const PointPacket& points, Vec2f by, PointPacket& shifted) {
    for (int i = 0; i < kLanes; ++i) shifted.x[i] = points.x[i] + by.x;
    for (int i = 0; i < kLanes; ++i) shifted.y[i] = points.y[i] + by.y;
    shifted.active = points.active;
}

INKTRACE_MULTIVERSION
void place_blocks(float spacing, std::span<const Block> blocks, Vec2f offset, PointPacket* points) {
    for (const Block block : blocks) {  // a copy: nothing that the loop writes can change it
        PointPacket at_zero;
        lay_points(spacing, block, at_zero);
        shift(at_zero, offset, *points++);
    }
}

/// One block, at each of the shifts from `offset`.
INKTRACE_MULTIVERSION
void place_shifted(float spacing, Block block, Vec2f offset, std::span<const Vec2f> shifts,
                   PointPacket* points) {
    PointPacket at_zero;
    lay_points(spacing, block, at_zero);
    for (const Vec2f by : shifts) shift(at_zero, offset + by, *points++);
}

INKTRACE_MULTIVERSION
void make_rays(const Camera& camera, std::span<const PointPacket> points, RayPacket* rays) {
    for (const PointPacket& packet : points) {
        camera.make_rays(packet.x, packet.y, *rays);
        for (int i = 0; i < kLanes; ++i) rays->active[i] = packet.active[i];
        ++rays;
    }
}

INKTRACE_MULTIVERSION
void face_viewer(const RayPacket* rays, std::span<HitPacket> hits) {
    for (HitPacket& hit : hits) {
        const RayPacket& ray = *rays++;
        for (int i = 0; i < kLanes; ++i) {
            const float x = hit.normal_x[i];
            const float y = hit.normal_y[i];
            const float z = hit.normal_z[i];
            const float along = x * ray.dir_x[i] + y * ray.dir_y[i] + z * ray.dir_z[i];
            const float length = std::sqrt(x * x + y * y + z * z);
            // Zero where there is no hit.
            const float scale = length > 0.0F ? (along > 0.0F ? -1.0F : 1.0F) / length : 0.0F;
            hit.normal_x[i] = x * scale;
            hit.normal_y[i] = y * scale;
            hit.normal_z[i] = z * scale;
        }
    }
}

void extend(ScreenBox& box, Vec2f p) {
    box = {std::min(box.left, p.x), std::min(box.top, p.y), std::max(box.right, p.x),
           std::max(box.bottom, p.y)};
}

constexpr ScreenBox kEmptyBox{kInfinity, kInfinity, -kInfinity, -kInfinity};

/// Points of a lattice that blocks have, from the first ones to those before the last ones.
struct LatticeBounds {
    int left = std::numeric_limits<int>::max();
    int top = left;
    int right = std::numeric_limits<int>::min();
    int bottom = right;
    std::size_t points = 0;  ///< of all blocks

    explicit LatticeBounds(std::span<const Block> blocks) { add(blocks); }

    void add(std::span<const Block> blocks) {
        for (const Block& block : blocks) {
            const int columns = block.whole ? kBlockSide : block.columns;
            const int rows = block.whole ? kBlockSide : block.rows;
            left = std::min(left, block.x);
            top = std::min(top, block.y);
            right = std::max(right, block.x + columns);
            bottom = std::max(bottom, block.y + rows);
            points += static_cast<std::size_t>(columns * rows);
        }
    }

    ScreenBox on_screen(float spacing, Vec2f offset) const {
        if (points == 0) return kEmptyBox;
        const auto at = [&](int point) { return static_cast<float>(point) * spacing; };
        return {at(left) + offset.x, at(top) + offset.y, at(right) + offset.x,
                at(bottom) + offset.y};
    }
};

/// The strips among blocks, which come last.
std::span<const Block> strips_of(std::span<const Block> blocks) {
    std::size_t count = 0;
    while (count < blocks.size() && blocks[blocks.size() - 1 - count].is_strip()) ++count;
    return blocks.last(count);
}

ScreenBox bounds(std::span<const Vec2f> points) {
    ScreenBox box = kEmptyBox;
    for (const Vec2f p : points) extend(box, p);
    return box;
}

ScreenBox shifted(const ScreenBox& box, Vec2f by) {
    return {box.left + by.x, box.top + by.y, box.right + by.x, box.bottom + by.y};
}

}  // namespace

void Sampler::enter(const ScreenBox& area) {
    area_ = area;
    tracer_->enter(area);
}

bool Sampler::reaches(const ScreenBox& box) const {
    const ScreenBox& scene = camera_.scene_box();
    return box.right > scene.left && box.left < scene.right && box.bottom > scene.top &&
           box.top < scene.bottom && tracer_->reaches(box);
}

bool Sampler::entered(const ScreenBox& box) const {
    return box.left >= area_.left && box.right <= area_.right && box.top >= area_.top &&
           box.bottom <= area_.bottom;
}

void Sampler::trace_blocks(std::span<const Block> blocks, Vec2f offset, std::span<HitPacket> hits) {
    find_blocks(blocks, offset);
    take_hits(0, hits.first(blocks.size()));
}

void Sampler::find_blocks(std::span<const Block> blocks, Vec2f offset) {
    const std::span<const Block> strips = strips_of(blocks);
    const std::span<const Block> squares = blocks.first(blocks.size() - strips.size());
    const LatticeBounds on_raster(squares);
    LatticeBounds bounds = on_raster;
    bounds.add(strips);
    const ScreenBox box = bounds.on_screen(spacing_, offset);
    if (!entered(box)) enter(box);
    rays_ += bounds.points;
    // A few blocks find their own way faster.
    const std::size_t few = wants_borders_ ? 0 : 4;
    found_ = squares.size() > few;
    // Where points lie on a raster is known without them.
    const std::size_t placed = found_ && wants_shades_ ? squares.size() : 0;
    const std::span<PointPacket> points = place(blocks.size());
    place_blocks(spacing_, blocks.subspan(placed), offset, points.subspan(placed).data());
    if (!wants_shades_) make_room();
    if (found_) {
        BlockRaster raster{on_raster.left,
                           on_raster.top,
                           on_raster.right - on_raster.left,
                           on_raster.bottom - on_raster.top,
                           spacing_,
                           offset,
                           {},
                           squares.size()};
        lay_cells(squares, raster);
        tracer_->find(raster, points);
    } else if (wants_shades_) {
        tracer_->find({}, points);
    }
}

void Sampler::want_borders() {
    wants_borders_ = true;
    tracer_->want_borders();
}

void Sampler::take_borders(std::size_t first, std::span<BorderPacket> borders) {
    if (found_) tracer_->measure(first, borders);
}

bool Sampler::take_sides(std::size_t first, std::span<SidesPacket> sides) {
    return found_ && tracer_->find_sides(first, sides);
}

void Sampler::take_hits(std::size_t first, std::span<HitPacket> hits) {
    const auto points = this->points().subspan(first, hits.size());
    const auto rays = std::span(packets_).subspan(first, hits.size());
    make_rays(camera_, points, rays.data());
    if (found_) {
        tracer_->resolve(first, points, rays, hits);
    } else {
        tracer_->intersect(points, rays, hits);
    }
    face_viewer(rays.data(), hits);
}

bool Sampler::want_shades() {
    wants_shades_ = sees_without_rays_;
    if (wants_shades_) tracer_->want_shades();
    return wants_shades_;
}

void Sampler::want_points_only() {
    wants_borders_ = false;
    wants_shades_ = false;
    tracer_->want_points_only();
}

void Sampler::take_shades(std::size_t first, std::span<HitPacket> hits,
                          std::span<NormalPacket> normals, std::span<PlacePacket> places) {
    tracer_->see(first, hits, normals, places);
}

/// Room for the points of a call. What was made before is not cleared again.
std::span<PointPacket> Sampler::place(std::size_t packets) {
    if (points_.size() < packets) points_.resize(packets);
    placed_ = packets;
    return {points_.data(), packets};
}

/// The same for their rays.
void Sampler::make_room() {
    if (packets_.size() < placed_) packets_.resize(placed_);
}

/// Tells a raster which blocks its cells are. Blocks are aligned to each other, and all but those
/// of the last column and row have all of their points.
void Sampler::lay_cells(std::span<const Block> blocks, BlockRaster& raster) {
    const int across = raster.across();
    cells_.assign(static_cast<std::size_t>(across) * static_cast<std::size_t>(raster.down()),
                  BlockRaster::kNone);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        const int column = (blocks[k].x - raster.x) / kBlockSide;
        const int row = (blocks[k].y - raster.y) / kBlockSide;
        cells_[static_cast<std::size_t>(row * across + column)] = static_cast<std::uint32_t>(k);
    }
    raster.packet_at = cells_;
}

void Sampler::place_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil) {
    block.columns = kBlockSide;
    block.rows = kBlockSide;
    place(stencil.size());
    place_shifted(spacing_, block, offset, stencil, points_.data());
    const ScreenBox own = LatticeBounds({&block, 1}).on_screen(spacing_, offset);
    const ScreenBox reach = bounds(stencil);
    const ScreenBox box{own.left + reach.left, own.top + reach.top, own.right + reach.right,
                        own.bottom + reach.bottom};
    if (!entered(box)) enter(box);
    rays_ += stencil.size() * kLanes;
}

void Sampler::trace_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil,
                             std::span<HitPacket> hits) {
    place_stencils(block, offset, stencil);
    trace(hits);
}

void Sampler::identify_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil,
                                std::span<HitPacket> hits) {
    place_stencils(block, offset, stencil);
    identify(hits);
}

void Sampler::identify(std::span<HitPacket> hits) {
    std::span<const RayPacket> rays;
    if (tracer_->needs_rays()) {
        make_room();
        make_rays(camera_, points(), packets_.data());
        rays = packets();
    }
    tracer_->identify(points(), rays, hits.first(placed_));
}

bool Sampler::covers(std::uint32_t object, std::uint32_t primitive, Block block, Vec2f offset,
                     std::span<const Vec2f> stencil) {
    const ScreenBox reach = bounds(stencil);
    const auto first = [&](int at) { return (static_cast<float>(at) + 0.5F) * spacing_; };
    const auto last = [&](int at) { return first(at + kBlockSide - 1); };
    const ScreenBox own =
        shifted({first(block.x), first(block.y), last(block.x), last(block.y)}, offset);
    const ScreenBox box{own.left + reach.left, own.top + reach.top, own.right + reach.right,
                        own.bottom + reach.bottom};
    return entered(box) && tracer_->covers(object, primitive, box);
}

void Sampler::complete(std::size_t k, HitPacket& hits) {
    RayPacket rays;
    make_rays(camera_, {&points_[k], 1}, &rays);
    tracer_->intersect({&points_[k], 1}, {&rays, 1}, {&hits, 1});
    face_viewer(&rays, {&hits, 1});
}

void Sampler::trace_points(std::span<const Vec2f> points, std::vector<HitPacket>& hits) {
    place_points(points);
    hits.resize(placed_);
    trace(hits);
}

void Sampler::identify_points(std::span<const Vec2f> points, std::vector<HitPacket>& hits) {
    place_points(points);
    hits.resize(placed_);
    identify(hits);
}

void Sampler::place_points(std::span<const Vec2f> points) {
    const ScreenBox box = bounds(points);
    rays_ += points.size();
    sort_by_place(points, box);
    const std::size_t count = (points.size() + kLanes - 1) / kLanes;
    place(count);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t first = k * kLanes;
        for (int i = 0; i < kLanes; ++i) {
            const std::size_t n = std::min(first + static_cast<std::size_t>(i), points.size() - 1);
            const Vec2f point = points[order_[n]];
            points_[k].x[i] = point.x;
            points_[k].y[i] = point.y;
            points_[k].active[i] = first + static_cast<std::size_t>(i) < points.size() ? -1 : 0;
        }
    }
    if (!entered(box)) enter(box);
}

/// Counting sort by squares of the screen, row by row; their side suits a packet of points along a
/// line.
void Sampler::sort_by_place(std::span<const Vec2f> points, const ScreenBox& box) {
    constexpr float kSide = 8.0F;
    const auto square = [](float at, float from) {
        return static_cast<std::uint32_t>((at - from) * (1.0F / kSide));
    };
    const std::uint32_t across = square(box.right, box.left) + 1;
    const std::uint32_t down = square(box.bottom, box.top) + 1;
    starts_.assign(std::size_t{across} * down + 1, 0);
    places_.resize(points.size());
    order_.resize(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
        const std::uint32_t row = square(points[n].y, box.top);
        const std::uint32_t column = square(points[n].x, box.left);
        // Every other row backwards: squares that follow each other touch.
        places_[n] = row * across + (row % 2 == 0 ? column : across - 1 - column);
        ++starts_[places_[n] + 1];
    }
    for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
    for (std::size_t n = 0; n < points.size(); ++n) {
        order_[starts_[places_[n]]++] = static_cast<std::uint32_t>(n);
    }
}

void Sampler::trace(std::span<HitPacket> hits) {
    make_room();
    make_rays(camera_, points(), packets_.data());
    const std::span<HitPacket> traced = hits.first(placed_);
    tracer_->intersect(points(), packets(), traced);
    face_viewer(packets_.data(), traced);
}

}  // namespace ink

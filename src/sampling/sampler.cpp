#include "sampling/sampler.h"

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"

namespace ink {

namespace {

INKTRACE_INLINE void make_block_rays(const Camera& camera, float spacing, Block block, Vec2f offset,
                                     RayPacket& rays) {
    Lanes<float> x;
    Lanes<float> y;
    for (int i = 0; i < kLanes; ++i) {
        x[i] = (static_cast<float>(block.x + i % kBlockSide) + 0.5F) * spacing + offset.x;
        y[i] = (static_cast<float>(block.y + i / kBlockSide) + 0.5F) * spacing + offset.y;
    }
    camera.make_rays(x, y, rays);
}

INKTRACE_MULTIVERSION
void make_rays(const Camera& camera, float spacing, std::span<const Block> blocks, Vec2f offset,
               RayPacket* rays) {
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        make_block_rays(camera, spacing, blocks[k], offset, rays[k]);
        for (int i = 0; i < kLanes; ++i) {
            const bool wanted =
                i % kBlockSide < blocks[k].columns && i / kBlockSide < blocks[k].rows;
            rays[k].active[i] = wanted ? -1 : 0;
        }
    }
}

INKTRACE_MULTIVERSION
void make_rays(const Camera& camera, float spacing, Block block, Vec2f offset,
               std::span<const Vec2f> stencil, RayPacket* rays) {
    for (std::size_t k = 0; k < stencil.size(); ++k) {
        make_block_rays(camera, spacing, block, offset + stencil[k], rays[k]);
        rays[k].active.fill(-1);
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

}  // namespace

void Sampler::trace_blocks(std::span<const Block> blocks, Vec2f offset, std::span<HitPacket> hits) {
    packets_.resize(blocks.size());
    make_rays(camera_, spacing_, blocks, offset, packets_.data());
    trace(true, hits);
}

void Sampler::trace_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil,
                             bool with_normals, std::span<HitPacket> hits) {
    packets_.resize(stencil.size());
    make_rays(camera_, spacing_, block, offset, stencil, packets_.data());
    trace(with_normals, hits);
}

void Sampler::turn_to_viewer(std::size_t k, HitPacket& hits) const {
    face_viewer(&packets_[k], {&hits, 1});
}

void Sampler::trace_points(std::span<const Vec2f> points, std::vector<HitPacket>& hits) {
    const std::size_t count = (points.size() + kLanes - 1) / kLanes;
    packets_.resize(count);
    hits.resize(count);
    Lanes<float> x;
    Lanes<float> y;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t first = k * kLanes;
        for (int i = 0; i < kLanes; ++i) {
            const Vec2f point =
                points[std::min(first + static_cast<std::size_t>(i), points.size() - 1)];
            x[i] = point.x;
            y[i] = point.y;
            packets_[k].active[i] = first + static_cast<std::size_t>(i) < points.size() ? -1 : 0;
        }
        camera_.make_rays(x, y, packets_[k]);
    }
    trace(true, hits);
}

void Sampler::trace(bool with_normals, std::span<HitPacket> hits) {
    const std::span<HitPacket> traced = hits.first(packets_.size());
    tracer_.intersect(packets_, traced, Coherence::coherent);
    if (with_normals) face_viewer(packets_.data(), traced);
    for (const RayPacket& packet : packets_) {
        for (int i = 0; i < kLanes; ++i) rays_ += packet.active[i] != 0 ? 1 : 0;
    }
}

}  // namespace ink

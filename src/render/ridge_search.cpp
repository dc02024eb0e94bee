#include "render/ridge_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace ink {

RidgeSettings ridge_settings(const Settings& settings) {
    // Degrees for each hundredth of the picture's height.
    const double pixels = 0.01 * settings.size.height;
    const double turn = settings.ridge_turn_deg * std::numbers::pi / 180.0 / pixels;
    return {static_cast<float>(turn), static_cast<float>(2.0 * turn)};
}

RidgeSearch::RidgeSearch(const Pipeline& pipeline, int per_pixel)
    : pipeline_(pipeline),
      radius_(std::clamp(
          static_cast<int>(std::lround(pipeline.settings.ridge_scale_px() * per_pixel)), 2, 64)),
      apron_((radius_ + kBlockSide - 1) / kBlockSide * kBlockSide),
      pattern_(radius_, 1.0F / static_cast<float>(per_pixel)),
      sampler_(*pipeline.frame, pipeline.camera, per_pixel) {
    const auto& objects = pipeline.scene.objects();
    for (std::uint32_t k = 0; k < objects.size(); ++k) {
        balls_.push_back(std::holds_alternative<Spheres>(objects[k].shape) &&
                         pipeline.ids.is_ball(k));
    }
    has_balls_ = std::ranges::find(balls_, true) != balls_.end();
}

void RidgeSearch::search(const LatticeView& lattice, std::vector<Segment>& segments) {
    lay_grid(lattice.grid);
    copy(lattice);
    trace_around(lattice.grid);
    find_ridges(grid_, apron_, pattern_, ridge_settings(pipeline_.settings), segments);
}

void RidgeSearch::lay_grid(const SampleGrid& lattice) {
    grid_.x0 = lattice.x0 - apron_;
    grid_.y0 = lattice.y0 - apron_;
    grid_.spacing = lattice.spacing;
    grid_.resize(lattice.width + 2 * apron_, lattice.height + 2 * apron_);
    std::ranges::fill(grid_.id, kBackground);
}

/// What the tile's lattice saw goes to the middle of the grid.
void RidgeSearch::copy(const LatticeView& lattice) {
    const SampleGrid& from = lattice.grid;
    const auto copy_plane = [&](const auto& plane, auto& to) {
        for (int j = 0; j < from.height; ++j) {
            std::copy_n(plane.data() + from.index(0, j), from.width,
                        to.data() + grid_.index(apron_, j + apron_));
        }
    };
    copy_plane(from.id, grid_.id);
    copy_plane(from.px, grid_.px);
    copy_plane(from.py, grid_.py);
    copy_plane(from.pz, grid_.pz);
    copy_plane(from.nx, grid_.nx);
    copy_plane(from.ny, grid_.ny);
    copy_plane(from.nz, grid_.nz);
    copy_plane(from.t, grid_.t);
    const bool other_normals = pipeline_.shader.has_line_normals();
    if (!has_balls_ && !other_normals) return;
    for (std::size_t k = 0; k < lattice.blocks.size(); ++k) {
        const Block& block = lattice.blocks[k];
        for (int lane = 0; lane < kLanes; ++lane) {
            const int i = block.column(lane);
            const int j = block.row(lane);
            const std::uint32_t object = lattice.hits[k].object[lane];
            if (i >= block.columns || j >= block.rows || object == kNoObject) continue;
            const std::size_t n = grid_.index(block.x - grid_.x0 + i, block.y - grid_.y0 + j);
            if (balls_[object]) grid_.id[n] = kBackground;
            grid_.nx[n] = lattice.normals[k].x[lane];
            grid_.ny[n] = lattice.normals[k].y[lane];
            grid_.nz[n] = lattice.normals[k].z[lane];
        }
    }
}

void RidgeSearch::trace_around(const SampleGrid& lattice) {
    const auto is_known = [&](int i, int size) {
        return i >= apron_ && i + kBlockSide <= apron_ + size;
    };
    blocks_.clear();
    for (int j = 0; j < grid_.height; j += kBlockSide) {
        for (int i = 0; i < grid_.width; i += kBlockSide) {
            if (is_known(i, lattice.width) && is_known(j, lattice.height)) continue;
            blocks_.push_back({grid_.x0 + i, grid_.y0 + j, std::min(kBlockSide, grid_.width - i),
                               std::min(kBlockSide, grid_.height - j)});
        }
    }
    hits_.resize(blocks_.size());
    sampler_.trace_blocks(blocks_, {}, hits_);
    for (std::size_t k = 0; k < blocks_.size(); ++k) keep(blocks_[k], k);
}

void RidgeSearch::keep(const Block& block, std::size_t k) {
    const HitPacket& hits = hits_[k];
    const RayPacket& rays = sampler_.packets()[k];
    NormalPacket normals;
    Lanes<GeometryId> ids;
    pipeline_.shader.smooth(hits, normals);
    pipeline_.ids.resolve(hits, ids);
    for (int lane = 0; lane < kLanes; ++lane) {
        const int i = lane % kBlockSide;
        const int j = lane / kBlockSide;
        if (i >= block.columns || j >= block.rows || hits.object[lane] == kNoObject) continue;
        // The view-dependent curvature of a ball grows all the way to its outline.
        if (balls_[hits.object[lane]]) continue;
        const std::size_t n = grid_.index(block.x - grid_.x0 + i, block.y - grid_.y0 + j);
        const float t = hits.t[lane];
        grid_.id[n] = ids[lane];
        grid_.px[n] = rays.origin_x[lane] + t * rays.dir_x[lane];
        grid_.py[n] = rays.origin_y[lane] + t * rays.dir_y[lane];
        grid_.pz[n] = rays.origin_z[lane] + t * rays.dir_z[lane];
        grid_.nx[n] = normals.x[lane];
        grid_.ny[n] = normals.y[lane];
        grid_.nz[n] = normals.z[lane];
        grid_.t[n] = t;
    }
}

}  // namespace ink

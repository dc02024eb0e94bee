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
      per_pixel_(per_pixel),
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
}

void RidgeSearch::search(const Tile& tile, std::vector<Segment>& segments) {
    trace(tile);
    find_ridges(grid_, apron_, pattern_, ridge_settings(pipeline_.settings), segments);
}

void RidgeSearch::trace(const Tile& tile) {
    grid_.x0 = tile.x0 * per_pixel_ - apron_;
    grid_.y0 = tile.y0 * per_pixel_ - apron_;
    grid_.spacing = 1.0F / static_cast<float>(per_pixel_);
    // One more column and row, because a cell hangs on its upper left point.
    grid_.resize((tile.x1 - tile.x0) * per_pixel_ + 1 + 2 * apron_,
                 (tile.y1 - tile.y0) * per_pixel_ + 1 + 2 * apron_);
    std::ranges::fill(grid_.id, kBackground);
    blocks_.clear();
    for (int j = 0; j < grid_.height; j += kBlockSide) {
        for (int i = 0; i < grid_.width; i += kBlockSide) {
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

#include "shading/ray_sky.h"

#include <algorithm>
#include <cmath>

#include "shading/secondary_rays.h"
#include "shading/sky_directions.h"

namespace ink {

RaySky::RaySky(const Tracer& tracer, int rays) : tracer_(tracer) {
    std::vector<Vec3f> points;
    for (int k = 0; k < rays; ++k) {
        const Vec2f p = disc_point(k, rays, 0.0F);
        points.push_back({p.x, p.y, 0.0F});
    }
    sort_into_groups(points);
    const auto packets = static_cast<std::size_t>(rays / kLanes);
    x_.resize(packets);
    y_.resize(packets);
    for (std::size_t k = 0; k < points.size(); ++k) {
        x_[k / kLanes][static_cast<int>(k % kLanes)] = points[k].x;
        y_[k / kLanes][static_cast<int>(k % kLanes)] = points[k].y;
    }
}

float RaySky::openness(Vec3f point, Vec3f normal, float turn) const {
    thread_local std::vector<RayPacket> rays;
    thread_local std::vector<Lanes<float>> reach;
    thread_local std::vector<Lanes<std::int32_t>> blocked;
    rays.resize(x_.size());
    reach.assign(x_.size(), Lanes<float>::filled(kInfinity));
    blocked.resize(x_.size());
    Vec3f tangent;
    Vec3f bitangent;
    make_basis(normal, tangent, bitangent);
    const float angle = 6.28318531F * turn;
    const Vec3f right = tangent * std::cos(angle) + bitangent * std::sin(angle);
    const Vec3f up = cross(normal, right);
    const Vec3f origin = point + normal * kLiftOff;
    for (std::size_t k = 0; k < x_.size(); ++k) {
        RayPacket& packet = rays[k];
        packet.origin_x.fill(origin.x);
        packet.origin_y.fill(origin.y);
        packet.origin_z.fill(origin.z);
        packet.active.fill(-1);
        for (int i = 0; i < kLanes; ++i) {
            const float x = x_[k][i];
            const float y = y_[k][i];
            const float z = std::sqrt(std::max(1.0F - x * x - y * y, 0.0F));
            packet.dir_x[i] = right.x * x + up.x * y + normal.x * z;
            packet.dir_y[i] = right.y * x + up.y * y + normal.y * z;
            packet.dir_z[i] = right.z * x + up.z * y + normal.z * z;
        }
    }
    tracer_.occluded(rays, reach, blocked);
    int open = 0;
    for (const Lanes<std::int32_t>& packet : blocked) {
        for (const std::int32_t lane : packet) open += lane == 0 ? 1 : 0;
    }
    return static_cast<float>(open) / static_cast<float>(x_.size() * kLanes);
}

}  // namespace ink

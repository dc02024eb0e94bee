#include "render/aovs.h"

#include <array>
#include <utility>

namespace ink {

AovWriter::AovWriter(const Scene& scene, const Camera& camera, const std::vector<Aov>& aovs,
                     bool located, Film& film)
    : frame_(scene.frame()), camera_(camera), film_(film) {
    const auto add_planes = [&](std::initializer_list<const char*> names) {
        std::optional<std::size_t> first;
        for (const char* name : names) {
            const std::size_t plane = film.add_plane<float>(name);
            first = first.value_or(plane);
        }
        return first;
    };
    for (const Aov aov : aovs) {
        switch (aov) {
            case Aov::id:
                for (const auto& [name, level] : {std::pair{"id.primitive", IdLevel::primitive},
                                                  std::pair{"id.part", IdLevel::part},
                                                  std::pair{"id.object", IdLevel::object}}) {
                    ids_.push_back(
                        {film.add_plane<std::uint32_t>(name), LineIds::at_level(scene, level)});
                }
                break;
            case Aov::depth: depth_ = add_planes({"Z"}); break;
            case Aov::normal: normal_ = add_planes({"N.X", "N.Y", "N.Z"}); break;
            case Aov::position: position_ = add_planes({"P.X", "P.Y", "P.Z"}); break;
            case Aov::lines:
                lines_ = add_planes({"line.A"});
                if (!located) break;
                line_planes_ = add_planes({"line.distance"});
                for (const char* name :
                     {"line.type", "line.id.near", "line.id.far", "line.level"}) {
                    film.add_plane<std::uint32_t>(name);
                }
                break;
        }
    }
}

void AovWriter::put(Block block, Vec2f offset, const HitPacket& hits) const {
    put_ids(block, hits);
    if (depth_) put_depths(block, offset, hits);
    if (normal_) put_normals(block, hits);
    if (position_) put_positions(block, offset, hits);
}

void AovWriter::put_strength(Block block, const Lanes<float>& strength) const {
    if (lines_) film_.put_plane(*lines_, block.x, block.y, strength);
}

void AovWriter::put_lines(int x0, int y0, int x1, int y1, const LinePlanes& lines) const {
    if (!line_planes_) return;
    for (int y = y0; y < y1; ++y) {
        const std::size_t k = lines.index(0, y - y0);
        std::size_t plane = *line_planes_;
        film_.put_values(plane++, x0, y, x1 - x0, lines.distance().data() + k);
        for (const auto* values :
             {&lines.type(), &lines.near_id(), &lines.far_id(), &lines.level()}) {
            film_.put_values(plane++, x0, y, x1 - x0, values->data() + k);
        }
    }
}

void AovWriter::put_ids(Block block, const HitPacket& hits) const {
    Lanes<GeometryId> ids;
    for (const IdPlane& plane : ids_) {
        plane.ids.resolve(hits, ids);
        film_.put_plane(plane.plane, block.x, block.y, ids);
    }
}

namespace {

Vec2f lane_point(Block block, Vec2f offset, int lane) {
    return Vec2f{static_cast<float>(block.x + lane % kBlockSide) + 0.5F,
                 static_cast<float>(block.y + lane / kBlockSide) + 0.5F} +
           offset;
}

}  // namespace

void AovWriter::put_depths(Block block, Vec2f offset, const HitPacket& hits) const {
    Lanes<float> depth;
    for (int i = 0; i < kLanes; ++i) {
        const float t = camera_.distance_from_eye(lane_point(block, offset, i), hits.t[i]);
        depth[i] = hits.object[i] == kNoObject ? kInfinity : t * static_cast<float>(frame_.unit);
    }
    film_.put_plane(*depth_, block.x, block.y, depth);
}

void AovWriter::put_normals(Block block, const HitPacket& hits) const {
    std::size_t plane = *normal_;
    for (const auto* component : {&hits.normal_x, &hits.normal_y, &hits.normal_z}) {
        Lanes<float> values;
        for (int i = 0; i < kLanes; ++i) {
            values[i] = hits.object[i] == kNoObject ? 0.0F : (*component)[i];
        }
        film_.put_plane(plane++, block.x, block.y, values);
    }
}

void AovWriter::put_positions(Block block, Vec2f offset, const HitPacket& hits) const {
    Lanes<float> x;
    Lanes<float> y;
    for (int i = 0; i < kLanes; ++i) {
        x[i] = lane_point(block, offset, i).x;
        y[i] = lane_point(block, offset, i).y;
    }
    RayPacket rays;
    camera_.make_rays(x, y, rays);
    std::array<Lanes<float>, 3> world;
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f origin{rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]};
        const Vec3f dir{rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]};
        const bool miss = hits.object[i] == kNoObject;
        const Vec3f p = miss ? Vec3f{} : to_float(frame_.to_world(origin + dir * hits.t[i]));
        world[0][i] = p.x;
        world[1][i] = p.y;
        world[2][i] = p.z;
    }
    for (std::size_t k = 0; k < 3; ++k) film_.put_plane(*position_ + k, block.x, block.y, world[k]);
}

}  // namespace ink

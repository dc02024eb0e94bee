#include "render/specular_paths.h"

#include <algorithm>

namespace ink {

/// Of the light that comes from sixteen hits.
struct SpecularPaths::Shares {
    Lanes<float> own, main, side;
    bool any_side = false;
};

namespace {

Vec3d direction(const RayPacket& rays, int lane) {
    // Of unit length to more digits than a float has.
    return normalize(to_double({rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]}));
}

void launch(const Branch& branch, int lane, RayPacket& rays) {
    const Vec3f origin = to_float(branch.origin);
    const Vec3f dir = to_float(branch.dir);
    rays.origin_x[lane] = origin.x;
    rays.origin_y[lane] = origin.y;
    rays.origin_z[lane] = origin.z;
    rays.dir_x[lane] = dir.x;
    rays.dir_y[lane] = dir.y;
    rays.dir_z[lane] = dir.z;
    rays.active[lane] = -1;
}

/// Gives normals unit length and lets them face where rays come from.
void face_origin(const RayPacket& rays, HitPacket& hits) {
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f normal{hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]};
        const Vec3f dir{rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]};
        const float size = hits.object[i] == kNoObject ? 0.0F : length(normal);
        const float scale = size > 0.0F ? (dot(normal, dir) > 0.0F ? -1.0F : 1.0F) / size : 0.0F;
        hits.normal_x[i] = normal.x * scale;
        hits.normal_y[i] = normal.y * scale;
        hits.normal_z[i] = normal.z * scale;
    }
}

void mix(const Lanes<float>& share, const ColorPacket& seen, ColorPacket& colors) {
    for (int i = 0; i < kLanes; ++i) {
        if (share[i] == 0.0F) continue;
        colors.r[i] += share[i] * seen.r[i];
        colors.g[i] += share[i] * seen.g[i];
        colors.b[i] += share[i] * seen.b[i];
        colors.a[i] += share[i] * seen.a[i];
    }
}

void scale_by(const Lanes<float>& share, ColorPacket& colors) {
    for (int i = 0; i < kLanes; ++i) {
        colors.r[i] *= share[i];
        colors.g[i] *= share[i];
        colors.b[i] *= share[i];
        colors.a[i] *= share[i];
    }
}

/// Rays that are not traced must still have values that are numbers.
RayPacket no_rays() {
    RayPacket rays{};
    rays.dir_z.fill(1.0F);
    rays.active.fill(0);
    return rays;
}

}  // namespace

SpecularPaths::SpecularPaths(const Pipeline& pipeline) : pipeline_(pipeline) {
    const Color color = srgb_decode(pipeline.settings.shading.background);
    opaque_background_ = {color.r, color.g, color.b, 1.0F};
}

bool SpecularPaths::goes_on(const HitPacket& hits) const {
    return std::ranges::any_of(hits.object, [&](std::uint32_t object) {
        return object != kNoObject && pipeline_.optics.is_specular(object);
    });
}

SpecularPaths::Stage SpecularPaths::first_stage(const RayPacket& rays, const HitPacket& hits,
                                                const NormalPacket& normals) {
    Stage stage;
    stage.leg = {rays, hits, normals, {}, {}};
    stage.leg.before.fill(0.0F);
    stage.leg.path.fill(PathTable::kStart);
    return stage;
}

void SpecularPaths::follow(const RayPacket& rays, const HitPacket& hits,
                           const NormalPacket& normals, int depth, PathTable& table,
                           std::vector<PathLeg>& legs) {
    Record record{table, legs};
    advance(first_stage(rays, hits, normals), depth, &record, nullptr, false);
}

void SpecularPaths::follow(const RayPacket& rays, const PointPacket& points, const HitPacket& hits,
                           const NormalPacket& normals, PathTable& table,
                           std::vector<PathLeg>& legs, ColorPacket& colors) {
    points_ = points;
    Record record{table, legs};
    advance(first_stage(rays, hits, normals), pipeline_.settings.specular_depth, &record, &colors,
            true);
}

/// Goes on from the hits of a stage. `colors`, if wanted, are those of its surfaces before and of
/// all that is seen there after.
void SpecularPaths::advance(const Stage& from, int depth, Record* record, ColorPacket* colors,
                            bool sides) {
    if (depth == 0 || !goes_on(from.leg.hits)) return;
    Stage main;
    Stage side;
    Shares shares;
    if (!scatter(from, main, side, shares, record)) return;
    if (colors != nullptr) scale_by(shares.own, *colors);
    ColorPacket seen;
    see(main, depth, record, colors != nullptr ? &seen : nullptr, sides);
    if (colors == nullptr) return;
    if (!sides) {  // the main ray stands for the other one, too
        for (int i = 0; i < kLanes; ++i) shares.main[i] += shares.side[i];
    }
    mix(shares.main, seen, *colors);
    if (!sides || !shares.any_side) return;
    see(side, depth, nullptr, &seen, false);
    mix(shares.side, seen, *colors);
}

/// Traces a stage's rays, and goes on from what they meet.
void SpecularPaths::see(Stage& stage, int depth, Record* record, ColorPacket* colors, bool sides) {
    arrive(stage);
    if (record != nullptr) record->legs.push_back(stage.leg);
    if (colors != nullptr) shade(stage, *colors);
    advance(stage, depth - 1, record, colors, sides);
}

/// Lets the rays of a stage leave its surfaces. False if none does.
bool SpecularPaths::scatter(const Stage& from, Stage& main, Stage& side, Shares& shares,
                            Record* record) {
    const PathLeg& leg = from.leg;
    main.leg.rays = side.leg.rays = no_rays();
    main.leg.before = side.leg.before = leg.before;
    main.leg.path = side.leg.path = leg.path;
    shares.own.fill(1.0F);
    shares.main.fill(0.0F);
    shares.side.fill(0.0F);
    bool any = false;
    for (int i = 0; i < kLanes; ++i) {
        const auto lane = static_cast<std::size_t>(i);
        const std::uint32_t object = leg.hits.object[i];
        if (leg.rays.active[i] == 0 || object == kNoObject ||
            !pipeline_.optics.is_specular(object)) {
            continue;
        }
        const Scattering result = pipeline_.optics.scatter(
            {to_double({leg.rays.origin_x[i], leg.rays.origin_y[i], leg.rays.origin_z[i]}),
             direction(leg.rays, i), static_cast<double>(leg.hits.t[i]),
             to_double({leg.hits.normal_x[i], leg.hits.normal_y[i], leg.hits.normal_z[i]}),
             to_double({leg.normals.x[i], leg.normals.y[i], leg.normals.z[i]}), object,
             leg.hits.primitive[i], from.media[lane]});
        const auto take = [&](const Branch& branch, Stage& stage, Lanes<float>& share) {
            if (branch.bend == Bend::none) return;
            launch(branch, i, stage.leg.rays);
            stage.leg.before[i] += leg.hits.t[i];
            stage.media[lane] = branch.media;
            stage.bent[lane] = from.bent[lane] || branch.bend != Bend::straight;
            share[i] = static_cast<float>(branch.share);
        };
        take(result.main, main, shares.main);
        take(result.side, side, shares.side);
        shares.own[i] = static_cast<float>(result.own);
        shares.any_side |= result.side.bend != Bend::none;
        any |= result.main.bend != Bend::none;
        if (record != nullptr) {
            const GeometryId id = pipeline_.ids.resolve(object, leg.hits.primitive[i]);
            main.leg.path[i] = record->table.extended(leg.path[i], id, result.main.bend);
        }
    }
    return any;
}

void SpecularPaths::arrive(Stage& stage) {
    PathLeg& leg = stage.leg;
    pipeline_.tracer.intersect({&leg.rays, 1}, {&leg.hits, 1}, Coherence::incoherent);
    for (int i = 0; i < kLanes; ++i) {
        if (leg.rays.active[i] == 0) leg.hits.object[i] = kNoObject;
        rays_ += leg.rays.active[i] != 0 ? 1 : 0;
    }
    face_origin(leg.rays, leg.hits);
    pipeline_.shader.smooth(leg.hits, leg.normals);
}

void SpecularPaths::shade(const Stage& stage, ColorPacket& colors) const {
    pipeline_.shader.shade({stage.leg.rays, points_, stage.leg.hits, stage.leg.normals}, colors);
    for (int i = 0; i < kLanes; ++i) {
        if (stage.leg.hits.object[i] != kNoObject || !stage.bent[static_cast<std::size_t>(i)]) {
            continue;
        }
        colors.r[i] = opaque_background_[0];
        colors.g[i] = opaque_background_[1];
        colors.b[i] = opaque_background_[2];
        colors.a[i] = opaque_background_[3];
    }
}

}  // namespace ink

#include "render/edges_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "accel/peeled_tracer.h"
#include "base/error.h"
#include "render/enlarge.h"

namespace ink {

namespace {

bool has_object_rules(const Settings& settings) {
    return std::ranges::any_of(settings.line_rules,
                               [](const LineRule& rule) { return rule.object > 0; });
}

bool has_inner_rules(const Settings& settings) {
    return std::ranges::any_of(settings.look_rules, &LineRule::inner) ||
           std::ranges::any_of(settings.line_rules, &LineRule::inner);
}

/// Levels with styles of their own: up to the highest that a rule names, and one for those beyond.
int levels_of(const Pipeline& pipeline) {
    int levels = 1;
    if (!pipeline.goes_on()) return levels;
    for (const LineRule& rule : pipeline.settings.line_rules) {
        if (rule.level) levels = std::max(levels, *rule.level + 2);
    }
    return levels;
}

LineStyle line_style(const Film& film, const StrokeStyle& style) {
    return {static_cast<float>(style.width_px), film.in_blend_space(style.color),
            static_cast<float>(style.opacity)};
}

/// Throws UsageError if a rule is for an object that does not exist.
InkSettings ink_settings(const Pipeline& pipeline) {
    const Settings& settings = pipeline.settings;
    const auto objects = static_cast<int>(pipeline.scene.objects().size());
    for (const LineRule& rule : settings.line_rules) {
        if (rule.object <= objects) continue;
        throw UsageError(
            fmt::format("--line: there is no object {}; the scene has {}", rule.object, objects));
    }
    InkSettings ink;
    ink.profile = settings.profile();
    const int told_apart = has_object_rules(settings) ? objects : 1;
    const int levels = levels_of(pipeline);
    for (int inner = 0; inner <= (has_inner_rules(settings) ? 1 : 0); ++inner) {
        for (int k = 0; k < levels * told_apart * kLineTypes; ++k) {
            const int group = k / kLineTypes;
            ink.styles.push_back(line_style(
                pipeline.film,
                settings.line_style(static_cast<LineType>(k % kLineTypes), group % told_apart + 1,
                                    group / told_apart, inner != 0)));
        }
    }
    if (!settings.draws_hidden()) return ink;
    for (int object = 1; object <= told_apart; ++object) {
        ink.styles.push_back(line_style(pipeline.film, settings.hidden_style(object)));
    }
    return ink;
}

Viewpoint::Affine affine(Vec3f at_zero, Vec3f dx, Vec3f dy) {
    return {to_double(at_zero), to_double(dx), to_double(dy)};
}

/// Every object is made of spheres that are told apart one by one.
bool has_balls_only(const Pipeline& pipeline) {
    const auto& objects = pipeline.scene.objects();
    for (std::uint32_t k = 0; k < objects.size(); ++k) {
        if (!std::holds_alternative<Spheres>(objects[k].shape) || !pipeline.ids.is_ball(k)) {
            return false;
        }
    }
    return !pipeline.goes_on();
}

/// Of a scene of nothing but balls, each of which has an ID of its own.
std::optional<BallTable> one_set_of_balls(const Pipeline& pipeline) {
    const auto& objects = pipeline.scene.objects();
    if (objects.size() != 1 || pipeline.ids.level(0) != IdLevel::primitive) return {};
    const auto& spheres = std::get<Spheres>(objects[0].shape);
    if (!spheres.copies.empty() || spheres.spheres.empty()) return {};
    static_assert(sizeof(Sphere) == 4 * sizeof(float));
    return BallTable{0, pipeline.ids.first(0),
                     reinterpret_cast<const float*>(spheres.spheres.data())};
}

/// For less than a quarter of a tile no other one is begun: the margin would often be one.
int spare(int margin, int side) { return std::min(2 * margin, side / 4); }

}  // namespace

EdgesPlan::EdgesPlan(const Pipeline& shared)
    : pipeline(shared),
      q(shared.settings.lattice_points()),
      surfaces(shared.scene, shared.settings.shading.normals),
      mesh_walk(shared.scene, shared.camera.projection(), shared.settings.shading.normals),
      draw_lines(shared.lines.ink),
      find_lines(draw_lines || shared.lines.drawing != nullptr),
      has_meshes(std::ranges::any_of(
          shared.scene.objects(),
          [](const Object& object) { return std::holds_alternative<Mesh>(object.shape); })),
      tones(shared.lines.drawing != nullptr && shared.settings.divides_tones()),
      smooth_shading(shared.settings.smoothing().kind == AntiAliasing::Kind::edges),
      balls_only(!tones && shared.settings.halo_px() <= 0.0 && has_balls_only(shared)),
      wanted(shared.settings.lines),
      styles_by_object(has_object_rules(shared.settings)),
      tells_inner(has_inner_rules(shared.settings)),
      style_levels(levels_of(shared)),
      styles_by_type(!styles_by_object && !tells_inner && style_levels == 1),
      ink(ink_settings(shared)),
      halo_px(static_cast<float>(shared.settings.halo_px())),
      depth_range(shared.shader.depth_cue().range()),
      small_things(shared.scene, shared.ids, shared.camera,
                   static_cast<float>(shared.settings.line_density), ink.widest()) {
    if (halo_px > 0.0F) {
        halo_style = ink.styles.size();
        const Settings& settings = shared.settings;
        const Rgb8 paper =
            settings.compose == Compose::lines ? Rgb8{255, 255, 255} : settings.shading.background;
        ink.styles.push_back({ink.widest() + 2.0F * halo_px, shared.film.in_blend_space(paper)});
    }
    // A sharp corner can look like a jump before it is located.
    detect.depths = smooth_shading || wanted.has(LineType::self_occlusion) ||
                    wanted.has(LineType::boundary) || wanted.has(LineType::crease);
    detect.normals = smooth_shading || wanted.has(LineType::crease);
    if (find_lines && shared.frame != nullptr && shared.settings.draws_hidden()) {
        // What a line of any type uncovers changes the layers behind it.
        detect.depths = true;
        for (int layer = 1; layer <= shared.settings.hidden_layers; ++layer) {
            behind.push_back(make_peeled_frame(shared.scene, shared.tracer, *shared.frame, layer));
        }
    }
    if (balls_only) balls = one_set_of_balls(shared);
    const Camera& camera = shared.camera;
    detect.least_jump = 0.2F * camera.least_footprint() / static_cast<float>(q);
    const Camera::RayField& rays = camera.ray_field();
    viewpoint = {camera.eye(), -camera.back(), camera.orthographic(),
                 affine(rays.origin, rays.origin_dx, rays.origin_dy),
                 affine(rays.dir, rays.dir_dx, rays.dir_dy)};
    const int reach = static_cast<int>(std::ceil(find_lines ? ink.reach() : 1.0F)) + 1;
    margin = (reach + kBlockSide - 1) / kBlockSide * kBlockSide;
    const Size size = shared.settings.size;
    // In a draft the squares are as large as in the picture in full.
    const auto* enlargement = shared.lines.enlargement;
    const float enlarged = enlargement != nullptr ? enlargement->factor() : 1.0F;
    const auto least_side = static_cast<int>(std::ceil(LineDensity::kLeastSide / enlarged));
    no_lines = LineDensity(-margin, -margin, size.width + margin, size.height + margin,
                           ink.widest(), least_side);
    const int side = shared.settings.tile;
    const Size searched{size.width + 2 * margin, size.height + 2 * margin};
    tiles_across = count_tiles(searched.width, side, spare(margin, side));
    tiles_down = count_tiles(searched.height, side, spare(margin, side));
    search_tiles = cut_into_tiles(searched, side, spare(margin, side));
    for (Tile& tile : search_tiles) {
        tile = {tile.x0 - margin, tile.y0 - margin, tile.x1 - margin, tile.y1 - margin};
        const Tile seen{std::max(tile.x0, 0), std::max(tile.y0, 0), std::min(tile.x1, size.width),
                        std::min(tile.y1, size.height)};
        if (seen.x0 < seen.x1 && seen.y0 < seen.y1) draw_tiles.push_back(seen);
    }
}

/// The outline lies between a pixel and what it does not see, and so is nearer to the pixel.
bool EdgesPlan::outlines_cover_faces() const {
    const bool planes = pipeline.aovs && pipeline.aovs->wants_line_planes();
    if (styles_by_object || tells_inner || planes) return false;
    const auto style = [&](LineType type) { return ink.styles[static_cast<std::size_t>(type)]; };
    const LineStyle faces = style(LineType::mesh);
    const auto covers = [&](LineType type) {
        const LineStyle own = style(type);
        const bool one_ink = own.color == faces.color && own.opacity == faces.opacity;
        const bool on_top = own.opacity == 1.0F && ink.profile.kind == Metric::Kind::solid;
        return wanted.has(type) && own.width_px >= faces.width_px && (one_ink || on_top);
    };
    return covers(LineType::silhouette) && covers(LineType::intersection) &&
           covers(LineType::self_occlusion) && covers(LineType::boundary);
}

/// Along open edges there is a line in any case, so that it does not matter that these are borders
/// as well.
bool EdgesPlan::draws_borders() const {
    return wants_faces() && q == 1 && pipeline.frame->measures_borders() &&
           outlines_cover_faces() && !cues_depth() && !pipeline.lines.segments &&
           ink.profile.kind == Metric::Kind::solid &&
           std::ranges::all_of(pipeline.scene.objects(), [](const Object& object) {
               const auto* mesh = std::get_if<Mesh>(&object.shape);
               return mesh == nullptr || mesh->faces.empty();
           });
}

std::size_t EdgesPlan::find_style(const Segment& segment) const {
    const auto type = static_cast<std::size_t>(segment.type);
    const bool by_object = styles_by_object && segment.owner != kBackground;
    const std::size_t object = by_object ? pipeline.ids.object_of(segment.owner) : 0;
    const std::size_t objects = styles_by_object ? pipeline.scene.objects().size() : 1;
    const auto levels = static_cast<std::size_t>(style_levels);
    const std::size_t alike = levels * objects * kLineTypes;
    if (segment.hidden) return alike * (tells_inner ? 2 : 1) + object;
    const std::size_t level = std::min<std::size_t>(segment.level, levels - 1);
    return (is_inner(segment) ? alike : 0) + (level * objects + object) * kLineTypes + type;
}

bool EdgesPlan::is_inner(const Segment& segment) const {
    return tells_inner && segment.left != kBackground && segment.right != kBackground &&
           pipeline.ids.of_one_whole(segment.left, segment.right);
}

float EdgesPlan::depth_at(Vec2f point, float t) const {
    const Vec3d from = viewpoint.origin(point);
    return pipeline.shader.depth_cue()(
        to_float(from + normalize(viewpoint.direction(point)) * static_cast<double>(t)));
}

bool EdgesPlan::cues_depth() const {
    return pipeline.settings.line_fade > 0.0 || pipeline.settings.line_taper > 0.0;
}

void EdgesPlan::attenuate(Segment& segment) const {
    const Vec2f middle = (segment.a + segment.b) * 0.5F;
    if (cues_depth()) {
        const float depth = depth_at(middle, segment.t);
        segment.strength *= 1.0F - static_cast<float>(pipeline.settings.line_fade) * depth;
        segment.width_scale = 1.0F - static_cast<float>(pipeline.settings.line_taper) * depth;
    }
    if (small_things.any()) {
        const float width = ink.styles[style_of(segment)].width_px * segment.width_scale;
        segment.width_scale *= small_things.width_scale(segment.owner, middle, segment.t, width);
    }
}

std::size_t EdgesPlan::search_tile_at(Vec2f point) const {
    const auto tile = [&](float at, int tiles) {
        return std::clamp((static_cast<int>(std::floor(at)) + margin) / pipeline.settings.tile, 0,
                          tiles - 1);
    };
    return static_cast<std::size_t>(tile(point.y, tiles_down)) * search_tiles_across() +
           static_cast<std::size_t>(tile(point.x, tiles_across));
}

std::size_t EdgesPlan::style_of(LineType type, std::uint32_t object) const {
    return (styles_by_object ? object * kLineTypes : 0U) + static_cast<std::size_t>(type);
}

}  // namespace ink

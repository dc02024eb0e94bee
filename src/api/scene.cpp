#include "inktrace/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "accel/cost.h"
#include "api/guard.h"
#include "api/impl.h"
#include "api/scene_file.h"
#include "io/reader.h"
#include "scene/kind_colors.h"
#include "scene/mesh.h"

namespace inktrace {

namespace {

std::string kind_name(ink::ObjectKind kind) {
    switch (kind) {
        case ink::ObjectKind::molecule: return "molecule";
        case ink::ObjectKind::particles: return "particles";
        case ink::ObjectKind::mesh: return "mesh";
        case ink::ObjectKind::shape: return "shape";
    }
    return {};
}

std::optional<std::pair<double, double>> color_range(const ink::Object& object) {
    const auto& scale = object.color_scale;
    if (!scale || scale->map == nullptr) return std::nullopt;
    return std::pair{scale->least, scale->most};
}

std::array<double, 3> to_array(ink::Vec3d v) { return {v.x, v.y, v.z}; }

void check(bool good, std::string_view name, std::size_t index, std::string_view problem) {
    if (!good) throw ink::Error(fmt::format("{}: entry {} {}", name, index, problem));
}

/// Coordinates relative to the first point, which keeps the digits of data far from zero.
class LocalCoordinates {
  public:
    explicit LocalCoordinates(std::span<const float> first) {
        if (first.size() >= 3) frame_.origin = {first[0], first[1], first[2]};
    }
    const ink::Frame& frame() const { return frame_; }
    ink::Vec3f operator()(std::span<const float> p) const {
        return frame_.from_world({p[0], p[1], p[2]});
    }
    static bool valid(std::span<const float> p) {
        return std::ranges::all_of(p.first(3),
                                   [](float x) { return std::abs(x) <= ink::kLargestCoordinate; });
    }

  private:
    ink::Frame frame_;
};

ink::Object make_spheres(std::string_view name, std::span<const float> values,
                         std::span<const std::uint8_t> colors) {
    const std::size_t count = values.size() / 4;
    if (values.size() % 4 != 0 || (!colors.empty() && colors.size() != count * 3)) {
        throw ink::Error(
            fmt::format("{}: expected x, y, z, radius of each sphere and no colours or "
                        "r, g, b of each",
                        name));
    }
    const LocalCoordinates local(values);
    ink::Spheres shape;
    shape.spheres.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto sphere = values.subspan(i * 4, 4);
        check(LocalCoordinates::valid(sphere), name, i, "has a coordinate that is not finite");
        check(sphere[3] > 0.0F && std::isfinite(sphere[3]), name, i, "needs a positive radius");
        shape.spheres.push_back({local(sphere), sphere[3]});
        if (!colors.empty()) {
            shape.colors.push_back({colors[i * 3], colors[i * 3 + 1], colors[i * 3 + 2]});
        }
    }
    return {.name = std::string(name),
            .kind = ink::ObjectKind::particles,
            .frame = local.frame(),
            .shape = std::move(shape)};
}

ink::Object make_mesh(std::string_view name, std::span<const float> vertices,
                      std::span<const std::uint32_t> triangles, std::array<std::uint8_t, 3> color) {
    if (vertices.size() % 3 != 0 || triangles.size() % 3 != 0) {
        throw ink::Error(fmt::format(
            "{}: expected x, y, z of each vertex and three indices of each triangle", name));
    }
    const LocalCoordinates local(vertices);
    ink::Mesh mesh;
    for (std::size_t i = 0; i < vertices.size(); i += 3) {
        const auto vertex = vertices.subspan(i, 3);
        check(LocalCoordinates::valid(vertex), name, i / 3, "has a coordinate that is not finite");
        mesh.vertices.push_back(local(vertex));
    }
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        const ink::Mesh::Triangle corners{triangles[i], triangles[i + 1], triangles[i + 2]};
        const auto largest = *std::ranges::max_element(corners);
        check(largest < mesh.vertices.size(), name, i / 3, "has an index beyond the vertices");
        mesh.triangles.push_back(corners);
    }
    ink::weld(mesh);
    ink::stitch(mesh);
    ink::smooth_normals(mesh);
    return {.name = std::string(name),
            .kind = ink::ObjectKind::mesh,
            .frame = local.frame(),
            .shape = std::move(mesh),
            .material = {.color = {color[0], color[1], color[2]}}};
}

FileInfo describe(const std::filesystem::path& file, const ink::FileContents& contents) {
    ink::Bounds3d bounds;
    for (const ink::Object& object : contents.objects) bounds.add(object.world_bounds());
    FileInfo info{.path = file,
                  .format = contents.format,
                  .kind = kind_name(contents.objects.front().kind),
                  .length_unit = contents.length_unit,
                  .frames = contents.frames,
                  .counts = contents.counts,
                  .names = contents.names,
                  .lower = to_array(bounds.lower),
                  .upper = to_array(bounds.upper),
                  .fields = {},
                  .memory_bytes = ink::cost_of(contents.objects).bytes(),
                  .chosen_radius = contents.objects.front().chosen_radius,
                  .color_range = color_range(contents.objects.front()),
                  .kind_field = {},
                  .has_kinds = false,
                  .warnings = contents.warnings};
    const ink::Object& first = contents.objects.front();
    info.has_kinds = first.kind == ink::ObjectKind::particles && first.color_scale &&
                     first.color_scale->map == nullptr;
    for (const ink::FieldSummary& field : contents.fields) {
        if (info.kind_field.empty() && ink::is_kind_name(field.name)) info.kind_field = field.name;
        info.fields.push_back({field.name, field.components, field.least, field.most, field.words});
    }
    return info;
}

ink::FileContents read_any(const std::filesystem::path& file, const ink::Settings& settings,
                           bool summarize, bool facts) {
    if (ink::is_scene_file(file)) return ink::read_scene_file(file, settings, facts);
    return ink::read_file(
        file,
        {.frame = settings.frame, .data = settings.data, .summarize = summarize, .facts = facts});
}

}  // namespace

Scene::Scene() : impl_(std::make_unique<Impl>()) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

FileInfo Scene::load(const std::filesystem::path& file, int frame) {
    return load(file, Settings().set("frame", std::to_string(frame)));
}

FileInfo Scene::load(const std::filesystem::path& file, const Settings& settings,
                     const LoadOptions& options) {
    return ink::guard([&] {
        const ink::Settings& inner = settings.impl().settings;
        ink::FileContents contents = read_any(file, inner, false, options.facts);
        FileInfo info = describe(file, contents);
        std::ranges::move(contents.objects, std::back_inserter(impl_->objects));
        return info;
    });
}

void Scene::add_spheres(std::string_view name, std::span<const float> centers_and_radii,
                        std::span<const std::uint8_t> colors) {
    ink::guard([&] { impl_->objects.push_back(make_spheres(name, centers_and_radii, colors)); });
}

void Scene::add_mesh(std::string_view name, std::span<const float> vertices,
                     std::span<const std::uint32_t> triangles, std::array<std::uint8_t, 3> color) {
    ink::guard([&] { impl_->objects.push_back(make_mesh(name, vertices, triangles, color)); });
}

std::size_t Scene::primitive_count() const {
    std::size_t count = 0;
    for (const ink::Object& object : impl_->objects) count += object.primitive_count();
    return count;
}

SceneCost Scene::cost() const {
    const ink::Cost cost = ink::cost_of(impl_->objects);
    return {.bytes = cost.bytes(),
            .build_seconds = cost.build_seconds,
            .ambient_seconds = cost.ambient_seconds};
}

FileInfo inspect(const std::filesystem::path& file, const Settings& settings) {
    return ink::guard(
        [&] { return describe(file, read_any(file, settings.impl().settings, true, false)); });
}

std::vector<std::pair<std::string, std::string>> input_formats() {
    std::vector<std::pair<std::string, std::string>> formats;
    for (const ink::Reader& reader : ink::readers()) {
        formats.emplace_back(reader.name, fmt::format(".{}", fmt::join(reader.extensions, " .")));
    }
    formats.emplace_back("scene", ".json");
    return formats;
}

std::vector<std::pair<std::string, std::string>> scene_file_settings(
    const std::filesystem::path& file) {
    return ink::guard([&] {
        return ink::is_scene_file(file) ? ink::read_scene_settings(file)
                                        : std::vector<std::pair<std::string, std::string>>();
    });
}

}  // namespace inktrace

#include "api/scene_shapes.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.h"

namespace ink {

namespace {

using Keys = std::vector<std::string_view>;

/// A type of shape: the keys of its own, and how it is made of them.
struct ShapeType {
    std::string_view name;
    Keys keys;
    Object (*read)(const JsonNode& node);
};

Vec3d center(const JsonNode& node) {
    const auto given = node.find("center");
    return given ? given->vector() : Vec3d{};
}

Vec3d direction(const JsonNode& node, std::string_view key) {
    const auto given = node.find(key);
    if (!given) return {0, 0, 1};
    const Vec3d v = given->vector();
    if (!(length(v) > 0.0)) given->fail("has no length; use for example [0, 0, 1]");
    return v;
}

/// "rotate": [x, y, z, degrees], about an axis through the centre; Rodrigues' formula.
Vec3d rotated(const JsonNode& node, Vec3d v) {
    const auto given = node.find("rotate");
    if (!given) return v;
    const auto parts = given->items(4);
    const auto part = [&](std::size_t k) { return parts[k].number(-1e6, 1e6); };
    const Vec3d axis{part(0), part(1), part(2)};
    if (!(length(axis) > 0.0)) given->fail("its axis has no length; use for example [0, 0, 1, 45]");
    const Vec3d n = normalize(axis);
    const double angle = part(3) * std::numbers::pi / 180.0;
    return v * std::cos(angle) + cross(n, v) * std::sin(angle) +
           n * (dot(n, v) * (1.0 - std::cos(angle)));
}

Object make_object(Shape shape, Vec3d origin) {
    Object object;
    object.kind = ObjectKind::shape;
    object.frame.origin = origin;
    object.shape = std::move(shape);
    return object;
}

Object one_glyph(const UnitShape& shape, const Placement& placement, Vec3d origin) {
    return make_object(Glyphs{shape, {placement}, {}, {}}, origin);
}

constexpr std::string_view kNoVolume = "the half axes lie in one plane; the shape has no volume";

/// Three half axes: given as "axes", or `half` along the coordinate axes, turned by "rotate".
Placement axes_placement(const JsonNode& node, const std::function<Vec3d()>& half) {
    Placement place;
    if (const auto given = node.find("axes")) {
        const auto axes = given->items(3);
        place.x_axis = to_float(rotated(node, axes[0].vector()));
        place.y_axis = to_float(rotated(node, axes[1].vector()));
        place.z_axis = to_float(rotated(node, axes[2].vector()));
        if (!has_volume(place)) given->fail(kNoVolume);
        return place;
    }
    const Vec3d h = half();
    place.x_axis = to_float(rotated(node, {h.x, 0, 0}));
    place.y_axis = to_float(rotated(node, {0, h.y, 0}));
    place.z_axis = to_float(rotated(node, {0, 0, h.z}));
    return place;
}

/// The same, of a shape whose width, depth and height are its "size".
Placement sized_placement(const JsonNode& node) {
    return axes_placement(node, [&] { return node.at("size").positive_vector() * 0.5; });
}

Object read_sphere(const JsonNode& node) {
    const auto radius = static_cast<float>(node.at("radius").positive());
    return make_object(Spheres{{{{}, radius}}, {}, {}}, center(node));
}

Object read_box(const JsonNode& node) {
    return one_glyph({GlyphKind::box}, sized_placement(node), center(node));
}

Object read_ellipsoid(const JsonNode& node) {
    const auto radii = [&] { return node.at("radii").positive_vector(); };
    return one_glyph({GlyphKind::ellipsoid}, axes_placement(node, radii), center(node));
}

Object read_superellipsoid(const JsonNode& node) {
    UnitShape shape{GlyphKind::superellipsoid, 0.3, 0.3};
    if (const auto given = node.find("roundness")) {
        const auto read = [](const JsonNode& n) {
            return n.number(kLeastRoundness, kMostRoundness);
        };
        if (given->is_list()) {
            const auto parts = given->items(2);
            shape.a = read(parts[0]);
            shape.b = read(parts[1]);
        } else {
            shape.a = shape.b = read(*given);
        }
    }
    const auto radii = [&] { return node.at("radii").positive_vector(); };
    return one_glyph(shape, axes_placement(node, radii), center(node));
}

Object read_frustum(const JsonNode& node, double above) {
    UnitShape shape{GlyphKind::frustum, above};
    if (const auto capped = node.find("capped")) shape.capped = capped->boolean();
    const Vec3d from = node.at("from").vector();
    const Vec3d to = node.at("to").vector();
    if (!(length(to - from) > 0.0)) node.at("to").fail("is the same point as \"from\"");
    const Vec3d middle = (from + to) * 0.5;
    return one_glyph(
        shape, placement_between(from - middle, to - middle, node.at("radius").positive()), middle);
}

Object read_cylinder(const JsonNode& node) { return read_frustum(node, 1.0); }

Object read_cone(const JsonNode& node) {
    const double radius = node.at("radius").positive();
    const auto top = node.find("top-radius");
    return read_frustum(node, top ? top->number(0.0, radius) / radius : 0.0);
}

Object read_disc(const JsonNode& node) {
    return one_glyph({GlyphKind::disc},
                     placement_about({}, direction(node, "normal"), node.at("radius").positive()),
                     center(node));
}

Object read_rectangle(const JsonNode& node) {
    const auto size = node.at("size").items(2);
    Placement place;
    place.x_axis = to_float(rotated(node, {0.5 * size[0].positive(), 0, 0}));
    place.y_axis = to_float(rotated(node, {0, 0.5 * size[1].positive(), 0}));
    // Any third axis will do; this one keeps the map well shaped.
    const double scale =
        std::sqrt(length(to_double(place.x_axis)) * length(to_double(place.y_axis)));
    place.z_axis = to_float(rotated(node, {0, 0, scale}));
    return one_glyph({GlyphKind::rectangle}, place, center(node));
}

Object read_torus(const JsonNode& node) {
    const double radius = node.at("radius").positive();
    const double tube = node.at("tube").positive();
    if (!(tube < radius))
        node.at("tube").fail(fmt::format("must be smaller than the radius, {}", radius));
    return one_glyph({GlyphKind::torus, tube / radius},
                     placement_about({}, direction(node, "axis"), radius), center(node));
}

Object read_gaussian(const JsonNode& node) {
    UnitShape shape{GlyphKind::gaussian, 0.35};
    if (const auto sigma = node.find("sigma")) shape.a = sigma->number(0.01, 100.0);
    // The height counts from the foot.
    Placement place = axes_placement(node, [&] {
        const Vec3d size = node.at("size").positive_vector();
        return Vec3d{size.x * 0.5, size.y * 0.5, size.z};
    });
    return one_glyph(shape, place, center(node));
}

Object read_waves(const JsonNode& node) {
    UnitShape shape{GlyphKind::waves, 2.0, 0.0};
    if (const auto waves = node.find("waves")) {
        const auto parts = waves->items(2);
        shape.a = parts[0].number(0.0, 1000.0);
        shape.b = parts[1].number(0.0, 1000.0);
    }
    return one_glyph(shape, sized_placement(node), center(node));
}

Object read_hexahedron(const JsonNode& node) {
    const auto corners = node.at("corners").items(8);
    const Vec3d origin = corners[0].vector();
    Hexahedra::Corners shape;
    for (std::size_t k = 0; k < 8; ++k) shape[k] = to_float(corners[k].vector() - origin);
    return make_object(Hexahedra{{shape}, {}, {}}, origin);
}

UnitShape glyph_shape(const JsonNode& node) {
    const std::string name = node.text();
    if (name == "ellipsoid") return {GlyphKind::ellipsoid};
    if (name == "box") return {GlyphKind::box};
    if (name == "cylinder") return {GlyphKind::frustum, 1.0};
    if (name == "cone") return {GlyphKind::frustum, 0.0};
    node.fail(fmt::format("'{}' is not one of ellipsoid, box, cylinder, cone", name));
}

/// Many copies: "glyphs" has one list of twelve numbers a glyph, the centre and three half axes.
Object read_glyphs(const JsonNode& node) {
    Glyphs glyphs;
    glyphs.shape = glyph_shape(node.at("shape"));
    const auto list = node.at("glyphs").items();
    if (list.empty()) node.at("glyphs").fail("is empty; there is nothing to draw");
    Vec3d origin;
    for (const JsonNode& entry : list) {
        const auto numbers = entry.items(12);
        const auto vector = [&](std::size_t k) {
            const auto part = [&](std::size_t n) { return numbers[3 * k + n].number(-1e15, 1e15); };
            return Vec3d{part(0), part(1), part(2)};
        };
        if (glyphs.placements.empty()) origin = vector(0);
        glyphs.placements.push_back({to_float(vector(1)), to_float(vector(2)), to_float(vector(3)),
                                     to_float(vector(0) - origin)});
        if (!has_volume(glyphs.placements.back())) entry.fail(kNoVolume);
    }
    Object object = make_object(std::move(glyphs), origin);
    object.kind = ObjectKind::particles;
    return object;
}

const std::vector<ShapeType>& types() {
    static const std::vector<ShapeType> kTypes{
        {"sphere", {"center", "radius"}, read_sphere},
        {"box", {"center", "size", "axes", "rotate"}, read_box},
        {"hexahedron", {"corners"}, read_hexahedron},
        {"cylinder", {"from", "to", "radius", "capped"}, read_cylinder},
        {"cone", {"from", "to", "radius", "top-radius", "capped"}, read_cone},
        {"disc", {"center", "normal", "radius"}, read_disc},
        {"rectangle", {"center", "size", "rotate"}, read_rectangle},
        {"torus", {"center", "axis", "radius", "tube"}, read_torus},
        {"ellipsoid", {"center", "radii", "axes", "rotate"}, read_ellipsoid},
        {"superellipsoid", {"center", "radii", "axes", "rotate", "roundness"}, read_superellipsoid},
        {"gaussian", {"center", "size", "axes", "rotate", "sigma"}, read_gaussian},
        {"waves", {"center", "size", "axes", "rotate", "waves"}, read_waves},
        {"glyphs", {"shape", "glyphs"}, read_glyphs}};
    return kTypes;
}

}  // namespace

const std::vector<std::string_view>& common_object_keys() {
    static const Keys kKeys{"type", "name", "color", "material", "ids", "normals"};
    return kKeys;
}

std::optional<Object> read_shape(const JsonNode& node) {
    const std::string name = node.at("type").text();
    for (const ShapeType& type : types()) {
        if (type.name != name) continue;
        Keys keys = common_object_keys();
        keys.insert(keys.end(), type.keys.begin(), type.keys.end());
        node.allow_only(keys);
        Object object = type.read(node);
        object.name = name;
        return object;
    }
    return std::nullopt;
}

std::vector<std::string_view> shape_types() {
    std::vector<std::string_view> names;
    for (const ShapeType& type : types()) names.push_back(type.name);
    return names;
}

}  // namespace ink

#include "api/scene_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "api/scene_shapes.h"
#include "base/error.h"
#include "base/text.h"
#include "io/json_document.h"
#include "io/polygon_mesh.h"
#include "render/light_text.h"

namespace ink {

namespace {

/// Sets one setting from a value of the file; what the table refuses becomes an error at the line.
void apply(const std::string& name, const JsonNode& value, Settings& settings) {
    const std::string words = value.as_words();
    try {
        find_setting(name).set(settings, words);
    } catch (const UsageError& error) {
        value.fail(error.what());
    }
}

Rgb8 read_color(const JsonNode& node) {
    const std::string words = node.as_words();
    const auto color = parse_color(words);
    if (!color) {
        node.fail(fmt::format(
            "'{}' is not a colour; write a name such as \"navy\", \"#rrggbb\" or [r, g, b] from 0 "
            "to 255",
            words));
    }
    return *color;
}

/// A light as a value of the setting "light"; what that refuses becomes an error at its line.
std::string light_text(const JsonNode& node) {
    const std::string kind = node.at("type").text();
    const std::vector<std::string_view> kinds = light_kinds();
    if (std::ranges::find(kinds, kind) == kinds.end()) {
        node.at("type").fail(fmt::format("'{}' is not one of {}", kind, fmt::join(kinds, ", ")));
    }
    std::string text = kind;
    for (const auto& [key, value] : node.members()) {
        if (key == "type") continue;
        const std::string property = fmt::format("{}={}", key, value.as_words());
        try {
            read_lights(kind + ":" + property);
        } catch (const UsageError& error) {
            value.fail(error.what());
        }
        text += (text == kind ? ":" : ",") + property;
    }
    return text;
}

template <class T>
T read_word(const JsonNode& node, const std::vector<std::pair<std::string_view, T>>& words) {
    const std::string text = node.text();
    std::vector<std::string_view> names;
    for (const auto& [name, value] : words) {
        if (name == text) return value;
        names.push_back(name);
    }
    node.fail(fmt::format("'{}' is not one of {}", text, fmt::join(names, ", ")));
}

class SceneReader {
  public:
    SceneReader(const JsonNode& root, const Settings& settings, bool facts)
        : root_(root), settings_(settings), facts_(facts) {
        root.allow_only({"inktrace", "settings", "materials", "lights", "objects", "description"});
        if (const auto version = root.find("inktrace")) {
            if (version->number(0, 1e9) != 1) {
                version->fail("this program reads version 1 of scene files; use a newer one");
            }
        }
    }

    FileContents read() {
        const auto objects = root_.at("objects").items();
        if (objects.empty()) root_.at("objects").fail("is empty; there is nothing to draw");
        contents_.format = "scene";
        for (const JsonNode& node : objects) add(node);
        contents_.counts = {{"objects", contents_.objects.size()}};
        return std::move(contents_);
    }

  private:
    void add(const JsonNode& node) {
        const std::size_t first = contents_.objects.size();
        const std::string type = node.at("type").text();
        if (type == "input") {
            add_input(node);
        } else if (type == "mesh") {
            add_mesh(node);
        } else if (auto shape = read_shape(node)) {
            contents_.objects.push_back(std::move(*shape));
        } else {
            std::vector<std::string_view> types = shape_types();
            types.insert(types.end(), {"mesh", "input"});
            node.at("type").fail(
                fmt::format("'{}' is not one of {}", type, fmt::join(types, ", ")));
        }
        for (std::size_t k = first; k < contents_.objects.size(); ++k) {
            describe(node, contents_.objects[k]);
        }
    }

    /// What any object may say of itself.
    void describe(const JsonNode& node, Object& object) const {
        if (const auto name = node.find("name")) object.name = name->text();
        if (const auto material = node.find("material")) {
            object.material = find_material(*material);
        }
        if (const auto color = node.find("color")) object.material.color = read_color(*color);
        if (const auto ids = node.find("ids")) {
            object.ids = read_word<IdLevel>(*ids, {{"primitive", IdLevel::primitive},
                                                   {"part", IdLevel::part},
                                                   {"object", IdLevel::object}});
        }
        if (const auto normals = node.find("normals")) {
            object.normals =
                read_word<NormalSource>(*normals, {{"auto", NormalSource::automatic},
                                                   {"shading", NormalSource::shading},
                                                   {"geometric", NormalSource::geometric}});
        }
    }

    Material find_material(const JsonNode& node) const {
        const std::string name = node.text();
        const auto materials = root_.find("materials");
        const auto found = materials ? materials->find(name) : std::nullopt;
        if (!found) node.fail(fmt::format("there is no material '{}' under \"materials\"", name));
        found->allow_only(
            {"color", "specular", "roughness", "metal", "mirror", "transparency", "ior"});
        Material material;
        if (const auto color = found->find("color")) material.color = read_color(*color);
        const auto read = [&](const char* key, double least, double most, float& value) {
            if (const auto given = found->find(key)) {
                value = static_cast<float>(given->number(least, most));
            }
        };
        read("specular", 0.0, 1.0, material.specular);
        read("roughness", kLeastRoughness, 1.0, material.roughness);
        read("metal", 0.0, 1.0, material.metal);
        read("mirror", 0.0, 1.0, material.mirror);
        read("transparency", 0.0, 1.0, material.transparency);
        read("ior", 1.0, 4.0, material.ior);
        return material;
    }

    /// Another file, by settings of topic Input of its own.
    void add_input(const JsonNode& node) {
        std::vector<std::string_view> keys = common_object_keys();
        keys.insert(keys.end(), {"file", "translate", "scale"});
        Settings settings = settings_;
        std::vector<std::string_view> inputs;
        for (const Setting& setting : settings_table()) {
            if (setting.topic == "Input") inputs.push_back(setting.name);
        }
        keys.insert(keys.end(), inputs.begin(), inputs.end());
        node.allow_only(keys);
        for (const auto& [key, value] : node.members()) {
            if (std::ranges::find(inputs, key) != inputs.end()) apply(key, value, settings);
        }
        const JsonNode name = node.at("file");
        std::filesystem::path file = name.text();
        if (file.is_relative()) file = root_.file().parent_path() / file;
        if (is_scene_file(file)) name.fail("is a scene; a scene cannot hold another one");
        FileContents read =
            read_file(file, {.frame = settings.frame, .data = settings.data, .facts = facts_});
        std::ranges::move(read.warnings, std::back_inserter(contents_.warnings));
        const auto shift = node.find("translate");
        const auto scale = node.find("scale");
        for (Object& object : read.objects) {
            if (scale) {
                const double factor = scale->positive();
                object.frame.unit *= factor;
                object.frame.origin = object.frame.origin * factor;
            }
            if (shift) object.frame.origin = object.frame.origin + shift->vector();
            contents_.objects.push_back(std::move(object));
        }
    }

    void add_mesh(const JsonNode& node) {
        std::vector<std::string_view> keys = common_object_keys();
        keys.insert(keys.end(), {"vertices", "faces"});
        node.allow_only(keys);
        PolygonMesh polygons;
        for (const JsonNode& vertex : node.at("vertices").items()) {
            polygons.add_position(vertex.vector());
        }
        const double last = static_cast<double>(polygons.positions.size()) - 1.0;
        for (const JsonNode& face : node.at("faces").items()) {
            for (const JsonNode& corner : face.items()) {
                const double index = corner.number(0, last);
                if (index != static_cast<double>(static_cast<std::uint32_t>(index))) {
                    corner.fail("is not a whole number");
                }
                polygons.corners.push_back(static_cast<std::uint32_t>(index));
            }
            polygons.end_polygon();
        }
        FileContents mesh = mesh_contents(root_.file(), std::move(polygons));
        mesh.objects.front().name = "mesh";
        contents_.objects.push_back(std::move(mesh.objects.front()));
        std::ranges::move(mesh.warnings, std::back_inserter(contents_.warnings));
    }

    const JsonNode& root_;
    const Settings& settings_;
    bool facts_;
    FileContents contents_;
};

}  // namespace

bool is_scene_file(const std::filesystem::path& file) {
    const std::string name = to_lower(file.filename().string());
    return name.ends_with(".json") || name.ends_with(".json.gz");
}

std::vector<std::pair<std::string, std::string>> read_scene_settings(
    const std::filesystem::path& file) {
    const JsonValue document = read_json(file);
    const JsonNode root(file, document);
    std::vector<std::pair<std::string, std::string>> list;
    Settings checked;
    if (const auto settings = root.find("settings")) {
        for (const auto& [name, value] : settings->members()) {
            apply(name, value, checked);
            list.emplace_back(name, value.as_words());
        }
    }
    if (const auto lights = root.find("lights")) {
        for (const JsonNode& light : lights->items()) list.emplace_back("light", light_text(light));
    }
    // A look sets other settings, which those that are named go before.
    std::ranges::stable_partition(list, [](const auto& entry) { return entry.first == "look"; });
    return list;
}

FileContents read_scene_file(const std::filesystem::path& file, const Settings& settings,
                             bool facts) {
    const JsonValue document = read_json(file);
    const JsonNode root(file, document);
    return SceneReader(root, settings, facts).read();
}

}  // namespace ink

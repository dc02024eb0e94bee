#include "sampling/geometry_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "sampling/line_ids.h"
#include "scene/elements.h"

namespace ink {

std::string GeometryName::label() const {
    std::string text = object;
    for (const std::string& word : {part, element}) {
        if (!word.empty()) text += (text.empty() ? "" : " ") + word;
    }
    if (index && (element.empty() ? part.empty() : true)) {
        text += fmt::format("{}{}", text.empty() ? "" : " ", *index + 1);
    }
    return text;
}

GeometryNames::GeometryNames(const Scene& scene, std::optional<IdLevel> level) {
    const LineIds ids(scene, level);
    for (std::size_t k = 0; k < scene.objects().size(); ++k) {
        const Object& object = scene.objects()[k];
        ObjectNames names{ids.first(k), ids.level(k), object.name, object.part_names, {}, {}};
        if (names.level == IdLevel::primitive && !std::holds_alternative<Mesh>(object.shape)) {
            names.parts = std::visit([](const auto& shape) { return shape.parts; }, object.shape);
            names.elements = object.elements;
        }
        objects_.push_back(std::move(names));
    }
}

std::size_t GeometryNames::object_of(GeometryId id) const {
    const auto next = std::ranges::upper_bound(objects_, id, {}, &ObjectNames::first);
    return static_cast<std::size_t>(next - objects_.begin()) - 1;
}

GeometryName GeometryNames::operator()(GeometryId id) const {
    if (id == kBackground || objects_.empty()) return {};
    const ObjectNames& object = objects_[object_of(id)];
    const std::uint32_t index = id - object.first;
    GeometryName name{.object = object.name, .part = {}, .element = {}, .index = index};
    if (object.level == IdLevel::object) name.index.reset();
    std::optional<std::uint32_t> part;
    if (object.level == IdLevel::part) part = index;
    if (index < object.parts.size()) part = object.parts[index];
    if (part && *part < object.part_names.size()) name.part = object.part_names[*part];
    if (index < object.elements.size()) name.element = element(object.elements[index]).symbol;
    return name;
}

}  // namespace ink

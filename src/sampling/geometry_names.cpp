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
        const CopyNumbering numbers = numbering(object.shape);
        ObjectNames names{.first = ids.first(k),
                          .level = ids.level(k),
                          .name = object.name,
                          .part_names = object.part_names,
                          .copies = {numbers.copies.begin(), numbers.copies.end()},
                          .originals = numbers.originals,
                          .parts_a_copy = numbers.parts_a_copy};
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
    const CopyNumbering numbers = object.numbering();
    const std::size_t source = numbers.source(index);
    if (source < object.parts.size()) part = object.parts[source] + numbers.first_part(index);
    if (part) name.part = name_of_part(object.part_names, numbers.parts_a_copy, *part);
    if (source < object.elements.size()) name.element = element(object.elements[source]).symbol;
    return name;
}

}  // namespace ink

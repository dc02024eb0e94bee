#include "sampling/line_ids.h"

#include <algorithm>
#include <variant>

#include "base/multiversion.h"

namespace ink {

namespace {

using Groups = std::vector<std::uint32_t>;

/// Which group each primitive of an object belongs to at a level; null where each is one of its own
/// (primitive) or all are one (object). A polygon counts as one primitive, however it was cut into
/// triangles.
const Groups* groups(const Object& object, IdLevel level) {
    const Groups* found = nullptr;
    if (level == IdLevel::part) {
        found = std::visit([](const auto& shape) { return &shape.parts; }, object.shape);
    } else if (const auto* mesh = std::get_if<Mesh>(&object.shape);
               mesh != nullptr && level == IdLevel::primitive) {
        found = &mesh->faces;
    }
    return found == nullptr || found->empty() ? nullptr : found;
}

/// All lanes hit one object, or nothing. One packet: of several, GCC leaves the last one to a
/// branch a lane.
INKTRACE_MULTIVERSION
void resolve_one_object(const HitPacket& hits, GeometryId first, std::uint32_t stride,
                        Lanes<GeometryId>& __restrict ids) {
    for (int i = 0; i < kLanes; ++i) {
        const GeometryId id = first + stride * hits.primitive[i];
        ids[i] = hits.object[i] == kNoObject ? kBackground : id;
    }
}

}  // namespace

LineIds::LineIds(const Scene& scene, std::optional<IdLevel> level) {
    GeometryId next = kBackground + 1;
    for (const Object& object : scene.objects()) {
        const IdLevel by_kind =
            object.kind == ObjectKind::mesh ? IdLevel::object : IdLevel::primitive;
        const IdLevel usual = object.usual_ids.value_or(by_kind);
        add(object, object.ids.value_or(level.value_or(usual)), next);
    }
}

LineIds LineIds::at_level(const Scene& scene, IdLevel level) {
    LineIds ids;
    GeometryId next = kBackground + 1;
    for (const Object& object : scene.objects()) ids.add(object, level, next);
    return ids;
}

void LineIds::add(const Object& object, IdLevel level, GeometryId& next) {
    const bool continues = object.continues_previous && !objects_.empty();
    if (const Groups* own_groups = groups(object, level)) {
        const bool shared = continues && objects_.back().groups != nullptr;
        const GeometryId first = shared ? objects_.back().first : next;
        const CopyNumbering numbers = numbering(object.shape);
        const bool of_wholes = level == IdLevel::part && !object.part_wholes.empty();
        objects_.push_back({first, 0, own_groups, numbers,
                            of_wholes ? &object.part_wholes : nullptr, false, level});
        std::uint32_t last_copy = 0;
        for (const Copy& copy : numbers.copies) last_copy = std::max(last_copy, copy.number);
        next = std::max(next, first + *std::ranges::max_element(*own_groups) + 1 +
                                  numbers.parts_a_copy * last_copy);
    } else if (continues && level != IdLevel::primitive && objects_.back().stride == 0) {
        objects_.push_back(
            {objects_.back().first, 0, nullptr, {}, nullptr, false, IdLevel::object});
    } else if (level == IdLevel::primitive) {
        const auto* glyphs = std::get_if<Glyphs>(&object.shape);
        const bool ball = std::holds_alternative<Spheres>(object.shape) ||
                          (glyphs != nullptr && glyphs->shape.kind == GlyphKind::ellipsoid);
        objects_.push_back({next, 1, nullptr, {}, groups(object, IdLevel::part), ball});
        next += static_cast<GeometryId>(object.primitive_count());
    } else {
        objects_.push_back({next, 0, nullptr, {}, nullptr, false, IdLevel::object});
        next += 1;
    }
}

void LineIds::resolve(std::span<const HitPacket> hits, Lanes<GeometryId>* ids) const {
    const bool one_object = objects_.size() == 1 && objects_[0].groups == nullptr;
    for (const HitPacket& packet : hits) {
        if (one_object) {
            resolve_one_object(packet, objects_[0].first, objects_[0].stride, *ids++);
            continue;
        }
        for (int i = 0; i < kLanes; ++i) {
            (*ids)[i] = resolve(packet.object[i], packet.primitive[i]);
        }
        ++ids;
    }
}

GeometryId LineIds::resolve(std::uint32_t object, std::uint32_t primitive) const {
    if (object == kNoObject) return kBackground;
    const ObjectIds& own = objects_[object];
    if (own.groups == nullptr) return own.first + own.stride * primitive;
    const auto& groups = *own.groups;
    return own.first + groups[own.numbers.source(primitive)] + own.numbers.first_part(primitive);
}

bool LineIds::of_one_whole(GeometryId a, GeometryId b) const {
    const ObjectIds& first = objects_[object_of(a)];
    const ObjectIds& second = objects_[object_of(b)];
    if (first.wholes == nullptr || second.wholes == nullptr) return a == b;
    // Objects that share their IDs share their parts.
    const bool related = &first == &second || first.wholes == second.wholes;
    const std::size_t a_copy = first.wholes->size();
    const std::size_t offset = a - first.first;
    const std::size_t other = b - second.first;
    return related && offset / a_copy == other / a_copy &&
           (*first.wholes)[offset % a_copy] == (*second.wholes)[other % a_copy];
}

std::vector<IdLevel> LineIds::levels() const {
    std::vector<IdLevel> levels;
    levels.reserve(objects_.size());
    for (const ObjectIds& object : objects_) levels.push_back(object.level);
    return levels;
}

std::size_t LineIds::object_of(GeometryId id) const {
    const auto after = std::ranges::upper_bound(objects_, id, {}, &ObjectIds::first);
    return static_cast<std::size_t>(after - objects_.begin()) - 1;
}

}  // namespace ink

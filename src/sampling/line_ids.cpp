#include "sampling/line_ids.h"

#include <algorithm>
#include <variant>

#include "base/multiversion.h"

namespace ink {

namespace {

const std::vector<std::uint32_t>& parts_of(const Object& object) {
    return std::visit([](const auto& shape) -> const auto& { return shape.parts; }, object.shape);
}

/// All lanes hit one object, or nothing.
INKTRACE_MULTIVERSION
void resolve_one_object(const HitPacket& hits, GeometryId first, std::uint32_t stride,
                        Lanes<GeometryId>& ids) {
    for (int i = 0; i < kLanes; ++i) {
        const GeometryId id = first + stride * hits.primitive[i];
        ids[i] = hits.object[i] == kNoObject ? kBackground : id;
    }
}

}  // namespace

LineIds::LineIds(const Scene& scene, std::optional<IdLevel> level) {
    GeometryId next = kBackground + 1;
    for (const Object& object : scene.objects()) {
        const IdLevel own = level.value_or(object.kind == ObjectKind::mesh ? IdLevel::object
                                                                           : IdLevel::primitive);
        const auto& parts = parts_of(object);
        if (own == IdLevel::primitive) {
            objects_.push_back({next, 1, nullptr});
            next += static_cast<GeometryId>(object.primitive_count());
        } else if (own == IdLevel::part && !parts.empty()) {
            objects_.push_back({next, 0, &parts});
            next += static_cast<GeometryId>(std::max<std::size_t>(object.part_names.size(), 1));
        } else {
            objects_.push_back({next, 0, nullptr});
            next += 1;
        }
    }
}

void LineIds::resolve(const HitPacket& hits, Lanes<GeometryId>& ids) const {
    if (objects_.size() == 1 && objects_[0].parts == nullptr) {
        resolve_one_object(hits, objects_[0].first, objects_[0].stride, ids);
        return;
    }
    for (int i = 0; i < kLanes; ++i) ids[i] = resolve(hits.object[i], hits.primitive[i]);
}

GeometryId LineIds::resolve(std::uint32_t object, std::uint32_t primitive) const {
    if (object == kNoObject) return kBackground;
    const ObjectIds& own = objects_[object];
    return own.first + (own.parts != nullptr ? (*own.parts)[primitive] : own.stride * primitive);
}

}  // namespace ink

#include "scene/particle_glyphs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/text.h"

namespace ink {

namespace {

constexpr std::array<std::string_view, 15> kNames{
    // Deformation gradients; "p.deformationmeasure" is Uintah's.
    "f", "defgrad", "deformation_gradient", "deformationgradient", "deformation",
    "p.deformationmeasure", "tensor",
    // Orientations.
    "quat", "c_quat", "q", "quaternion", "orientation", "c_orient",
    // Half axes as OVITO writes them; then diameters as LAMMPS does.
    "asphericalshape", "shape"};
constexpr std::size_t kFirstOrientation = 7;
constexpr std::size_t kFirstSize = 13;
constexpr std::string_view kDiameters = "shape";

bool is_tensor(const Field& field) {
    return field.components == 9 || field.components == 6 || field.components == 4;
}

/// The first field with a name of the list and as many components.
template <class Fits>
const Field* find(std::span<const Field> fields, std::span<const std::string_view> names,
                  const Fits& fits) {
    for (const std::string_view name : names) {
        for (const Field& field : fields) {
            if (to_lower(field.name) == name && fits(field)) return &field;
        }
    }
    return nullptr;
}

const Field& find_named(std::span<const Field> fields, const std::string& name) {
    const auto found = std::ranges::find(fields, name, &Field::name);
    if (found == fields.end()) {
        throw Error(fmt::format(
            "--glyph-field: there is no field '{}'; 'inktrace info' lists what there is", name));
    }
    if (!is_tensor(*found)) {
        throw Error(
            fmt::format("--glyph-field: '{}' has {} components; expected 9 or 6 of a "
                        "tensor, or 4 of a quaternion",
                        name, found->components));
    }
    return *found;
}

/// Whether four components are a tensor in the plane, and not a quaternion.
bool is_planar_tensor(const Field& field) {
    const auto tensors = std::span(kNames).first(kFirstOrientation);
    return field.components == 4 &&
           std::ranges::find(tensors, to_lower(field.name)) != tensors.end();
}

std::array<Vec3d, 3> columns_of(std::span<const float> f) {
    if (f.size() == 4) return {{{f[0], f[2], 0}, {f[1], f[3], 0}, {0, 0, 1}}};
    if (f.size() == 6) return {{{f[0], f[3], f[5]}, {f[3], f[1], f[4]}, {f[5], f[4], f[2]}}};
    return {{{f[0], f[3], f[6]}, {f[1], f[4], f[7]}, {f[2], f[5], f[8]}}};
}

/// Columns of the rotation of a quaternion of any length but zero.
std::array<Vec3d, 3> rotation_of(std::span<const float> q) {
    const double w = q[0];
    const double x = q[1];
    const double y = q[2];
    const double z = q[3];
    const double s = 2.0 / (w * w + x * x + y * y + z * z);
    return {{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
             {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
             {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
}

}  // namespace

std::span<const std::string_view> glyph_field_names() { return kNames; }

GlyphAxes::GlyphAxes(std::span<const Field> fields, const DataSettings& settings,
                     std::vector<std::string>& warnings) {
    const std::span names(kNames);
    if (!settings.glyph_field.empty()) {
        const Field& named = find_named(fields, settings.glyph_field);
        const bool turns = named.components == 4 && !is_planar_tensor(named);
        (turns ? orientation_ : deformation_) = &named;
    } else {
        deformation_ = find(fields, names.first(kFirstOrientation), is_tensor);
    }
    if (deformation_ == nullptr && orientation_ == nullptr) {
        orientation_ =
            find(fields, names.subspan(kFirstOrientation, kFirstSize - kFirstOrientation),
                 [](const Field& field) { return field.components == 4; });
    }
    if (settings.radius.empty()) {
        sizes_ = find(fields, names.subspan(kFirstSize),
                      [](const Field& field) { return field.components == 3; });
    }
    if (sizes_ != nullptr && to_lower(sizes_->name) == kDiameters) size_scale_ = 0.5F;
    if (deformation_ == nullptr && orientation_ == nullptr && sizes_ == nullptr) {
        warnings.emplace_back(
            "The particles have no deformation gradient or orientation that is known by its name; "
            "all glyphs are alike (--glyph-field names one).");
    }
}

std::span<const float> GlyphAxes::values(const Field& field, std::size_t particle) const {
    return std::span(field.values).subspan(particle * field.components, field.components);
}

Placement GlyphAxes::placement(std::size_t particle, float radius) const {
    std::array<Vec3d, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (deformation_ != nullptr) {
        axes = columns_of(values(*deformation_, particle));
    } else if (orientation_ != nullptr) {
        axes = rotation_of(values(*orientation_, particle));
    }
    std::array<double, 3> half{radius, radius, radius};
    if (sizes_ != nullptr) {
        const auto sizes = values(*sizes_, particle);
        for (std::size_t k = 0; k < 3; ++k) half[k] = sizes[k] * size_scale_;
    }
    return {
        to_float(axes[0] * half[0]), to_float(axes[1] * half[1]), to_float(axes[2] * half[2]), {}};
}

}  // namespace ink

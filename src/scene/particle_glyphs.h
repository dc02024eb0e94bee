#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/data_settings.h"
#include "scene/field.h"
#include "scene/glyphs.h"

namespace ink {

/// Names that the fields go by which shape glyphs, in lower case: deformation gradients, then
/// orientations, then half axes or diameters.
std::span<const std::string_view> glyph_field_names();

/// The shapes of particles that are drawn as boxes or ellipsoids. A deformation gradient F turns a
/// cube or ball of the particle's radius into one whose half axes are the columns of F, times the
/// radius: 9 components by rows, 6 of a symmetric tensor (xx yy zz xy yz xz), or F11 F12 F21 F22 in
/// the plane. A unit quaternion (w x y z) turns half axes, or cubes of the particle's radius.
class GlyphAxes {
  public:
    /// Takes `glyph_field`, else what goes by its usual name; with a warning where there is
    /// nothing. Throws Error where `glyph_field` is not there or has other numbers of components.
    GlyphAxes(std::span<const Field> fields, const DataSettings& settings,
              std::vector<std::string>& warnings);

    /// Whether the particles have half axes of their own and need no radius.
    bool have_sizes() const { return sizes_ != nullptr; }

    /// The glyph about the origin; without volume where the field's values make none.
    Placement placement(std::size_t particle, float radius) const;

  private:
    std::span<const float> values(const Field& field, std::size_t particle) const;

    const Field* deformation_ = nullptr;
    const Field* orientation_ = nullptr;
    const Field* sizes_ = nullptr;
    float size_scale_ = 1.0F;  ///< from the field's numbers to half axes
};

}  // namespace ink

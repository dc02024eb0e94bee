#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scene/data_settings.h"
#include "scene/field.h"

namespace ink {

/// Where the numbers of named columns go: the fields that are drawn, of one component or several.
struct FieldLayout {
    struct Place {
        std::size_t field, component;
    };
    std::vector<Field> fields;                  ///< empty yet
    std::size_t needed = 0;                     ///< of `fields`: others may lack values
    std::vector<std::vector<Place>> of_column;  ///< one list a column; empty: not drawn
};

/// The fields that the settings ask for, and those of radii, glyphs and kinds that go by their
/// usual names. A field is a column, or the columns of a vector (vx vy vz), a tensor (F11 ... F33,
/// sxx syy szz sxy syz sxz) or a quaternion (quatw quati quatj quatk; w comes first). `others` are
/// wanted beside them.
FieldLayout lay_out_fields(const std::vector<std::string>& columns, const DataSettings& settings,
                           const std::vector<std::string>& others);

/// Whether the settings ask for an array of that name, or its usual name does.
bool is_drawn_field(std::string_view name, const DataSettings& settings);

}  // namespace ink

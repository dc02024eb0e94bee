#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/color_scale.h"
#include "scene/data_settings.h"
#include "scene/molecule.h"

namespace ink {

/// What atoms are coloured by unless told: "element", or "chain" where there are so many of them
/// that single ones are too small to mean much.
std::string_view usual_coloring(const Molecule& molecule);

/// Colours of the atoms by `color_by`. Throws Error where it names what the molecule does not have.
Coloring color_atoms(const Molecule& molecule, const DataSettings& settings);

/// A number an atom; "radius" is that of the file. Empty where there is no such field.
std::vector<float> atom_field(const Molecule& molecule, const std::string& name);

/// Throws the Error that the atoms have no field `name`, which `flag` asks for instead of `words`.
[[noreturn]] void refuse_field(std::string_view flag, std::string_view name, std::string_view words,
                               const Molecule& molecule);

}  // namespace ink

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/data_settings.h"
#include "scene/molecule.h"
#include "scene/scene.h"

namespace ink {

/// The molecule as objects to draw: spheres, sticks, or both. `select`, `assembly` and `clip` have
/// been applied already.
/// Parts are chains unless `parts` says otherwise; colours are those of `color_atoms`. Throws Error
/// where the settings name what the molecule does not have.
std::vector<Object> represent(const Molecule& molecule, const DataSettings& settings);

/// The number that the text of `--radius` is, if it is one. Throws UsageError unless it is positive
/// and finite.
std::optional<double> uniform_radius(const std::string& text);

}  // namespace ink

#pragma once

#include <optional>

#include "scene/data_settings.h"
#include "scene/molecule.h"
#include "scene/scene.h"

namespace ink {

/// Radius of bonds, in angstrom.
double stick_radius(const DataSettings& settings);

/// The bonds of the molecule as an object that belongs to that of its atoms; nothing where there
/// are none.
std::optional<Object> make_sticks(const Molecule& molecule, const Object& atoms,
                                  const DataSettings& settings);

}  // namespace ink

#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scene/bonds.h"
#include "scene/data_settings.h"
#include "scene/scene.h"

namespace ink {

/// Radius of bonds, in angstrom.
double stick_radius(const DataSettings& settings);

/// Bonds between atoms of one object as an object that belongs to it, with its copies; nothing
/// where there are none.
std::optional<Object> make_sticks(const Object& atoms, std::span<const Bond> bonds,
                                  const DataSettings& settings);

/// Bonds between copies: `atoms[u]` are those of unit u.
std::optional<Object> make_sticks(std::span<const Object> atoms, std::span<const CopyBond> bonds,
                                  const DataSettings& settings);

}  // namespace ink

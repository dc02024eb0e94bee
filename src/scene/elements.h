#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/color.h"
#include "scene/data_settings.h"

namespace ink {

/// A chemical element as it is drawn.
struct Element {
    std::string_view symbol;
    float vdw_radius;  ///< angstrom
    Rgb8 color;
};

/// Number of entries of the table: atomic numbers 0 (unknown) to 118.
inline constexpr std::size_t kElementCount = 119;

/// By atomic number; 0 is the unknown element, drawn pink with radius 1.5. Sources: elements.cpp.
const Element& element(std::uint8_t atomic_number);

/// Radius in angstrom from one of the tables; 1.5 (covalent: 0.77) for the unknown element.
float atom_radius(RadiiTable table, std::uint8_t atomic_number);

/// Atomic number of a symbol, in any case ("CA" is calcium; "D" and "T" are hydrogen); nothing for
/// no element.
std::optional<std::uint8_t> atomic_number(std::string_view symbol);

}  // namespace ink

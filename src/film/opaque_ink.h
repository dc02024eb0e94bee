#pragma once

#include <cstddef>
#include <cstdint>

#include "base/color.h"
#include "base/lanes.h"

namespace ink {

/// Lays one ink over 4 x 4 opaque pixels, the first of which is given, and the length of their
/// rows. False, and nothing is laid, if any is not opaque. Pixels without ink stay as they are.
bool lay_on_opaque(const Lanes<float>& alpha, Color color, std::uint32_t* pixels,
                   std::size_t stride);

}  // namespace ink

#pragma once

#include <string>

#include "lines/curve.h"

namespace ink {

/// Appends what the attribute d of an SVG path says of a curve. Places are rounded to hundredths of
/// a pixel, a twentieth of the default tolerance at most, and then told as steps from the place
/// before, which take half the room: their rounding does not add up.
void append_path_data(std::string& text, const Curve& curve, bool closed);

}  // namespace ink

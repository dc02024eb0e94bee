#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shading/lights.h"

namespace ink {

/// The kinds of light, as users write them.
std::vector<std::string_view> light_kinds();

/// Reads "KIND:key=value,...", several with semicolons between: camera, sun, disc or sky, with the
/// keys from, size, strength, color and ground. Throws UsageError.
std::vector<LightRule> read_lights(std::string_view text);
/// In the form that read_lights reads.
std::string print(const std::vector<LightRule>& lights);

}  // namespace ink

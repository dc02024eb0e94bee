#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shading/material_rules.h"

namespace ink {

/// Reads "[OBJECT:]key=value,...", several with semicolons between; keys are those of Material.
/// Throws UsageError.
std::vector<MaterialRule> read_material_rules(std::string_view text);
/// In the form that read_material_rules reads.
std::string print(const std::vector<MaterialRule>& rules);

}  // namespace ink

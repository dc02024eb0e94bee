#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace ink {

struct Settings;

/// A named set of settings' values.
struct Look {
    std::string_view name;
    std::string_view what;  ///< it shows, in a few words
    std::vector<std::pair<std::string_view, std::string_view>> values;
    std::string_view lines = {};  ///< rules that come before those of --line
    bool by_residue = false;      ///< molecules have lines between residues, not atoms
};

const std::vector<Look>& looks();

/// Sets what looks set to its usual value, then what this one does. An empty name: no more. Throws
/// UsageError if there is no such look.
void set_look(Settings& settings, std::string_view name);

}  // namespace ink

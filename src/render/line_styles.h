#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/color.h"
#include "lines/line_type.h"
#include "render/values.h"

namespace ink {

/// How lines of one type, of one object, or both differ from the others. What is left open stays
/// as it is.
struct LineRule {
    std::optional<LineType> type;  ///< of every type if open
    bool hidden = false;           ///< instead: hidden lines, whatever their type
    /// Instead: lines within one whole, whatever their type: between atoms of a chain, residues of
    /// a chain, primitives of any part.
    bool inner = false;
    int object = 0;            ///< counted from 1 in the order of the scene; 0: of every object
    std::optional<int> level;  ///< of every level if open
    bool and_beyond = false;   ///< of that level and all that follow
    std::optional<Length> width;
    std::optional<Rgb8> color;
    std::optional<double> opacity;  ///< [0, 1]

    bool applies(LineType of_type, int of_object, int of_level, bool is_inner) const {
        return !hidden && (!inner || is_inner) && (!type || *type == of_type) &&
               concerns(of_object) &&
               (!level || *level == of_level || (and_beyond && of_level > *level));
    }
    bool applies_to_hidden(int of_object) const { return hidden && concerns(of_object); }
    bool concerns(int of_object) const { return object == 0 || object == of_object; }
};

/// How a line is drawn after all rules.
struct StrokeStyle {
    double width_px = 0.0;
    Rgb8 color;
    double opacity = 1.0;
    friend bool operator==(const StrokeStyle&, const StrokeStyle&) = default;
};

/// The name of a type as users write it.
std::string_view name_of(LineType type);
/// Throws UsageError for a name that is none.
LineType read_line_type(std::string_view text);

/// Reads "TYPE[@OBJECT][/LEVEL]:key=value,...", several with semicolons between. TYPE is a line
/// type, all, inner or hidden; LEVEL says by way of how many specular surfaces lines are seen, 0
/// for directly and + for one or more; keys are width, color and opacity. Throws UsageError.
std::vector<LineRule> read_line_rules(std::string_view text);
/// In the form that read_line_rules reads.
std::string print(const std::vector<LineRule>& rules);

}  // namespace ink

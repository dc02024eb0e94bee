#include "render/looks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "render/settings.h"

namespace ink {

namespace {

/// All that looks may set.
constexpr std::array<std::string_view, 13> kGoverned{
    "background", "compose", "line-color", "line-width", "line-density", "line-fade", "line-taper",
    "halo",       "shade",   "ambient",    "shadows",    "pastel",       "fog"};

}  // namespace

const std::vector<Look>& looks() {
    static const std::vector<Look> kLooks{
        {"plain", "diffuse light alone, as in the paper", {{"ambient", "0"}}},
        {"soft", "light from all around, dark in clefts", {{"ambient", "1"}}},
        {"toon",
         "light in four tones; bold outlines",
         {{"shade", "toon"}, {"ambient", "0.6"}, {"line-width", "2px"}},
         "silhouette:width=5px;boundary:width=5px;crease:width=2px;inner:width=1.6px"},
        {"goodsell",
         "flat pale colours; outlines by chain and residue; pale with distance",
         {{"shade", "flat"},
          {"ambient", "0.45"},
          {"pastel", "0.28"},
          {"fog", "0.38"},
          {"line-density", "0.4"},
          {"line-fade", "0.25"}},
         "inner:width=1.2px;crease:width=1.5px",
         true},
        {"technical",
         "from cool to warm; bold outlines, thin creases",
         {{"shade", "gooch"},
          {"ambient", "0.35"},
          {"line-width", "1.5px"},
          {"line-density", "0.4"}},
         "silhouette:width=3.5px;boundary:width=3.5px;crease:width=1.2px;inner:width=1.2px"},
        {"ink",
         "black lines on white, thinner with distance",
         {{"compose", "lines"},
          {"ambient", "0"},
          {"line-density", "0.4"},
          {"line-taper", "0.55"},
          {"halo", "3px"}},
         "silhouette:width=4px;boundary:width=4px;inner:width=1.2px"},
        {"blueprint",
         "white lines on blue",
         {{"background", "#17407a"},
          {"line-color", "#eaf2ff"},
          {"line-width", "1.5px"},
          {"shade", "none"},
          {"ambient", "0"},
          {"line-density", "0.5"},
          {"line-fade", "0.4"}},
         "silhouette:width=3.5px;boundary:width=3.5px;crease:width=1.5px;inner:width=1.3px"}};
    return kLooks;
}

void set_look(Settings& settings, std::string_view name) {
    const auto found = std::ranges::find(looks(), name, &Look::name);
    if (!name.empty() && found == looks().end()) {
        std::vector<std::string_view> names;
        for (const Look& look : looks()) names.push_back(look.name);
        throw UsageError(fmt::format("'{}' is not one of {}", name, fmt::join(names, ", ")));
    }
    const Settings usual;
    for (const std::string_view governed : kGoverned) {
        const Setting& setting = find_setting(governed);
        setting.set(settings, setting.get(usual));
    }
    settings.look = name;
    settings.look_rules.clear();
    settings.data.by_residue = false;
    if (name.empty()) return;
    for (const auto& [key, value] : found->values) find_setting(key).set(settings, value);
    if (!found->lines.empty()) settings.look_rules = read_line_rules(found->lines);
    settings.data.by_residue = found->by_residue;
}

}  // namespace ink

// Rows of the table of settings: looks, light, and what changes with the distance from the viewer.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "render/light_text.h"
#include "render/looks.h"
#include "render/settings.h"
#include "render/words.h"

namespace ink {

namespace {

const Words<ShadowMode> kShadowModes{
    {{"none", ShadowMode::none}, {"hard", ShadowMode::hard}, {"soft", ShadowMode::soft}}};
std::vector<std::string_view> look_names() {
    std::vector<std::string_view> names;
    for (const Look& look : looks()) names.push_back(look.name);
    return names;
}

std::string looks_help() {
    std::vector<std::string> texts;
    for (const Look& look : looks()) texts.push_back(fmt::format("{} ({})", look.name, look.what));
    return fmt::format(
        "A set of values for other settings, each of which can still be given: {}; without it soft "
        "for atoms and particles drawn as spheres, plain for all else",
        fmt::join(texts, ", "));
}

}  // namespace

std::vector<Setting> look_rows() {
    static const std::string kHelp = looks_help();
    return {{"look", "Look", "NAME", kHelp, [](Settings& s, std::string_view t) { set_look(s, t); },
             [](const Settings& s) { return s.look; }, false,
             ValueForm{ValueForm::Kind::word, look_names()}}};
}

std::vector<Setting> light_rows() {
    using S = Settings;
    using Text = std::string_view;
    return {
        {"ambient", "Shading", "F",
         "Share of light that comes from all around and is dim in clefts (ambient occlusion); by "
         "default 1 for atoms and particles drawn as spheres, 0 for all else, with another --shade "
         "than lambert and for method stencil",
         [](S& s, Text t) {
             s.shading.ambient =
                 read_optional(t, [](Text v) { return static_cast<float>(read_number(v, 0, 1)); });
         },
         [](const S& s) {
             return s.shading.ambient ? fmt::format("{}", *s.shading.ambient) : std::string();
         },
         false, number(0, 1)},
        {"ambient-quality", "Shading", "N",
         "Ambient occlusion: each step from 1 to 5 looks into twice as many directions",
         [](S& s, Text t) { s.shading.ambient_quality = read_int(t, 1, kMostAmbientQuality); },
         [](const S& s) { return fmt::format("{}", s.shading.ambient_quality); }, false,
         whole(1, kMostAmbientQuality)},
        {"light", "Shading", "KIND:...",
         "A light instead of the usual ones: camera:from=RIGHT,UP,BACK (moves with the viewer), "
         "sun:from=X,Y,Z (a direction), disc:from=X,Y,Z (a place) or sky; with strength=F, "
         "color=COLOR, size=DEG (of a disc its radius), for sky ground=COLOR; may be repeated",
         [](S& s, Text t) {
             auto& all = s.shading.lights;
             if (t.empty()) return all.clear();
             for (const LightRule& light : read_lights(t)) all.push_back(light);
         },
         [](const S& s) { return print(s.shading.lights); }, true},
        {"shadows", "Shading", "HOW",
         "Shadows that things cast on each other: none, hard, or soft (by the size of each light)",
         [](S& s, Text t) { s.shading.shadows = kShadowModes.read(t); },
         [](const S& s) { return kShadowModes.print(s.shading.shadows); }, false,
         one_of(kShadowModes)},
        {"pastel", "Shading", "F", "Share of white in every colour",
         [](S& s, Text t) { s.shading.pastel = static_cast<float>(read_number(t, 0, 1)); },
         [](const S& s) { return fmt::format("{}", s.shading.pastel); }, false, number(0, 1)},
        {"fog", "Shading", "F", "Share of the background's colour in what is farthest",
         [](S& s, Text t) { s.shading.fog = static_cast<float>(read_number(t, 0, 1)); },
         [](const S& s) { return fmt::format("{}", s.shading.fog); }, false, number(0, 1)},
        {"line-fade", "Lines", "F",
         "Method edges: share of their ink that the farthest lines lose, others by their distance",
         [](S& s, Text t) { s.line_fade = read_number(t, 0, 1); },
         [](const S& s) { return fmt::format("{}", s.line_fade); }, false, number(0, 1)},
        {"line-taper", "Lines", "F",
         "Method edges: share of their width that the farthest lines lose, others by their "
         "distance",
         [](S& s, Text t) { s.line_taper = read_number(t, 0, 1); },
         [](const S& s) { return fmt::format("{}", s.line_taper); }, false, number(0, 1)},
        {"halo", "Lines", "LEN",
         "Method edges: gap that outlines leave around them in what lies far behind them",
         [](S& s, Text t) { s.halo = read_length(t, true); },
         [](const S& s) { return print(s.halo); }, false, length_px(0, 20)},
    };
}

}  // namespace ink

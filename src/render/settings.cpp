#include "render/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <variant>

#include "base/error.h"
#include "base/text.h"
#include "render/looks.h"
#include "render/material_text.h"
#include "render/values.h"
#include "render/words.h"

namespace ink {

namespace {

// Readers and printers of values. Readers throw UsageError without the setting's name; Table adds
// it.

Size read_size(std::string_view text) {
    // libpng, libtiff and libjpeg agree on this much; memory is checked with the other settings.
    constexpr int kMost = 65500;
    const auto sides = split(text, 'x');
    const auto is_whole = [](std::string_view side) { return parse_int(side).has_value(); };
    if (sides.size() != 2 || !std::ranges::all_of(sides, is_whole)) {
        throw UsageError(fmt::format(
            "'{}' is not a size; write WIDTHxHEIGHT in pixels, as in 1024x768 (85 mm at "
            "600 dpi: 85 / 25.4 * 600 = 2008)",
            text));
    }
    const auto side = [&](std::string_view part) {
        const auto value = parse_int(part);
        if (*value < 1 || *value > kMost) {
            throw UsageError(
                fmt::format("'{}' has a side that is not from 1 to {} pixels", text, kMost));
        }
        return static_cast<int>(*value);
    };
    return {side(sides[0]), side(sides[1])};
}

double read_view_height(std::string_view text) {
    return text == "auto" ? 0.0 : read_number(text, 1e-30, 1e30);
}

std::string print(Vec3d v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

const Words<View> kViews{{{"auto", View::automatic},
                          {"front", View::front},
                          {"back", View::back},
                          {"left", View::left},
                          {"right", View::right},
                          {"top", View::top},
                          {"bottom", View::bottom},
                          {"iso", View::iso}}};
const Words<Method> kMethods{{{"edges", Method::edges}, {"stencil", Method::stencil}}};
const Words<LineType> kLineTypeWords = [] {
    Words<LineType> words;
    for (int type = 0; type < kLineTypes; ++type) {
        const auto line_type = static_cast<LineType>(type);
        words.entries.emplace_back(name_of(line_type), line_type);
    }
    return words;
}();
const Words<IdLevel> kIdLevels{
    {{"primitive", IdLevel::primitive}, {"part", IdLevel::part}, {"object", IdLevel::object}}};
const Words<NormalSource> kNormalSources{{{"auto", NormalSource::automatic},
                                          {"shading", NormalSource::shading},
                                          {"geometric", NormalSource::geometric}}};
const Words<Compose> kComposes{
    {{"shaded", Compose::shaded}, {"lines", Compose::lines}, {"both", Compose::both}}};
const Words<ShadeMode> kShadeModes{{{"lambert", ShadeMode::lambert},
                                    {"toon", ShadeMode::toon},
                                    {"gooch", ShadeMode::gooch},
                                    {"flat", ShadeMode::flat},
                                    {"none", ShadeMode::none}}};
const Words<LegendPlace> kLegendPlaces{{{"auto", LegendPlace::automatic},
                                        {"none", LegendPlace::none},
                                        {"top-left", LegendPlace::top_left},
                                        {"top-right", LegendPlace::top_right},
                                        {"bottom-left", LegendPlace::bottom_left},
                                        {"bottom-right", LegendPlace::bottom_right}}};
const Words<Fill> kFills{{{"auto", Fill::automatic},
                          {"none", Fill::none},
                          {"flat", Fill::flat},
                          {"two-tone", Fill::two_tone},
                          {"image", Fill::image}}};
const Words<LineBlend> kBlends{{{"auto", LineBlend::automatic},
                                {"display", LineBlend::display},
                                {"linear", LineBlend::linear}}};
const Words<Aov> kAovs{{{"id", Aov::id},
                        {"depth", Aov::depth},
                        {"normal", Aov::normal},
                        {"position", Aov::position},
                        {"lines", Aov::lines}}};

Metric read_metric(std::string_view text) {
    if (text == "linear") return {Metric::Kind::linear};
    if (text == "solid") return {Metric::Kind::solid};
    if (text == "power") return {Metric::Kind::power};
    if (text.starts_with("power:")) {
        return {Metric::Kind::power, read_number(text.substr(6), 1.0, 1000.0)};
    }
    throw UsageError(fmt::format("'{}' is not one of linear, power:P, solid", text));
}

std::string print(const Metric& metric) {
    switch (metric.kind) {
        case Metric::Kind::linear: return "linear";
        case Metric::Kind::power: return fmt::format("power:{}", metric.exponent);
        case Metric::Kind::solid: return "solid";
    }
    return {};
}

/// "dashed:6,2": lengths of dash and gap in line widths.
HiddenLines read_hidden(std::string_view text) {
    using Kind = HiddenLines::Kind;
    if (text == "none") return {Kind::none};
    if (text == "solid") return {Kind::solid};
    if (text == "dashed") return {Kind::dashed};
    if (text.starts_with("dashed:")) {
        const auto lengths = split(text.substr(7), ',');
        const auto dash = parse_double(lengths[0]);
        const auto gap = lengths.size() == 2 ? parse_double(lengths[1]) : std::nullopt;
        const bool good = dash && gap && *dash >= 1.0 && *gap >= 0.1;
        if (good && *dash <= 1000.0 && *gap <= 1000.0) return {Kind::dashed, *dash, *gap};
    }
    throw UsageError(fmt::format(
        "'{}' is not one of none, solid, dashed, dashed:DASH,GAP with a dash from 1 and "
        "a gap from 0.1 to 1000 line widths",
        text));
}

std::string print(const HiddenLines& hidden) {
    const HiddenLines usual;
    switch (hidden.kind) {
        case HiddenLines::Kind::none: return "none";
        case HiddenLines::Kind::solid: return "solid";
        case HiddenLines::Kind::dashed: break;
    }
    if (hidden.dash == usual.dash && hidden.gap == usual.gap) return "dashed";
    return fmt::format("dashed:{},{}", hidden.dash, hidden.gap);
}

AntiAliasing read_aa(std::string_view text) {
    if (text == "none") return {AntiAliasing::Kind::none, 1};
    if (text == "edges") return {AntiAliasing::Kind::edges, 1};
    if (text == "stencil") return {AntiAliasing::Kind::stencil, 1};
    if (text.starts_with("multisample:")) {
        return {AntiAliasing::Kind::multisample, read_int(text.substr(12), 1, 4096)};
    }
    throw UsageError(fmt::format("'{}' is not one of none, edges, stencil, multisample:S", text));
}

std::string print(const AntiAliasing& aa) {
    switch (aa.kind) {
        case AntiAliasing::Kind::none: return "none";
        case AntiAliasing::Kind::edges: return "edges";
        case AntiAliasing::Kind::stencil: return "stencil";
        case AntiAliasing::Kind::multisample: return fmt::format("multisample:{}", aa.samples);
    }
    return {};
}

std::string print(LineTypes types) {
    if (types == LineTypes::all()) return "all";
    std::vector<LineType> list;
    for (const auto& [word, type] : kLineTypeWords.entries) {
        if (types.has(type)) list.push_back(type);
    }
    return kLineTypeWords.print_list(list);
}

void read_background(Settings& settings, std::string_view text) {
    const bool transparent = text == "transparent";
    if (!transparent && !parse_color(text)) {
        throw UsageError(fmt::format(
            "'{}' is not a colour; write transparent, a name such as white, #rrggbb, or r,g,b from "
            "0 to 255",
            text));
    }
    if (!transparent) settings.shading.background = read_color(text);
    settings.shading.transparent_background = transparent;
}

/// "part:residue" says which of a molecule's levels is a part.
void read_ids(Settings& settings, std::string_view text) {
    const std::size_t colon = text.find(':');
    const std::string_view level = text.substr(0, colon);
    const bool named = colon != std::string_view::npos;
    if (named && (level != "part" || colon + 1 == text.size())) {
        throw UsageError(fmt::format("'{}' names no level; write for example part:chain", text));
    }
    settings.ids = read_optional(level, [](std::string_view word) { return kIdLevels.read(word); });
    settings.data.parts = named ? text.substr(colon + 1) : std::string_view();
}

std::string print_ids(const Settings& settings) {
    if (!settings.ids) return {};
    const std::string level = kIdLevels.print(*settings.ids);
    return settings.data.parts.empty() ? level : level + ":" + settings.data.parts;
}

int read_tile(std::string_view text) {
    const int side = read_int(text, kBlockSide, 4096);
    if (side % kBlockSide != 0) {
        throw UsageError(fmt::format("'{}' is not a multiple of {}", text, kBlockSide));
    }
    return side;
}

std::vector<Setting> make_table() {
    using S = Settings;
    using Text = std::string_view;
    return {
        {"size", "Picture", "WxH", "Width and height in pixels",
         [](S& s, Text t) { s.size = read_size(t); },
         [](const S& s) { return fmt::format("{}x{}", s.size.width, s.size.height); }},
        {"dpi", "Picture", "D",
         "Pixels per inch: what pt and mm mean, and how large the picture prints",
         [](S& s, Text t) { s.dpi = read_number(t, 1, 100000); },
         [](const S& s) { return fmt::format("{}", s.dpi); }, false, number(36, 1200)},
        {"background", "Picture", "COLOR", "Colour behind the scene, or transparent",
         read_background,
         [](const S& s) {
             return s.shading.transparent_background ? "transparent"
                                                     : to_string(s.shading.background);
         },
         false, color()},
        {"compose", "Picture", "WHAT",
         "What to draw: shaded (no lines), lines (alone, on white) or both",
         [](S& s, Text t) { s.compose = kComposes.read(t); },
         [](const S& s) { return kComposes.print(s.compose); }, false, one_of(kComposes)},
        {"legend", "Picture", "PLACE",
         "What colours mean: auto (where a field gives them, in the lower right corner), none, "
         "top-left, top-right, bottom-left or bottom-right",
         [](S& s, Text t) { s.legend = kLegendPlaces.read(t); },
         [](const S& s) { return kLegendPlaces.print(s.legend); }, false, one_of(kLegendPlaces)},
        {"aov", "Picture", "LIST",
         "More to write: id, depth, normal, position, lines; channels of an EXR, else pictures "
         "beside it",
         [](S& s, Text t) { s.aovs = kAovs.read_list(t); },
         [](const S& s) { return kAovs.print_list(s.aovs); }, false, some_of(kAovs)},

        {"view", "View", "SIDE",
         "auto (broad side of molecules, three quarters of meshes), front, back, left, right, top, "
         "bottom or iso",
         [](S& s, Text t) { s.view.view = kViews.read(t); },
         [](const S& s) { return kViews.print(s.view.view); }, false, one_of(kViews)},
        {"eye", "View", "X,Y,Z", "Where the viewer stands, in the units of the file",
         [](S& s, Text t) { s.view.eye = read_optional(t, read_vector); },
         [](const S& s) { return s.view.eye ? print(*s.view.eye) : std::string(); }},
        {"look-at", "View", "X,Y,Z", "What is in the middle of the picture",
         [](S& s, Text t) { s.view.look_at = read_optional(t, read_vector); },
         [](const S& s) { return s.view.look_at ? print(*s.view.look_at) : std::string(); }},
        {"up", "View", "X,Y,Z", "Direction that points up in the picture",
         [](S& s, Text t) { s.view.up = read_optional(t, read_vector); },
         [](const S& s) { return s.view.up ? print(*s.view.up) : std::string(); }},
        {"fov", "View", "DEG", "Vertical field of view",
         [](S& s, Text t) { s.view.fov_deg = read_number(t, 0.001, 170); },
         [](const S& s) { return fmt::format("{}", s.view.fov_deg); }, false, number(1, 120)},
        {"orthographic", "View", "HEIGHT",
         "Parallel projection; the height of the view in the units of the file, or auto to fit",
         [](S& s, Text t) { s.view.orthographic = read_optional(t, read_view_height); },
         [](const S& s) {
             if (!s.view.orthographic) return std::string();
             return *s.view.orthographic == 0.0 ? "auto" : fmt::format("{}", *s.view.orthographic);
         }},
        {"margin", "View", "F", "Share of the picture left free on each side by automatic framing",
         [](S& s, Text t) { s.view.margin = read_number(t, 0, 0.45); },
         [](const S& s) { return fmt::format("{}", s.view.margin); }, false, number(0, 0.45)},

        {"method", "Lines", "NAME",
         "How lines are found: edges (located, of exact width) or stencil (the paper's ray "
         "stencils)",
         [](S& s, Text t) { s.method = kMethods.read(t); },
         [](const S& s) { return kMethods.print(s.method); }, false, one_of(kMethods)},
        {"lines", "Lines", "LIST",
         "silhouette, intersection, self-occlusion, crease, boundary, mesh, ridge (apparent "
         "ridges), "
         "all or none; method stencil draws the first two, both for either",
         [](S& s, Text t) {
             LineTypes types;
             for (const LineType type : kLineTypeWords.read_list(t)) types.add(type);
             s.lines = types;
         },
         [](const S& s) { return print(s.lines); }, false, some_of(kLineTypeWords)},
        {"lattice", "Lines", "Q",
         "Method edges: rays along a pixel's side; 2 to 4 find thinner things and shade smoother",
         [](S& s, Text t) { s.lattice = read_int(t, 1, kMostLatticePoints); },
         [](const S& s) { return fmt::format("{}", s.lattice); }, false,
         whole(1, kMostLatticePoints)},
        {"line-width", "Lines", "LEN", "Width in px, pt, mm or % of the picture's height",
         [](S& s, Text t) { s.line_width = read_length(t); },
         [](const S& s) { return print(s.line_width); }, false, length_px(0.25, 20)},
        {"line-density", "Lines", "F",
         "Method edges: share of an area, or of a small ball or stick, that lines may cover; "
         "where they would cover more they get thinner, 1 lets them be",
         [](S& s, Text t) { s.line_density = read_number(t, 0.05, 1); },
         [](const S& s) { return fmt::format("{}", s.line_density); }, false, number(0.05, 1)},
        {"line-color", "Lines", "COLOR", "Colour of the lines",
         [](S& s, Text t) { s.line_color = read_color(t); },
         [](const S& s) { return to_string(s.line_color); }, false, color()},
        {"line", "Lines", "RULE",
         "Method edges: TYPE:width=LEN,color=COLOR,opacity=F for lines of one type, all or hidden; "
         "TYPE@K:... for those of the K-th object alone, TYPE/N:... for those seen by way of N "
         "mirrors or transparent surfaces, TYPE/+:... for all of these; may be repeated",
         [](S& s, Text t) {
             if (t.empty()) return s.line_rules.clear();
             for (LineRule& rule : read_line_rules(t)) s.line_rules.push_back(rule);
         },
         [](const S& s) { return print(s.line_rules); }, true},
        {"hidden", "Lines", "HOW",
         "Method edges: lines on surfaces behind others: none, solid, dashed, or dashed:DASH,GAP "
         "in "
         "line widths; half as wide as others unless --line hidden:... says so",
         [](S& s, Text t) { s.hidden = read_hidden(t); },
         [](const S& s) { return print(s.hidden); }, false, any_text({"none", "solid", "dashed"})},
        {"hidden-layers", "Lines", "N",
         "Hidden lines: how many surfaces behind the first one are looked at",
         [](S& s, Text t) { s.hidden_layers = read_int(t, 1, 64); },
         [](const S& s) { return fmt::format("{}", s.hidden_layers); }, false, whole(1, 64)},
        {"ids", "Lines", "LEVEL",
         "Between what lines run: primitive (atoms, particles, triangles), part (chains, groups), "
         "part:chain, part:residue, part:entity, part:element, part:FIELD or object; by default "
         "atoms, particles and whole meshes",
         read_ids, print_ids, false,
         any_text({"primitive", "part", "part:chain", "part:residue", "part:entity", "part:element",
                   "object"})},
        {"metric", "Lines", "NAME",
         "Profile across a line: solid (method edges' own), linear (method stencil's own, the "
         "paper's equation 2) or power:P (equation 3 has P = 10)",
         [](S& s, Text t) { s.metric = t.empty() ? std::nullopt : std::optional(read_metric(t)); },
         [](const S& s) { return s.metric ? print(*s.metric) : std::string(); }, false,
         any_text({"solid", "linear", "power:10"})},
        {"quality", "Lines", "N", "Method stencil: rings of a stencil, 4 N (N + 1) rays a sample",
         [](S& s, Text t) { s.rings = read_int(t, 1, 64); },
         [](const S& s) { return fmt::format("{}", s.rings); }, false, whole(1, 8)},
        {"normals", "Lines", "WHICH",
         "Normals that creases are found by: auto (smooth but for a mesh's own creases), shading "
         "(as shaded: a file's smooth normals hide creases) or geometric (every edge of a facet)",
         [](S& s, Text t) { s.shading.normals = kNormalSources.read(t); },
         [](const S& s) { return kNormalSources.print(s.shading.normals); }, false,
         one_of(kNormalSources)},
        {"ridge-scale", "Lines", "LEN",
         "Apparent ridges: radius on the picture of what the turning of normals is taken from; "
         "larger is smoother",
         [](S& s, Text t) { s.ridge_scale = read_length(t); },
         [](const S& s) { return print(s.ridge_scale); }, false, length_px(1, 40)},
        {"ridge-turn", "Lines", "DEG",
         "Apparent ridges: where the normal turns by this in 1 % of the picture's height, they "
         "begin; they are full where it turns by twice as much",
         [](S& s, Text t) { s.ridge_turn_deg = read_number(t, 1e-3, 1e3); },
         [](const S& s) { return fmt::format("{}", s.ridge_turn_deg); }, false, number(0.5, 20)},
        {"crease-gradient", "Lines", "G",
         "Method stencil: a crease is where the normal changes by more than this a pixel",
         [](S& s, Text t) {
             s.thresholds.crease_gradient = static_cast<float>(read_number(t, 1e-6, 10));
         },
         [](const S& s) { return fmt::format("{}", s.thresholds.crease_gradient); }, false,
         number(0.01, 1)},
        {"depth-jump", "Lines", "SHARE",
         "Method stencil: a self-occlusion is where depth changes by more than this share of it",
         [](S& s, Text t) {
             s.thresholds.depth_share = static_cast<float>(read_number(t, 1e-6, 1e6));
         },
         [](const S& s) { return fmt::format("{}", s.thresholds.depth_share); }, false,
         number(0.001, 1)},
        {"line-blend", "Lines", "SPACE",
         "Values in which lines are mixed with the picture: display (sRGB), linear, or auto: "
         "linear "
         "in an EXR, else display",
         [](S& s, Text t) { s.line_blend = kBlends.read(t); },
         [](const S& s) { return kBlends.print(s.line_blend); }, false, one_of(kBlends)},

        {"shade", "Shading", "MODE",
         "lambert (diffuse), toon (in steps), gooch (cool to warm), flat (colours only) or none",
         [](S& s, Text t) { s.shading.mode = kShadeModes.read(t); },
         [](const S& s) { return kShadeModes.print(s.shading.mode); }, false, one_of(kShadeModes)},
        {"material", "Shading", "[OBJECT:]RULE",
         "color=COLOR,specular=F,roughness=F,metal=F for every object, or for the one of that "
         "number "
         "or name; may be repeated",
         [](S& s, Text t) {
             auto& all = s.shading.materials;
             if (t.empty()) return all.clear();
             for (MaterialRule& rule : read_material_rules(t)) all.push_back(std::move(rule));
         },
         [](const S& s) { return print(s.shading.materials); }, true},
        {"specular-depth", "Shading", "N",
         "Method edges: how often a ray goes on from mirrors, glass and transparent surfaces, and "
         "with it the lines that are seen there; 0 to 16",
         [](S& s, Text t) { s.specular_depth = read_int(t, 0, kMostSpecularDepth); },
         [](const S& s) { return fmt::format("{}", s.specular_depth); }, false,
         whole(0, kMostSpecularDepth)},
        {"aa", "Shading", "MODE",
         "Smoothing of what is not a line: none, edges (method edges: mix the two sides' colours "
         "in "
         "pixels that an edge cuts), stencil (method stencil: shade the stencil's rays too) or "
         "multisample:S (method edges: a lattice of at least S rays, 16 at most)",
         [](S& s, Text t) { s.aa = t.empty() ? std::nullopt : std::optional(read_aa(t)); },
         [](const S& s) { return s.aa ? print(*s.aa) : std::string(); }, false,
         any_text({"none", "edges", "stencil", "multisample:9"})},

        {"fill", "Curves", "WHAT",
         "What SVG and PDF show below the lines: flat (each geometry filled with one colour), "
         "two-tone (one for its light, one for its shade), image (the shaded picture, embedded), "
         "none, or auto: flat, but image where one geometry has several colours, as sticks have",
         [](S& s, Text t) { s.fill = kFills.read(t); },
         [](const S& s) { return kFills.print(s.fill); }, false, one_of(kFills)},
        {"curve-tolerance", "Curves", "PX",
         "Pixels by which a curve may miss the line, renderers' own error included",
         [](S& s, Text t) { s.curve_tolerance_px = read_number(t, 0.01, 10); },
         [](const S& s) { return fmt::format("{}", s.curve_tolerance_px); }, false,
         number(0.01, 2)},
        {"min-length", "Curves", "LEN",
         "Leave out lines that are shorter, from junction to junction",
         [](S& s, Text t) { s.min_length = read_length(t, true); },
         [](const S& s) { return print(s.min_length); }, false, length_px(0, 50)},

        {"threads", "Run", "T", "Threads to use; 0 for all. The picture does not depend on it",
         [](S& s, Text t) { s.threads = read_int(t, 0, 1024); },
         [](const S& s) { return fmt::format("{}", s.threads); }, false, whole(0, 64)},
        {"tile", "Run", "PX",
         "Side of the tiles that threads work on. The picture does not depend on it",
         [](S& s, Text t) { s.tile = read_tile(t); },
         [](const S& s) { return fmt::format("{}", s.tile); }, false, whole(16, 256)},
    };
}

}  // namespace

std::span<const Setting> settings_table() {
    static const std::vector<Setting> kTable = [] {
        std::vector<Setting> table = look_rows();
        std::ranges::move(data_settings_rows(), std::back_inserter(table));
        std::ranges::move(make_table(), std::back_inserter(table));
        // Beside the rows of the same topic.
        for (Setting& row : light_rows()) {
            const auto last =
                std::ranges::find(table.rbegin(), table.rend(), row.topic, &Setting::topic);
            table.insert(last.base(), std::move(row));
        }
        for (Setting& row : table) {
            row.set = [name = row.name, set = row.set](Settings& settings, std::string_view text) {
                try {
                    set(settings, text);
                } catch (const UsageError& error) {
                    throw UsageError(fmt::format("--{}: {}", name, error.what()));
                }
            };
        }
        return table;
    }();
    return kTable;
}

const Setting& find_setting(std::string_view name) {
    std::vector<std::string_view> names;
    for (const Setting& setting : settings_table()) {
        if (setting.name == name) return setting;
        names.push_back(setting.name);
    }
    const std::string_view guess = closest(name, names);
    throw UsageError(guess.empty()
                         ? fmt::format("there is no setting '{}'; see --help", name)
                         : fmt::format("there is no setting '{}'; did you mean {}?", name, guess));
}

namespace {

/// Planes of 4-byte numbers that an AOV keeps.
int plane_count(Aov aov) {
    switch (aov) {
        case Aov::id:
        case Aov::normal:
        case Aov::position: return 3;
        case Aov::depth: return 1;
        case Aov::lines: return 5;
    }
    return 0;
}

double physical_memory_bytes() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

/// Memory is granted before it is there: a picture that is too large would not fail to start, but
/// get the program killed on the way.
void check_memory(const Settings& settings, int color_bytes) {
    int bytes = color_bytes;
    for (const Aov aov : settings.aovs) bytes += 4 * plane_count(aov);
    const double needed = static_cast<double>(settings.size.pixels()) * bytes;
    const double memory = physical_memory_bytes();
    constexpr double kMostOfMemory = 0.8;  // the rest is for the scene, the encoder and the system
    if (needed <= kMostOfMemory * memory) return;
    throw UsageError(fmt::format(
        "--size: {}x{} needs {:.1f} GB for its pixels, but this machine has {:.1f} GB of memory, "
        "of "
        "which a picture may take {:.0f} %; make it smaller{}",
        settings.size.width, settings.size.height, needed * 1e-9, memory * 1e-9,
        kMostOfMemory * 100.0, settings.aovs.empty() ? "" : " or ask for less with --aov"));
}

}  // namespace

namespace {

void follow(const LineRule& rule, const Settings& settings, StrokeStyle& style) {
    if (rule.width) style.width_px = rule.width->pixels(settings.dpi, settings.size.height);
    style.color = rule.color.value_or(style.color);
    style.opacity = rule.opacity.value_or(style.opacity);
}

}  // namespace

StrokeStyle Settings::line_style(LineType type, int object, int level, bool inner) const {
    StrokeStyle style{line_width_px(), line_color, 1.0};
    for (const auto* rules : {&look_rules, &line_rules}) {
        for (const LineRule& rule : *rules) {
            if (rule.applies(type, object, level, inner)) follow(rule, *this, style);
        }
    }
    return style;
}

StrokeStyle Settings::hidden_style(int object) const {
    StrokeStyle style{0.5 * line_width_px(), line_color, 1.0};
    for (const auto* rules : {&look_rules, &line_rules}) {
        for (const LineRule& rule : *rules) {
            if (rule.applies_to_hidden(object)) follow(rule, *this, style);
        }
    }
    return style;
}

std::optional<Dashes> Settings::hidden_dashes(double width_px, double length_px,
                                              bool closed) const {
    if (hidden.kind != HiddenLines::Kind::dashed) return std::nullopt;
    // Round ends take half a width on either side.
    const Dashes usual{(hidden.dash - 1.0) * width_px, (hidden.gap + 1.0) * width_px};
    return fit_dashes(usual, length_px, closed);
}

Metric Settings::profile() const {
    const Metric own{method == Method::edges ? Metric::Kind::solid : Metric::Kind::linear};
    return metric.value_or(own);
}

AntiAliasing Settings::smoothing() const {
    using Kind = AntiAliasing::Kind;
    if (method == Method::edges) {
        const AntiAliasing own{lines.empty() ? Kind::none : Kind::edges, 1};
        return aa && aa->kind == Kind::none ? *aa : aa ? AntiAliasing{Kind::edges, 1} : own;
    }
    const AntiAliasing asked = aa.value_or(AntiAliasing{});
    return asked.kind == Kind::edges ? AntiAliasing{} : asked;
}

int Settings::lattice_points() const {
    if (!aa || aa->kind != AntiAliasing::Kind::multisample) return lattice;
    const auto side = static_cast<int>(std::ceil(std::sqrt(aa->samples)));
    return std::clamp(side, lattice, kMostLatticePoints);
}

namespace {

/// Atoms and particles as spheres, among meshes if any: what light from all around costs little
/// for. Sticks take several times the rest of the frame, and glyphs, by tracing rays, a hundred.
bool draws_balls_alone(const Scene& scene) {
    bool balls = false;
    for (const Object& object : scene.objects()) {
        const bool is_mesh = std::holds_alternative<Mesh>(object.shape);
        if (!is_mesh && !std::holds_alternative<Spheres>(object.shape)) return false;
        balls |= object.kind == ObjectKind::molecule || object.kind == ObjectKind::particles;
    }
    return balls;
}

}  // namespace

ShadingSettings shading_of(const Settings& settings, const Scene& scene) {
    ShadingSettings shading = settings.shading;
    const bool soft = settings.method == Method::edges && shading.mode == ShadeMode::lambert &&
                      draws_balls_alone(scene);
    if (!shading.ambient) shading.ambient = soft ? 1.0F : 0.0F;
    return shading;
}

void validate(const Settings& settings, int color_bytes) {
    check_memory(settings, color_bytes);
    if (settings.draws_hidden() && settings.method != Method::edges) {
        throw UsageError("--hidden: hidden lines are found by method edges only");
    }
    const auto check_width = [&](std::string_view name, const Length& length) {
        const double width = length.pixels(settings.dpi, settings.size.height);
        constexpr double kWidest = 1000.0;
        if (width <= kWidest) return;
        throw UsageError(
            fmt::format("--{}: comes to {:.0f} pixels; the most is {}", name, width, kWidest));
    };
    check_width("line-width", settings.line_width);
    check_width("halo", settings.halo);
    for (const LineRule& rule : settings.line_rules) {
        if (rule.width) check_width("line", *rule.width);
    }
}

}  // namespace ink

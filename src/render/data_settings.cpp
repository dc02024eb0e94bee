#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "render/settings.h"
#include "scene/representation.h"
#include "scene/selection.h"

namespace ink {

namespace {

template <class T>
struct Word {
    std::string_view word;
    T value;
};

constexpr std::array<Word<Representation>, 3> kRepresentations{
    {{"spheres", Representation::spheres},
     {"ball-and-stick", Representation::ball_and_stick},
     {"sticks", Representation::sticks}}};
constexpr std::array<Word<RadiiTable>, 3> kRadii{
    {{"vdw", RadiiTable::vdw}, {"bondi", RadiiTable::bondi}, {"covalent", RadiiTable::covalent}}};

constexpr std::array<Word<Glyph>, 3> kGlyphs{
    {{"sphere", Glyph::sphere}, {"box", Glyph::box}, {"ellipsoid", Glyph::ellipsoid}}};

template <class T, std::size_t N>
T read_word(const std::array<Word<T>, N>& words, std::string_view text) {
    std::vector<std::string_view> known;
    for (const Word<T>& entry : words) {
        if (entry.word == text) return entry.value;
        known.push_back(entry.word);
    }
    throw UsageError(fmt::format("'{}' is not one of {}", text, fmt::join(known, ", ")));
}

template <class T, std::size_t N>
std::string print_word(const std::array<Word<T>, N>& words, T value) {
    for (const Word<T>& entry : words) {
        if (entry.value == value) return std::string(entry.word);
    }
    return {};
}

template <class T, std::size_t N>
ValueForm one_of(const std::array<Word<T>, N>& words) {
    ValueForm form{ValueForm::Kind::word};
    for (const Word<T>& entry : words) form.words.push_back(entry.word);
    return form;
}

ValueForm color_map_names() {
    ValueForm form{ValueForm::Kind::word};
    for (const ColorMap& map : color_maps()) form.words.push_back(map.name);
    return form;
}

/// "7", "0:20" or "5:".
void read_frame(Settings& settings, std::string_view text) {
    const auto ends = split(text, ':');
    const auto number = [&](std::string_view word) {
        const auto frame = parse_int(word);
        if (frame && *frame >= 0 && *frame < Settings::kLastOfFile) return static_cast<int>(*frame);
        throw UsageError(fmt::format(
            "'{}' is not a frame; write a whole number from 0 on, or FIRST:LAST", text));
    };
    const int first = number(ends[0]);
    const bool open = ends.size() == 2 && ends[1].empty();
    const int last = open ? Settings::kLastOfFile : number(ends.back());
    if (ends.size() > 2 || last < first) {
        throw UsageError(fmt::format("'{}' is not a range of frames; write FIRST:LAST", text));
    }
    settings.frame = first;
    settings.last_frame = last;
}

std::string print_frame(const Settings& settings) {
    if (settings.last_frame == settings.frame) return fmt::format("{}", settings.frame);
    if (settings.last_frame == Settings::kLastOfFile) return fmt::format("{}:", settings.frame);
    return fmt::format("{}:{}", settings.frame, settings.last_frame);
}

std::string read_select(std::string_view text) {
    if (!text.empty()) Selection::parse(text);
    return std::string(text);
}

/// "0:2" with either end left out.
std::optional<std::pair<double, double>> parse_interval(std::string_view text) {
    const auto ends = split(text, ':');
    if (ends.size() != 2) return std::nullopt;
    const auto low = ends[0].empty() ? -ClipBox::kFar : parse_double(ends[0]).value_or(NAN);
    const auto high = ends[1].empty() ? ClipBox::kFar : parse_double(ends[1]).value_or(NAN);
    return low <= high ? std::optional(std::pair{low, high}) : std::nullopt;
}

UsageError not_a_box(std::string_view text) {
    return UsageError(
        fmt::format("'{}' is not a box; write axes and intervals, as in x=0:2,z=:5", text));
}

std::string print_interval(double low, double high) {
    return fmt::format("{}:{}", std::isinf(low) ? "" : fmt::format("{}", low),
                       std::isinf(high) ? "" : fmt::format("{}", high));
}

/// "x=0:2,z=:5".
ClipBox read_clip(std::string_view text) {
    ClipBox box;
    if (trim(text).empty()) return box;
    for (const std::string_view side : split(text, ',')) {
        if (side.size() < 2 || side[1] != '=' || side[0] < 'x' || side[0] > 'z') {
            throw not_a_box(text);
        }
        const auto interval = parse_interval(side.substr(2));
        if (!interval) throw not_a_box(text);
        const auto [low, high] = *interval;
        double Vec3d::*const axis = std::array{&Vec3d::x, &Vec3d::y, &Vec3d::z}[side[0] - 'x'];
        box.lower.*axis = low;
        box.upper.*axis = high;
    }
    return box;
}

std::string print_clip(const ClipBox& box) {
    std::string text;
    for (const auto& [name, axis] :
         {std::pair{'x', &Vec3d::x}, {'y', &Vec3d::y}, {'z', &Vec3d::z}}) {
        if (std::isinf(box.lower.*axis) && std::isinf(box.upper.*axis)) continue;
        if (!text.empty()) text += ',';
        text += fmt::format("{}={}", name, print_interval(box.lower.*axis, box.upper.*axis));
    }
    return text;
}

std::optional<double> read_stick_radius(std::string_view text) {
    if (text.empty()) return std::nullopt;
    const auto radius = parse_double(text);
    constexpr double kLargest = 1e15;
    if (radius && *radius > 0.0 && *radius <= kLargest) return radius;
    throw UsageError(fmt::format("'{}' is not a positive number", text));
}

const ColorMap* read_color_map(std::string_view text) {
    if (const ColorMap* const map = find_color_map(text)) return map;
    std::vector<std::string_view> known;
    for (const ColorMap& map : color_maps()) known.push_back(map.name);
    throw UsageError(fmt::format("'{}' is not one of {}", text, fmt::join(known, ", ")));
}

std::optional<std::pair<double, double>> read_range(std::string_view text) {
    if (text.empty()) return std::nullopt;
    const auto range = parse_interval(text);
    if (range && std::isfinite(range->first) && std::isfinite(range->second)) return range;
    throw UsageError(fmt::format("'{}' is not a range; write LOW:HIGH, as in 0:2.5", text));
}

}  // namespace

std::vector<Setting> data_settings_rows() {
    using S = Settings;
    using Text = std::string_view;
    return {
        {"frame", "Input", "K|A:B",
         "Frame to draw of a file that has several, from 0; A:B or A: for an animation",
         [](S& s, Text t) { read_frame(s, t); }, [](const S& s) { return print_frame(s); }},
        {"select", "Input", "ATOMS",
         "Atoms to draw, as 'chain A and not water' or 'resn HEM or resi 10-20'; words: protein, "
         "nucleic, water, ligand, ions, hydrogens, backbone, sidechain, chain, resn, resi, name, "
         "elem, a field as in 'bfactor < 40', and, or, not, brackets",
         [](S& s, Text t) { s.data.select = read_select(t); },
         [](const S& s) { return s.data.select; }},
        {"assembly", "Input", "NAME", "Biological assembly to build, by its name in the file, as 1",
         [](S& s, Text t) { s.data.assembly = t; }, [](const S& s) { return s.data.assembly; }},
        {"clip", "Input", "BOX",
         "Draw only what has its centre in a box in the units of the file, as x=0:2,z=:5",
         [](S& s, Text t) { s.data.clip = read_clip(t); },
         [](const S& s) { return print_clip(s.data.clip); }},
        {"represent", "Input", "HOW",
         "How molecules are drawn: spheres, ball-and-stick or sticks; bonds are the file's, else "
         "found "
         "by distance",
         [](S& s, Text t) { s.data.representation = read_word(kRepresentations, t); },
         [](const S& s) { return print_word(kRepresentations, s.data.representation); }, false,
         one_of(kRepresentations)},
        {"radii", "Input", "TABLE",
         "Radii of atoms: vdw (van der Waals, Mantina 2009), bondi (van der Waals, Bondi 1964, as "
         "PyMOL) or covalent (Cordero 2008)",
         [](S& s, Text t) { s.data.radii = read_word(kRadii, t); },
         [](const S& s) { return print_word(kRadii, s.data.radii); }, false, one_of(kRadii)},
        {"radius", "Input", "R|FIELD",
         "Radius of atoms and particles: a number in the units of the file, or a field",
         [](S& s, Text t) {
             uniform_radius(std::string(t));
             s.data.radius = t;
         },
         [](const S& s) { return s.data.radius; }},
        {"stick-radius", "Input", "R", "Radius of bonds; by default 0.14 with balls, 0.2 alone",
         [](S& s, Text t) { s.data.stick_radius = read_stick_radius(t); },
         [](const S& s) {
             return s.data.stick_radius ? fmt::format("{}", *s.data.stick_radius) : std::string();
         }},
        {"glyph", "Input", "SHAPE",
         "What particles are drawn as: sphere, box or ellipsoid, the latter under their "
         "deformation "
         "gradients (F11 to F33), or turned by quaternions",
         [](S& s, Text t) { s.data.glyph = read_word(kGlyphs, t); },
         [](const S& s) { return print_word(kGlyphs, s.data.glyph); }, false, one_of(kGlyphs)},
        {"glyph-field", "Input", "FIELD",
         "Tensor or quaternion of boxes and ellipsoids, where its name does not tell",
         [](S& s, Text t) { s.data.glyph_field = t; },
         [](const S& s) { return s.data.glyph_field; }},
        {"color-by", "Input", "WHAT",
         "element, chain, chain-hetero (carbons by chain, others by element), residue, entity, "
         "rainbow (along each chain), none, a colour, or a field such as bfactor or velocity.x; by "
         "default element, of more than 10000 atoms in several chains chain, of particles the "
         "file's colours, else the type where there are several",
         [](S& s, Text t) { s.data.color_by = t; }, [](const S& s) { return s.data.color_by; },
         false,
         any_text({"element", "chain", "chain-hetero", "residue", "entity", "rainbow", "none"})},
        {"colormap", "Input", "MAP",
         "Colours of a field: viridis, cividis, magma, inferno, plasma, coolwarm, gray; or "
         "categories, "
         "a colour for each whole number",
         [](S& s, Text t) { s.data.color_map = read_color_map(t); },
         [](const S& s) { return std::string(s.data.color_map->name); }, false, color_map_names()},
        {"color-range", "Input", "LOW:HIGH",
         "Values of a field at the ends of its colours; by default its least and greatest",
         [](S& s, Text t) { s.data.color_range = read_range(t); },
         [](const S& s) {
             return s.data.color_range
                        ? print_interval(s.data.color_range->first, s.data.color_range->second)
                        : std::string();
         }},
    };
}

}  // namespace ink

#include "io/particle_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/text.h"
#include "io/file_text.h"
#include "scene/kind_colors.h"
#include "scene/particle_glyphs.h"
#include "scene/particles.h"

namespace ink {

namespace {

/// What the columns of one field end in, in the order of its components.
constexpr std::array<std::string_view, 9> kEndings{"x y",
                                                   "x y z",
                                                   "w x y z",
                                                   "w i j k",
                                                   "11 12 21 22",
                                                   "xx yy zz xy yz xz",
                                                   "11 22 33 12 23 13",
                                                   "xx xy xz yx yy yz zx zy zz",
                                                   "11 12 13 21 22 23 31 32 33"};

class FieldFinder {
  public:
    FieldFinder(const std::vector<std::string>& columns) : columns_(columns) {
        layout_.of_column.resize(columns.size());
    }

    /// The field of that name, as a column or several.
    void request(const std::string& name) {
        if (is_known(name)) return;
        if (const auto column = find_column(name)) {
            keep(name, {*column});
            return;
        }
        if (request_vector(name)) return;
        // "v.x" of the columns vx, vy, vz.
        const std::size_t dot = name.rfind('.');
        if (dot != std::string::npos && dot > 0) request(name.substr(0, dot));
    }

    /// The same, but only of several columns.
    bool request_vector(const std::string& name) {
        if (is_known(name)) return true;
        const auto columns = vector_columns(name);
        if (columns.size() < 2) return false;
        keep(name, columns);
        return true;
    }

    /// Values of what is requested from now on may be missing.
    void end_needed() { layout_.needed = layout_.fields.size(); }
    FieldLayout take() { return std::move(layout_); }

  private:
    bool is_known(const std::string& name) const {
        return std::ranges::find(layout_.fields, name, &Field::name) != layout_.fields.end();
    }

    std::optional<std::size_t> find_column(const std::string& name) const {
        auto found = std::ranges::find(columns_, name);
        if (found == columns_.end()) {
            const std::string lower = to_lower(name);
            found = std::ranges::find_if(
                columns_, [&](const std::string& column) { return to_lower(column) == lower; });
        }
        if (found == columns_.end()) return std::nullopt;
        return static_cast<std::size_t>(found - columns_.begin());
    }

    /// The longest list of columns that the name may stand for: vx vy vz for "v", F11 to F33 for
    /// "F", c_s[1] c_s[2] for "c_s", v:0 v:1 v:2 for "v".
    std::vector<std::size_t> vector_columns(const std::string& name) const {
        std::vector<std::size_t> longest;
        const auto consider = [&](std::vector<std::size_t> found) {
            if (found.size() > longest.size()) longest = std::move(found);
        };
        for (const std::string_view separator : {"", "_", "."}) {
            for (const std::string_view endings : kEndings) {
                consider(with_endings(fmt::format("{}{}", name, separator), endings));
            }
        }
        consider(numbered(1, [&](int k) { return fmt::format("{}[{}]", name, k); }));
        consider(numbered(0, [&](int k) { return fmt::format("{}:{}", name, k); }));
        consider(numbered(0, [&](int k) { return fmt::format("{}_{}", name, k); }));
        return longest;
    }

    std::vector<std::size_t> with_endings(const std::string& begin,
                                          std::string_view endings) const {
        std::vector<std::size_t> found;
        for (std::string_view end = take_word(endings); !end.empty(); end = take_word(endings)) {
            const auto column = find_column(fmt::format("{}{}", begin, end));
            if (!column) return {};
            found.push_back(*column);
        }
        return found;
    }

    template <class Name>
    std::vector<std::size_t> numbered(int first, const Name& name) const {
        std::vector<std::size_t> found;
        for (int k = first;; ++k) {
            const auto column = find_column(name(k));
            if (!column) return found;
            found.push_back(*column);
        }
    }

    void keep(const std::string& name, const std::vector<std::size_t>& columns) {
        for (std::size_t component = 0; component < columns.size(); ++component) {
            layout_.of_column[columns[component]].push_back({layout_.fields.size(), component});
        }
        layout_.fields.push_back({name, columns.size(), {}});
    }

    const std::vector<std::string>& columns_;
    FieldLayout layout_;
};

bool is_size_name(std::string_view name) { return is_radius_name(name) || is_diameter_name(name); }

}  // namespace

FieldLayout lay_out_fields(const std::vector<std::string>& columns, const DataSettings& settings,
                           const std::vector<std::string>& others) {
    FieldFinder finder(columns);
    if (settings.radius.empty()) {
        for (const std::string& column : columns) {
            if (is_size_name(column)) finder.request(column);
        }
    }
    for (const std::string& name : requested_fields(settings)) finder.request(name);
    if (settings.glyph != Glyph::sphere) {
        for (const std::string_view name : glyph_field_names()) {
            finder.request_vector(std::string(name));
        }
    }
    finder.end_needed();
    if (settings.color_by.empty()) {
        for (const std::string& column : columns) {
            if (is_kind_name(column)) finder.request(column);
        }
    }
    for (const std::string& name : others) finder.request(name);
    return finder.take();
}

bool is_drawn_field(std::string_view name, const DataSettings& settings) {
    if (settings.radius.empty() && is_size_name(name)) return true;
    if (settings.color_by.empty() && is_kind_name(name)) return true;
    if (settings.glyph != Glyph::sphere &&
        std::ranges::find(glyph_field_names(), to_lower(name)) != glyph_field_names().end()) {
        return true;
    }
    return std::ranges::any_of(requested_fields(settings), [&](const std::string& asked) {
        return asked == name || asked.starts_with(std::string(name) + ".");
    });
}

}  // namespace ink

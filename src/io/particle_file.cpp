#include "io/particle_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/polygon_mesh.h"
#include "scene/kind_colors.h"

namespace ink {

namespace {

constexpr double kMax = std::numeric_limits<double>::max();

/// Names of coordinate columns, in lower case, best first.
struct AxisNames {
    std::array<std::string_view, 3> names;
    bool scaled = false;
};
constexpr AxisNames kAxes[] = {{{"x", "y", "z"}},
                               {{"xu", "yu", "zu"}},
                               {{"xs", "ys", "zs"}, true},
                               {{"xsu", "ysu", "zsu"}, true},
                               {{"points:0", "points:1", "points:2"}},
                               {{"points_0", "points_1", "points_2"}},
                               {{"pos_x", "pos_y", "pos_z"}},
                               {{"px", "py", "pz"}},
                               {{"coord_x", "coord_y", "coord_z"}}};

/// "X [mm]" and "x(m)" are x.
std::string plain_name(std::string_view name) {
    return to_lower(trim(name.substr(0, name.find_first_of("[("))));
}

/// The next word of a row, cut off its front; at blanks, runs of them count as one. False at the
/// end of the row.
bool take_field(std::string_view& row, char separator, std::string_view& word) {
    if (separator == ' ') {
        word = take_word(row);
        return !word.empty();
    }
    if (row.data() == nullptr) return false;
    const std::size_t end = row.find(separator);
    word = trim(row.substr(0, end));
    row = end == std::string_view::npos ? std::string_view() : row.substr(end + 1);
    return true;
}

std::string_view unquoted(std::string_view word) {
    const bool quoted = word.size() >= 2 && word.front() == '"' && word.back() == '"';
    return quoted ? word.substr(1, word.size() - 2) : word;
}

bool parse_float(std::string_view word, double& value) {
    word = unquoted(word);
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    if (result.ec == std::errc::result_out_of_range) {
        // Too small is 0 for all that can be seen; too large is no place or size.
        const bool small =
            word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
        value = small ? 0.0 : std::numeric_limits<double>::infinity();
        return true;
    }
    return result.ec == std::errc{} && result.ptr == word.data() + word.size();
}

}  // namespace

FileContents particle_contents(const std::filesystem::path& file, std::string_view format,
                               Particles particles, FileContents contents,
                               const ReadOptions& options) {
    if (particles.count() == 0) {
        throw InputError(file, "holds no particles; a file with coordinates is needed");
    }
    particles.name = model_name(file);
    contents.format = format;
    contents.counts.emplace(contents.counts.begin(), "particles", particles.count());
    contents.objects =
        represent(std::move(particles), options.data, contents.warnings, options.facts);
    const std::optional<ColorScale>& scale = contents.objects.front().color_scale;
    if (options.data.color_by.empty() && scale) {
        std::vector<std::string> kinds;
        for (const ColorScale::Entry& entry : scale->entries) kinds.push_back(entry.name);
        contents.names.emplace_back(scale->title + "s", std::move(kinds));
    }
    return contents;
}

ParticleColumns::ParticleColumns(const std::filesystem::path& file,
                                 const std::vector<std::string>& names, const ReadOptions& options)
    : summarize_(options.summarize) {
    for (const std::string& name : names)
        columns_.push_back({.name = name, .destinations = {}, .least = kMax, .most = -kMax});
    find_axes(file);
    std::vector<std::string> others;
    for (const Column& column : columns_) {
        if (options.facts && column.axis < 0) others.push_back(column.name);
    }
    FieldLayout layout = lay_out_fields(names, options.data, others);
    particles_.fields = std::move(layout.fields);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        Column& column = columns_[c];
        column.destinations = std::move(layout.of_column[c]);
        column.needed = summarize_ || column.axis >= 0 || !column.destinations.empty();
        column.is_number = column.axis >= 0 ||
                           std::ranges::any_of(column.destinations, [&](FieldLayout::Place place) {
                               return place.field < layout.needed;
                           });
        column.may_be_words =
            std::ranges::any_of(column.destinations, [&](FieldLayout::Place place) {
                const Field& field = particles_.fields[place.field];
                const DataSettings& data = options.data;
                return field.components == 1 && field.name != data.radius &&
                       (field.name == data.color_by || field.name == data.parts ||
                        is_kind_name(field.name));
            });
        if (column.needed) last_needed_ = c;
    }
}

void ParticleColumns::find_axes(const std::filesystem::path& file) {
    for (int axis = 0; axis < 3; ++axis) {
        bool found = false;
        for (const AxisNames& choice : kAxes) {
            const std::string_view wanted = choice.names[static_cast<std::size_t>(axis)];
            const auto column = std::ranges::find_if(
                columns_, [&](const Column& c) { return plain_name(c.name) == wanted; });
            if (column == columns_.end()) continue;
            column->axis = axis;
            scaled_[static_cast<std::size_t>(axis)] = choice.scaled;
            found = true;
            break;
        }
        if (found) continue;
        std::string all;
        for (const Column& column : columns_) all += (all.empty() ? "" : ", ") + column.name;
        throw InputError(file, fmt::format("has no column '{}' among {}; name the coordinates x, y "
                                           "and z",
                                           "xyz"[axis], excerpt(all)));
    }
}

void ParticleColumns::reserve(std::size_t rows) {
    particles_.positions.reserve(rows);
    for (Field& field : particles_.fields) field.values.reserve(rows * field.components);
}

bool ParticleColumns::add_row(std::string_view row, char separator, std::string& problem) {
    std::array<double, 3> position{};
    for (Field& field : particles_.fields)
        field.values.resize(field.values.size() + field.components);
    for (std::size_t c = 0; c <= last_needed_; ++c) {
        Column& column = columns_[c];
        std::string_view word;
        if (!take_field(row, separator, word)) {
            problem = fmt::format("the row has {} of {} columns", c, columns_.size());
            return false;
        }
        if (!column.needed) continue;
        double value = 0.0;
        const bool is_word = column.may_be_words && take_word_of(column, word, value);
        if (is_word && column.is_number && parse_double(unquoted(word))) {
            problem =
                fmt::format("column '{}' is {}, a number among words", column.name, excerpt(word));
            return false;
        }
        if (!is_word && !parse_float(word, value)) {
            if (column.is_number) {
                problem =
                    fmt::format("column '{}' is {}, not a number", column.name, excerpt(word));
                if (particles_.positions.empty() && column.axis < 0) {
                    remedy_ = "choose a column that 'inktrace info' gives a range of numbers for";
                }
                return false;
            }
            if (summarize_) tell_word(column, unquoted(word));
            value = std::numeric_limits<double>::quiet_NaN();
        }
        if (column.axis >= 0) position[static_cast<std::size_t>(column.axis)] = value;
        for (const FieldLayout::Place place : column.destinations) {
            Field& field = particles_.fields[place.field];
            field.values[field.values.size() - field.components + place.component] =
                static_cast<float>(value);
        }
        if (summarize_ && !is_word && std::isfinite(value)) {
            column.least = std::min(column.least, value);
            column.most = std::max(column.most, value);
        }
    }
    const Vec3d p{position[0], position[1], position[2]};
    if (particles_.positions.empty() && std::isfinite(p.x + p.y + p.z)) particles_.origin = p;
    particles_.positions.push_back(to_float(p - particles_.origin));
    return true;
}

/// Whether the word counts as one, and its number if so. Words begin in the first row.
bool ParticleColumns::take_word_of(Column& column, std::string_view word, double& value) const {
    const std::string_view text = unquoted(word);
    if (text.empty()) return false;
    if (column.words.empty() && (!particles_.positions.empty() || parse_float(word, value))) {
        return false;
    }
    const auto found = column.words.find(text);
    value = found != column.words.end()
                ? found->second
                : column.words.emplace(std::string(text), static_cast<float>(column.words.size()))
                      .first->second;
    return true;
}

/// Notes a word of a column that nothing draws.
void ParticleColumns::tell_word(Column& column, std::string_view word) {
    if (word.empty() || column.told.size() > kMostTold || column.told.contains(word)) return;
    column.told.emplace(word);
}

/// Words in their order, so that it does not matter which comes first.
Particles& ParticleColumns::particles() {
    for (Column& column : columns_) {
        if (column.words.empty()) continue;
        std::vector<float> sorted(column.words.size());
        std::vector<std::string> names;
        for (const auto& [word, number] : column.words) {
            sorted[static_cast<std::size_t>(number)] = static_cast<float>(names.size());
            names.push_back(word);
        }
        column.told.insert(names.begin(), names.end());
        for (const FieldLayout::Place place : column.destinations) {
            Field& field = particles_.fields[place.field];
            for (float& value : field.values) {
                // What is missing has no number.
                if (std::isfinite(value)) value = sorted[static_cast<std::size_t>(value)];
            }
            field.words = names;
        }
        column.words.clear();
    }
    return particles_;
}

std::vector<FieldSummary> ParticleColumns::summaries() const {
    std::vector<FieldSummary> summaries;
    for (const Column& column : columns_) {
        if (column.axis >= 0) continue;
        summaries.push_back({column.name, 1, column.least, column.most, {}});
        FieldSummary& summary = summaries.back();
        const bool has_numbers = column.least <= column.most;
        if (has_numbers || column.told.size() > kMostTold) continue;
        summary.words.assign(column.told.begin(), column.told.end());
    }
    return summaries;
}

}  // namespace ink

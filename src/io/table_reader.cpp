// Tables of particles: CSV, TSV and columns between blanks, with a line of names, or with none.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/particle_file.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

char separator_of(std::string_view line) {
    for (const char c : {',', ';', '\t'}) {
        if (line.find(c) != std::string_view::npos) return c;
    }
    return ' ';
}

std::vector<std::string> words_of(std::string_view line, char separator) {
    std::vector<std::string> words;
    if (separator == ' ') {
        for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
            words.emplace_back(word);
        }
        return words;
    }
    for (std::string_view word : split(line, separator)) {
        if (word.size() >= 2 && word.front() == '"' && word.back() == '"') {
            word = word.substr(1, word.size() - 2);
        }
        words.emplace_back(word);
    }
    return words;
}

bool all_numbers(const std::vector<std::string>& words) {
    return std::ranges::all_of(
        words, [](const std::string& word) { return parse_double(word).has_value(); });
}

/// What the first lines say about the rest.
struct Layout {
    char separator = ' ';
    std::vector<std::string> names;
    bool has_header = false;
    std::optional<std::size_t> announced;  ///< rows, by a count in the first line (CB-Geo)
    std::string_view rows;
    std::size_t lines_before = 0;
};

/// Comments start with '#'; one before the rows may hold the names.
bool is_comment(std::string_view line) { return line.starts_with('#'); }

Layout find_layout(const Path& file, std::string_view text) {
    LineCursor lines(text);
    std::string_view names_in_comment;
    std::optional<std::size_t> announced;
    for (;;) {
        const std::string_view rest = lines.rest();
        const std::size_t before = lines.number();
        if (!lines.next())
            throw InputError(file, "holds no rows; a table with columns x, y, z is needed");
        const std::string_view line = trim(lines.line());
        if (line.empty()) continue;
        if (is_comment(line)) {
            names_in_comment = trim(line.substr(1));
            continue;
        }
        Layout layout;
        layout.separator = separator_of(line);
        layout.announced = announced;
        std::vector<std::string> words = words_of(line, layout.separator);
        if (words.size() == 1 && !announced) {
            const auto count = parse_int(words[0]);
            if (!count || *count < 0) {
                throw InputError(
                    file, lines.number(),
                    fmt::format("expected columns x, y and z, found {}", excerpt(line)));
            }
            announced = static_cast<std::size_t>(*count);
            continue;
        }
        layout.has_header = !all_numbers(words);
        layout.rows = layout.has_header ? lines.rest() : rest;
        layout.lines_before = layout.has_header ? lines.number() : before;
        if (layout.has_header) {
            layout.names = std::move(words);
            return layout;
        }
        layout.names = words_of(names_in_comment, separator_of(names_in_comment));
        if (layout.names.size() == words.size()) {
            layout.has_header = true;
            return layout;
        }
        layout.names = {"x", "y", "z", "radius"};
        layout.names.resize(std::min<std::size_t>(words.size(), 4));
        for (std::size_t k = 4; k < words.size(); ++k)
            layout.names.push_back(fmt::format("c{}", k));
        return layout;
    }
}

FileContents read_table(const Path& file, const ReadOptions& options) {
    std::string text = read_text(file);
    const Layout layout = find_layout(file, text);
    ParticleColumns columns(file, layout.names, options);
    columns.reserve(static_cast<std::size_t>(std::ranges::count(layout.rows, '\n')) + 1);
    LineCursor rows(layout.rows);
    std::string problem;
    std::size_t count = 0;
    while (rows.next()) {
        const std::string_view row = trim(rows.line());
        if (row.empty() || is_comment(row)) continue;
        if (!columns.add_row(row, layout.separator, problem)) {
            const std::string_view remedy =
                columns.remedy().empty() ? "repair or remove the row" : columns.remedy();
            throw InputError(file, layout.lines_before + rows.number(),
                             fmt::format("{}; {}", problem, remedy));
        }
        ++count;
    }
    FileContents contents;
    contents.fields = columns.summaries();
    if (layout.announced && *layout.announced != count) {
        contents.warnings.push_back(fmt::format("The first line announces {} particles, {} follow.",
                                                *layout.announced, count));
    }
    if (!layout.has_header && !layout.announced) {
        contents.warnings.push_back(
            fmt::format("The file has no line of names: its columns were taken for x, y, z{}.",
                        layout.names.size() > 3 ? ", radius" : ""));
    }
    release(text);
    return particle_contents(file, "table", std::move(columns.particles()), std::move(contents),
                             options);
}

constexpr std::array<std::string_view, 4> kExtensions{"csv", "tsv", "txt", "dat"};

}  // namespace

Reader table_reader() { return {"table", kExtensions, read_table}; }

}  // namespace ink

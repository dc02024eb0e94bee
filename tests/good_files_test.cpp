// Every real file that is whole opens with the counts that the README of the files states, which
// other programs found, and gives a picture that is framed and shaded.

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "accel/tracer.h"
#include "io/reader.h"
#include "render/render.h"
#include "test_files.h"

namespace ink {
namespace {

using test::data_file;

/// A row of one of the README's tables.
struct Row {
    std::string file;  ///< "meshes/spot.obj"
    std::vector<std::string> cells;
};

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream rest(line.substr(line.find('|') + 1));
    for (std::string cell; std::getline(rest, cell, '|');) {
        const auto begin = cell.find_first_not_of(" `");
        const auto end = cell.find_last_not_of(" `");
        cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
    }
    return cells;
}

/// The rows below a heading of the README.
std::vector<Row> rows_below(std::string_view heading, std::string_view folder) {
    std::ifstream readme(data_file("README.md"));
    std::vector<Row> rows;
    bool inside = false;
    for (std::string line; std::getline(readme, line);) {
        if (line.starts_with("## ")) inside = line.substr(3) == heading;
        if (!inside || !line.starts_with("| `")) continue;
        std::vector<std::string> cells = cells_of(line);
        std::string file = std::string(folder) + "/" + cells[0];
        rows.push_back({std::move(file), std::move(cells)});
    }
    return rows;
}

/// The number before or after a word: "5856 faces", "arrays velocity[3]".
std::optional<std::uint64_t> number_at(const std::string& text, const std::string& pattern) {
    std::smatch match;
    if (!std::regex_search(text, match, std::regex(pattern))) return std::nullopt;
    std::uint64_t number = 0;
    const std::string digits = match[1];
    std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return number;
}

std::uint64_t count_of(const FileContents& contents, std::string_view name) {
    for (const auto& [known, count] : contents.counts) {
        if (known == name) return count;
    }
    return 0;
}

class GoodFiles : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(data_file("README.md"))) GTEST_SKIP() << "no real files here";
    }
};

TEST_F(GoodFiles, OfMoleculesHaveTheAtomsAndFramesThatWereCounted) {
    const auto rows = rows_below("molecules", "molecules");
    ASSERT_GE(rows.size(), 25U);
    for (const Row& row : rows) {
        SCOPED_TRACE(row.file);
        const std::string& stated = row.cells[2];
        const FileContents contents = read_file(data_file(row.file));
        const auto models = number_at(stated, R"((\d+) models)");
        const auto frames = number_at(stated, R"((\d+) (?:frame|molecule\())");
        EXPECT_EQ(contents.frames, models.value_or(frames.value_or(contents.frames)));
        std::smatch each;  // "8/62/192 atoms" of three frames
        if (std::regex_search(stated, each, std::regex(R"((\d+)/(\d+)/(\d+) atoms)"))) {
            std::multiset<std::uint64_t> found;
            for (int k = 0; k < 3; ++k) {
                found.insert(count_of(read_file(data_file(row.file), {.frame = k}), "atoms"));
            }
            EXPECT_EQ(found,
                      (std::multiset<std::uint64_t>{std::stoull(each[1]), std::stoull(each[2]),
                                                    std::stoull(each[3])}));
        } else if (const auto atoms = number_at(stated, R"((\d+) atom)")) {
            // Of a file of models, all are counted.
            EXPECT_EQ(count_of(contents, "atoms") * models.value_or(1), *atoms);
        } else {
            EXPECT_NE(stated.find("crystal"), std::string::npos) << "nothing stated: " << stated;
            EXPECT_EQ(count_of(contents, "atoms"), 50U);  // C20 H28 O2
        }
    }
}

TEST_F(GoodFiles, OfMeshesHaveTheFacesThatWereCounted) {
    const auto rows = rows_below("meshes", "meshes");
    ASSERT_GE(rows.size(), 27U);
    // Nodes use a mesh several times, which the README counts once.
    const std::map<std::string, std::uint64_t> in_place{{"meshes/2CylinderEngine.glb", 121'496},
                                                        {"meshes/nested_nodes.glb", 36}};
    for (const Row& row : rows) {
        SCOPED_TRACE(row.file);
        const FileContents contents = read_file(data_file(row.file));
        std::uint64_t triangles = count_of(contents, "triangles");
        for (const std::string& warning : contents.warnings) {
            triangles += number_at(warning, R"(^(\d+) of \d+ triangles have no area)").value_or(0);
        }
        const auto stated = number_at(row.cells[2], R"((\d+) faces)");
        ASSERT_TRUE(stated);
        const auto placed = in_place.find(row.file);
        EXPECT_EQ(triangles, placed == in_place.end() ? *stated : placed->second);
        const auto corners = number_at(row.cells[2], R"((\d+) vertices)");
        // Which the program that counted splits at seams.
        if (placed == in_place.end()) {
            EXPECT_LE(count_of(contents, "vertices"), *corners);
        }
    }
}

TEST_F(GoodFiles, OfMeshesHaveTheVerticesThatWeldingLeaves) {
    std::size_t compared = 0;
    for (const Row& row : rows_below("mesh topology", "meshes")) {
        if (row.cells[0].starts_with("broken/")) continue;
        SCOPED_TRACE(row.file);
        const FileContents contents = read_file(data_file(row.file));
        EXPECT_EQ(count_of(contents, "vertices"), std::stoull(row.cells[1]));
        EXPECT_EQ(count_of(contents, "triangles"), std::stoull(row.cells[2]));
        ++compared;
    }
    EXPECT_GE(compared, 13U);
}

/// Names of "arrays velocity[3], id[1]" and of "columns: id type x y z", with their components.
std::map<std::string, std::size_t> fields_stated(const std::string& text) {
    std::map<std::string, std::size_t> fields;
    const std::regex array(R"(([A-Za-z_]+)\[(\d)\])");
    const auto arrays = text.find("arrays ");
    if (arrays != std::string::npos) {
        const std::string list = text.substr(arrays + 7);
        for (std::sregex_iterator it(list.begin(), list.end(), array), end; it != end; ++it) {
            fields[(*it)[1]] = std::stoul((*it)[2]);
        }
    }
    const auto columns = text.find("columns: ");
    if (columns != std::string::npos) {
        std::istringstream names(text.substr(columns + 9));
        for (std::string name; names >> name;) {
            if (name != "x" && name != "y" && name != "z") fields[name] = 1;
        }
    }
    return fields;
}

TEST_F(GoodFiles, OfParticlesHaveTheCountsAndFieldsThatWereFound) {
    const auto rows = rows_below("particles", "particles");
    ASSERT_GE(rows.size(), 20U);
    for (const Row& row : rows) {
        SCOPED_TRACE(row.file);
        const std::string& stated = row.cells[2];
        const FileContents contents = read_file(data_file(row.file), {.summarize = true});
        if (const auto frames = number_at(stated, R"((\d+) frame)")) {
            EXPECT_EQ(contents.frames, *frames);
        }
        const auto count = number_at(stated, R"((\d+) (?:points|particles|atoms|data rows))");
        ASSERT_TRUE(count) << stated;
        // An extended XYZ file is one of atoms.
        EXPECT_EQ(count_of(contents, "particles") + count_of(contents, "atoms"), *count);
        for (const auto& [name, components] : fields_stated(stated)) {
            const auto found =
                std::ranges::find(contents.fields, name, [](const auto& f) { return f.name; });
            ASSERT_NE(found, contents.fields.end()) << name;
            EXPECT_EQ(found->components, components) << name;
        }
    }
}

// ---- Pictures ----

/// What a picture shows on its background.
struct Seen {
    int left = 0, right = 0, top = 0, bottom = 0;  ///< margins, in pixels
    double share = 0.0;                            ///< of pixels that are not background
    std::size_t colors = 0;
};

Seen look_at(const Scene& scene, int side) {
    Settings settings;
    settings.size = {side, side};
    const auto image = render(scene, *make_tracer(scene), settings).display();
    Seen seen{side, side, side, side};
    std::set<std::uint32_t> colors;
    int drawn = 0;
    const std::uint32_t background = image.pixels.front();
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const std::uint32_t pixel = image.pixels[static_cast<std::size_t>(y * side + x)];
            colors.insert(pixel);
            if (pixel == background) continue;
            ++drawn;
            seen.left = std::min(seen.left, x);
            seen.right = std::min(seen.right, side - 1 - x);
            seen.top = std::min(seen.top, y);
            seen.bottom = std::min(seen.bottom, side - 1 - y);
        }
    }
    seen.share = static_cast<double>(drawn) / (side * side);
    seen.colors = colors.size();
    return seen;
}

TEST_F(GoodFiles, GivePicturesThatAreFramedAndShaded) {
    std::vector<Row> rows;
    for (const std::string folder : {"molecules", "meshes", "particles"}) {
        std::ranges::move(rows_below(folder, folder), std::back_inserter(rows));
    }
    ASSERT_GE(rows.size(), 72U);
    constexpr int kSide = 160;
    for (const Row& row : rows) {
        SCOPED_TRACE(row.file);
        const Seen seen = look_at(Scene(read_file(data_file(row.file)).objects), kSide);
        const bool is_line = row.file == "meshes/number_formats.obj";
        EXPECT_GT(seen.share, is_line ? 0.01 : 0.08);
        EXPECT_GT(seen.colors, is_line ? 2U : 8U);
        // A margin of 4 %, less half a line, on the two sides that frame it; and none cut off.
        const int across = seen.left + seen.right;
        const int down = seen.top + seen.bottom;
        EXPECT_NEAR(std::min(across, down), 2 * 0.04 * kSide, 6);
        EXPECT_GE(std::min({seen.left, seen.right, seen.top, seen.bottom}), 2);
    }
}

}  // namespace
}  // namespace ink

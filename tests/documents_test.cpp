// What the documents name is there: files, types, functions and flags.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "paths.h"

namespace ink::test {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> matches(const std::string& text, const std::regex& pattern) {
    std::vector<std::string> found;
    for (std::sregex_iterator m(text.begin(), text.end(), pattern), end; m != end; ++m) {
        found.push_back((*m)[m->size() - 1].str());
    }
    return found;
}

/// The project's sources: what is a word of theirs, and where files are.
struct Sources {
    std::set<std::string> words;  ///< of letters, digits and '_'
    std::set<std::string> flags;  ///< quoted, of letters, digits and '-'
    std::vector<std::string> files;

    Sources() {
        for (const char* folder : {"src", "include", "apps", "tests", "benchmarks", "examples"}) {
            for (const auto& entry : fs::recursive_directory_iterator(source_dir() / folder)) {
                if (entry.is_regular_file()) add(entry.path());
            }
        }
    }
    void add(const fs::path& file) {
        files.push_back("/" + fs::relative(file, source_dir()).generic_string());
        const std::string extension = file.extension().string();
        if (extension != ".h" && extension != ".cpp" && extension != ".txt") return;
        std::string word;
        char before = ' ';  // the word
        for (const char c : read(file) + '\n') {
            const bool in_word =
                std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' ||
                (c == '-' && (before == '"' || before == ',' || before == '-') && !word.empty());
            if (in_word) {
                word += c;
                continue;
            }
            if (!word.empty()) (word.find('-') == std::string::npos ? words : flags).insert(word);
            word.clear();
            before = c;
        }
    }
    bool has_file(const std::string& name) const {
        return fs::exists(source_dir() / name) ||
               std::ranges::any_of(
                   files, [&](const std::string& file) { return file.ends_with("/" + name); });
    }
    bool has_flag(const std::string& name) const {
        return words.contains(name) || flags.contains(name);
    }
};

/// Like `render_tile`, `LineIds` or `Film::add`: no word of plain English.
bool looks_like_a_name(const std::string& code) {
    static const std::regex kName("[A-Za-z_]\\w*(::\\w+)*");
    if (!std::regex_match(code, kName) || code.find("NAME") != std::string::npos) return false;
    const bool has_small =
        std::ranges::any_of(code, [](unsigned char c) { return std::islower(c); });
    return has_small &&
           (code.find('_') != std::string::npos || code.find(':') != std::string::npos ||
            std::regex_search(code, std::regex("[a-z][A-Z]|^[A-Z][a-z]{2}")));
}

class Document : public testing::TestWithParam<const char*> {
  protected:
    /// What stands between single backquotes, without blocks of code.
    static std::vector<std::string> code() {
        static const std::regex kBlock("```[^`]*```");
        static const std::regex kCode("`([^`]+)`");
        const std::string text = read(source_dir() / "docs" / GetParam());
        return matches(std::regex_replace(text, kBlock, ""), kCode);
    }
    static const Sources& sources() {
        static const Sources all;
        return all;
    }
};

INSTANTIATE_TEST_SUITE_P(Of, Document,
                         testing::Values("method.md", "architecture.md", "performance.md",
                                         "formats.md", "looks.md", "scene-file.md", "viewer.md",
                                         "coming-from.md"),
                         [](const auto& name) {
                             std::string text = name.param;
                             std::erase_if(text, [](unsigned char c) { return !std::isalpha(c); });
                             return text;
                         });

TEST_P(Document, NamesFilesThatExist) {
    static const std::regex kFile("[\\w./-]+\\.(?:cpp|h|py|sh)");
    for (const std::string& name : code()) {
        if (!std::regex_match(name, kFile) || name.find("NAME") != std::string::npos) continue;
        EXPECT_TRUE(sources().has_file(name)) << name;
    }
}

TEST_P(Document, NamesTypesAndFunctionsThatExist) {
    const std::string document = GetParam();
    if (document == "formats.md" || document == "coming-from.md") {
        GTEST_SKIP() << "names what others call theirs";
    }
    static const std::regex kPart("\\w+");
    int names = 0;
    for (const std::string& name : code()) {
        if (!looks_like_a_name(name)) continue;
        ++names;
        for (const std::string& part : matches(name, kPart)) {
            EXPECT_TRUE(sources().words.contains(part)) << name;
        }
    }
    if (document == "method.md") {
        EXPECT_GT(names, 100);
    }
    if (document == "architecture.md") {
        EXPECT_GT(names, 30);
    }
}

TEST_P(Document, NamesFlagsThatExist) {
    static const std::regex kFlag("--([a-z][a-z-]*[a-z])");
    for (const std::string& name : code()) {
        for (const std::string& flag : matches(name, kFlag)) {
            EXPECT_TRUE(sources().has_flag(flag)) << name;
        }
    }
}

}  // namespace
}  // namespace ink::test

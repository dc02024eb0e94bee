#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/data_settings.h"
#include "scene/field.h"
#include "scene/scene.h"

namespace ink {

struct ReadOptions {
    int frame = 0;           ///< of a file with several, from 0
    DataSettings data = {};  ///< what of it is drawn, and as what
    bool summarize = false;  ///< look into fields that nothing draws, too
    bool facts = false;      ///< keep what the file says about each atom and particle
};

/// What a file held, ready for a scene.
struct FileContents {
    std::vector<Object> objects;
    std::string format;       ///< "PDB", "mmCIF", "binary STL"
    std::string length_unit;  ///< "angstrom"; empty where the format does not say
    int frames = 1;
    std::vector<std::pair<std::string, std::uint64_t>> counts;  ///< ("atoms", 327), in order
    /// What can be asked for by its name: ("chains", {"A", "B"}), in the order of the file.
    std::vector<std::pair<std::string, std::vector<std::string>>> names;
    std::vector<FieldSummary> fields;   ///< what the entries carry; ranges only if asked for
    std::vector<std::string> warnings;  ///< what was left out or guessed, each a whole sentence
};

/// A file format. To add one: write a file with a function that returns its Reader, and name it in
/// reader.cpp.
struct Reader {
    std::string_view name;                         ///< "PDB"
    std::span<const std::string_view> extensions;  ///< lower case, no dot, without ".gz"
    /// Throws InputError with place, problem and remedy. Every coordinate that it returns is
    /// finite, every index in range, every radius positive.
    FileContents (*read)(const std::filesystem::path& file, const ReadOptions& options);
    bool is_folder = false;  ///< what is read is a folder of files
};

/// All formats that can be read.
std::span<const Reader> readers();

/// Reads a file by its extension, compressed or not. A name with * or ? stands for a series of
/// files, in the order in which people count, each a frame. Throws InputError.
FileContents read_file(const std::filesystem::path& file, const ReadOptions& options = {});

/// Coordinates beyond this are refused: they are damage, not data, and their squares leave the
/// range of a float.
inline constexpr double kLargestCoordinate = 1e15;

}  // namespace ink

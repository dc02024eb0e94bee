#include "io/reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "io/formats.h"
#include "io/molecule_file.h"

namespace ink {

std::span<const Reader> readers() {
    static const std::array kReaders{
        pdb_reader(), cif_reader(),   sdf_reader(),    mol2_reader(), xyz_reader(),  gro_reader(),
        pqr_reader(), table_reader(), lammps_reader(), vtk_reader(),  bgeo_reader(), uda_reader(),
        obj_reader(), ply_reader(),   stl_reader(),    off_reader(),  gltf_reader()};
    return kReaders;
}

namespace {

/// The extension that tells the format: "pdb" for "1CRN.PDB.gz".
std::string format_extension(const std::filesystem::path& file) {
    std::filesystem::path name = file.filename();
    if (to_lower(name.extension().string()) == ".gz") name = name.stem();
    const std::string extension = to_lower(name.extension().string());
    return extension.empty() ? extension : extension.substr(1);
}

std::string known_extensions() {
    std::vector<std::string_view> all;
    for (const Reader& reader : readers()) {
        all.insert(all.end(), reader.extensions.begin(), reader.extensions.end());
    }
    return fmt::format(".{}", fmt::join(all, ", ."));
}

const Reader* find_reader(const std::string& extension) {
    for (const Reader& reader : readers()) {
        if (std::ranges::find(reader.extensions, extension) != reader.extensions.end()) {
            return &reader;
        }
    }
    return nullptr;
}

void check_readable(const std::filesystem::path& file, bool wants_folder) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) {
        // A word without an extension is more likely the rest of a value than a file.
        const bool has_format = file.has_extension() || file.has_parent_path();
        throw InputError(file, has_format ? "no such file; check the path"
                                          : "no such file; check the path (values have no blanks: "
                                            "0.5pt, silhouette,crease)");
    }
    if (std::filesystem::is_directory(status) != wants_folder) {
        throw InputError(file, wants_folder ? "is not a directory; name the folder of the archive"
                                            : "is a directory; name a file in it");
    }
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, error) == 0) {
        throw InputError(file, "is empty (0 bytes); was it written to the end?");
    }
}

/// A colour that is set takes the place of all that a mesh has; `none` leaves it the usual one.
void color_meshes(FileContents& contents, const std::string& color_by) {
    const auto color = parse_color(color_by);
    for (Object& object : contents.objects) {
        auto* const mesh = std::get_if<Mesh>(&object.shape);
        if (object.kind != ObjectKind::mesh || mesh == nullptr) continue;
        if (!color && color_by != "none") {
            // Of what is meant for a molecule in the same picture nothing is said.
            constexpr std::array<std::string_view, 6> kOfAtoms{"element", "chain",  "chain-hetero",
                                                               "residue", "entity", "rainbow"};
            const bool of_atoms = std::ranges::find(kOfAtoms, color_by) != kOfAtoms.end();
            if (color_by.empty() || object.color_scale || of_atoms) continue;
            contents.warnings.push_back(fmt::format(
                "'{}' is no colour, and a mesh has no field of that name; it was drawn as it is.",
                color_by));
            continue;
        }
        mesh->colors.clear();
        object.material.color = color.value_or(Material().color);
    }
}

/// Errors about the options become errors about the file.
FileContents read_with(const Reader& reader, const std::filesystem::path& file,
                       const ReadOptions& options) {
    try {
        FileContents contents = reader.read(file, options);
        color_meshes(contents, options.data.color_by);
        return contents;
    } catch (const InputError&) {
        throw;
    } catch (const UsageError&) {
        throw;
    } catch (const Error& error) {
        throw InputError(file, error.what());
    }
}

// ---- Series ----

/// "run_*.vtp": a pattern, unless there is a file of that very name.
bool is_series(const std::filesystem::path& file) {
    std::error_code error;
    return file.filename().string().find_first_of("*?") != std::string::npos &&
           !std::filesystem::exists(file, error);
}

/// Whether `a` comes before `b` as people count: run_2 before run_10.
bool counts_before(std::string_view a, std::string_view b) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    while (!a.empty() && !b.empty()) {
        if (!is_digit(a.front()) || !is_digit(b.front())) {
            if (a.front() != b.front()) return a.front() < b.front();
            a.remove_prefix(1);
            b.remove_prefix(1);
            continue;
        }
        const auto take_number = [&](std::string_view& text) {
            std::size_t zeros = 0;
            while (zeros < text.size() && text[zeros] == '0') ++zeros;
            std::size_t end = zeros;
            while (end < text.size() && is_digit(text[end])) ++end;
            const std::string_view digits = text.substr(zeros, end - zeros);
            text.remove_prefix(end);
            return digits;
        };
        const std::string_view m = take_number(a);
        const std::string_view n = take_number(b);
        if (m.size() != n.size()) return m.size() < n.size();
        if (m != n) return m < n;
    }
    return a.size() < b.size();
}

std::vector<std::filesystem::path> files_of_series(const std::filesystem::path& pattern) {
    const std::filesystem::path folder =
        pattern.has_parent_path() ? pattern.parent_path() : std::filesystem::path(".");
    std::vector<std::filesystem::path> files;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        const std::filesystem::path name = entry.path().filename();
        if (fnmatch(pattern.filename().c_str(), name.c_str(), 0) == 0) {
            files.push_back(pattern.has_parent_path() ? entry.path() : name);
        }
    }
    std::ranges::sort(files, [](const auto& a, const auto& b) {
        const std::string first = a.string();
        const std::string second = b.string();
        return counts_before(first, second) || (!counts_before(second, first) && first < second);
    });
    return files;
}

/// Each file of a series is a frame.
FileContents read_series(const std::filesystem::path& pattern, const ReadOptions& options) {
    const std::vector<std::filesystem::path> files = files_of_series(pattern);
    if (files.empty()) throw InputError(pattern, "no file has such a name; check the pattern");
    check_frame(options.frame, static_cast<int>(files.size()), pattern);
    ReadOptions first = options;
    first.frame = 0;
    FileContents contents = read_file(files[static_cast<std::size_t>(options.frame)], first);
    contents.frames = static_cast<int>(files.size());
    return contents;
}

}  // namespace

FileContents read_file(const std::filesystem::path& file, const ReadOptions& options) {
    if (is_series(file)) return read_series(file, options);
    // "run.uda/", as shells complete the name of a folder.
    if (!file.has_filename() && file.has_relative_path()) {
        std::error_code error;
        if (std::filesystem::is_directory(file, error))
            return read_file(file.parent_path(), options);
    }
    const std::string extension = format_extension(file);
    const Reader* const reader = find_reader(extension);
    check_readable(file, reader != nullptr && reader->is_folder);
    if (reader != nullptr) return read_with(*reader, file, options);
    throw InputError(file, fmt::format("cannot tell the format from '{}'; expected one of {}",
                                       extension.empty() ? "no extension" : "." + extension,
                                       known_extensions()));
}

}  // namespace ink

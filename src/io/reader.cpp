#include "io/reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "base/error.h"
#include "base/text.h"
#include "io/formats.h"

namespace ink {

std::span<const Reader> readers() {
    static const std::array kReaders{pdb_reader(),    cif_reader(), sdf_reader(), mol2_reader(),
                                     xyz_reader(),    gro_reader(), pqr_reader(), table_reader(),
                                     lammps_reader(), vtk_reader(), obj_reader(), ply_reader(),
                                     stl_reader(),    off_reader(), gltf_reader()};
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

void check_readable(const std::filesystem::path& file) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) {
        throw InputError(file, "no such file; check the path");
    }
    if (std::filesystem::is_directory(status)) {
        throw InputError(file, "is a directory; name a file in it");
    }
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, error) == 0) {
        throw InputError(file, "is empty (0 bytes); was it written to the end?");
    }
}

/// Errors about the options become errors about the file.
FileContents read_with(const Reader& reader, const std::filesystem::path& file,
                       const ReadOptions& options) {
    try {
        return reader.read(file, options);
    } catch (const InputError&) {
        throw;
    } catch (const UsageError&) {
        throw;
    } catch (const Error& error) {
        throw InputError(file, error.what());
    }
}

}  // namespace

FileContents read_file(const std::filesystem::path& file, const ReadOptions& options) {
    check_readable(file);
    const std::string extension = format_extension(file);
    for (const Reader& reader : readers()) {
        if (std::ranges::find(reader.extensions, extension) != reader.extensions.end()) {
            return read_with(reader, file, options);
        }
    }
    throw InputError(file, fmt::format("cannot tell the format from '{}'; expected one of {}",
                                       extension.empty() ? "no extension" : "." + extension,
                                       known_extensions()));
}

}  // namespace ink

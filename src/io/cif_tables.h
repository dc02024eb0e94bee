#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/molecule_file.h"

namespace ink {

struct CifValue {
    std::string_view text;  ///< as it is written
    std::size_t line = 0;
};

/// Columns of CIF tables that are kept whole, by their tags in lower case, whether the file writes
/// them as loops or as single items. Views stay valid as long as the text.
using CifTables = std::map<std::string, std::vector<CifValue>>;

/// The column of that tag; empty where there is none.
const std::vector<CifValue>& column(const CifTables& tables, const std::string& tag);

/// A value without quotes; "?" and "." mean that there is none.
std::string_view plain_value(std::string_view value);

/// A number without its standard uncertainty: "1.234" of "1.234(5)".
std::string_view without_uncertainty(std::string_view number);

/// Assemblies of an mmCIF file (pdbx_struct_assembly_gen and pdbx_struct_oper_list):
/// cif_assembly.cpp
std::vector<Assembly> cif_assemblies(const CifTables& tables, const std::filesystem::path& file);

/// The space group that the file names, in full, as "P 1 21 1"; empty where it names none.
std::string_view space_group(const CifTables& tables);

/// Whether the tables hold a small-molecule crystal, with fractional coordinates.
bool is_crystal(const CifTables& tables);

/// Its asymmetric unit: cif_crystal.cpp. Throws InputError.
FileContents read_crystal(const CifTables& tables, const std::filesystem::path& file,
                          const ReadOptions& options);

}  // namespace ink

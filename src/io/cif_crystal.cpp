// Small-molecule crystals in the core CIF dictionary: fractional coordinates and a cell.

#include <fmt/format.h>

#include <array>
#include <gemmi/unitcell.hpp>

#include "base/error.h"
#include "base/text.h"
#include "io/cif_tables.h"
#include "io/file_text.h"
#include "scene/elements.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

double cell_number(const CifTables& tables, const std::string& tag, double most, const Path& file) {
    const auto& values = column(tables, tag);
    if (values.empty()) {
        throw InputError(file,
                         fmt::format("has fractional coordinates but no {}; add the cell", tag));
    }
    const auto number = parse_double(without_uncertainty(plain_value(values[0].text)));
    if (!number || !(*number > 0.0) || !(*number < most)) {
        throw InputError(
            file, values[0].line,
            fmt::format("{} {} is not usable; repair the cell", tag, excerpt(values[0].text)));
    }
    return *number;
}

gemmi::UnitCell read_cell(const CifTables& tables, const Path& file) {
    constexpr double kLongest = 1e6;
    const auto length = [&](const char* tag) { return cell_number(tables, tag, kLongest, file); };
    const auto angle = [&](const char* tag) { return cell_number(tables, tag, 180.0, file); };
    const double a = length("_cell_length_a");
    const double b = length("_cell_length_b");
    const double c = length("_cell_length_c");
    const double alpha = angle("_cell_angle_alpha");
    const double beta = angle("_cell_angle_beta");
    const double gamma = angle("_cell_angle_gamma");
    gemmi::UnitCell cell;
    cell.set(a, b, c, alpha, beta, gamma);
    if (!(cell.volume > 0.0)) {
        throw InputError(file, "the angles of the cell do not close; repair the cell");
    }
    return cell;
}

/// "C1", "Fe3+" or "OW": the element that the letters begin with.
std::uint8_t element_of_site(std::string_view symbol, std::string_view label) {
    return element_of_name(symbol.empty() ? label : symbol, {});
}

/// A column beside the coordinates, which may be missing.
std::string_view optional_value(const std::vector<CifValue>& values, std::size_t row) {
    return row < values.size() ? plain_value(values[row].text) : std::string_view();
}

/// Unless the file says that the identity is all of it.
bool has_symmetry(const CifTables& tables) {
    for (const char* const tag :
         {"_symmetry_equiv_pos_as_xyz", "_space_group_symop_operation_xyz"}) {
        if (column(tables, tag).size() == 1) return false;
    }
    return true;
}

constexpr std::array<std::string_view, 2> kFields{"occupancy", "uiso"};

}  // namespace

std::string_view space_group(const CifTables& tables) {
    for (const char* const tag : {"_symmetry_space_group_name_h-m", "_space_group_name_h-m_alt",
                                  "_symmetry.space_group_name_h-m", "_space_group.name_h-m_full"}) {
        const auto& values = column(tables, tag);
        if (!values.empty() && !plain_value(values[0].text).empty()) {
            return plain_value(values[0].text);
        }
    }
    return {};
}

bool is_crystal(const CifTables& tables) { return !column(tables, "_atom_site_fract_x").empty(); }

FileContents read_crystal(const CifTables& tables, const Path& file, const ReadOptions& options) {
    const auto& x = column(tables, "_atom_site_fract_x");
    const auto& y = column(tables, "_atom_site_fract_y");
    const auto& z = column(tables, "_atom_site_fract_z");
    if (y.size() != x.size() || z.size() != x.size()) {
        throw InputError(file, x.front().line,
                         "the atom table needs fract_x, fract_y and fract_z; repair the table");
    }
    const gemmi::UnitCell cell = read_cell(tables, file);
    const auto& symbols = column(tables, "_atom_site_type_symbol");
    const auto& labels = column(tables, "_atom_site_label");
    const auto& disorder = column(tables, "_atom_site_disorder_group");
    const auto& occupancy = column(tables, "_atom_site_occupancy");
    const auto& uiso = column(tables, "_atom_site_u_iso_or_equiv");
    check_frame(options.frame, 1, file);
    MoleculeBuilder molecule;
    molecule.reserve(x.size());
    molecule.set_fields(kFields);
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!molecule.keeps_location(optional_value(disorder, i))) continue;
        const auto coordinate = [&](const CifValue& value) {
            return without_uncertainty(plain_value(value.text));
        };
        const Vec3d f =
            parse_position(coordinate(x[i]), coordinate(y[i]), coordinate(z[i]), {file, x[i].line});
        const gemmi::Position p = cell.orthogonalize(gemmi::Fractional(f.x, f.y, f.z));
        if (!(std::abs(p.x) <= kLargestCoordinate && std::abs(p.y) <= kLargestCoordinate &&
              std::abs(p.z) <= kLargestCoordinate)) {
            throw InputError(file, x[i].line, "the atom lies too far from the cell; repair it");
        }
        const std::string_view label = optional_value(labels, i);
        molecule.add_atom({p.x, p.y, p.z}, element_of_site(optional_value(symbols, i), label),
                          label);
        const auto number = [&](const std::vector<CifValue>& values, double otherwise) {
            return parse_double(without_uncertainty(optional_value(values, i))).value_or(otherwise);
        };
        molecule.set_value(0, number(occupancy, 1.0));
        molecule.set_value(1, number(uiso, 0.0));
    }
    if (has_symmetry(tables)) molecule.set_space_group(space_group(tables));
    return std::move(molecule).finish(file, "CIF", 1, options);
}

}  // namespace ink

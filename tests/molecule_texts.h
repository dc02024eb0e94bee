#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "read_contents.h"
#include "scene/elements.h"

/// Small molecules as text, and what readers make of them.
namespace ink::test {

/// How many atoms, say, a reader counts; 0 where it counts none.
inline std::uint64_t count(const FileContents& contents, std::string_view what) {
    for (const auto& [name, value] : contents.counts) {
        if (name == what) return value;
    }
    return 0;
}

/// "CHHO": the elements in the order of the atoms, told by radius and colour.
inline std::string elements(const FileContents& contents) {
    std::string text;
    for (std::size_t i = 0; i < spheres(contents).spheres.size(); ++i) {
        std::uint8_t z = 0;
        while (z < kElementCount &&
               (element(z).color != spheres(contents).colors[i] ||
                element(z).vdw_radius != spheres(contents).spheres[i].radius)) {
            ++z;
        }
        text += z < kElementCount ? element(z).symbol : "(no element)";
    }
    return text;
}

inline void expect_refused(const std::filesystem::path& file, std::string_view place_and_problem,
                           std::string_view remedy, int frame = 0) {
    const std::string message = refusal(file, {.frame = frame});
    EXPECT_NE(message.find(file.string() + std::string(place_and_problem)), std::string::npos)
        << message;
    EXPECT_NE(message.find(remedy), std::string::npos) << message;
}

// Formaldehyde, once in each format.
inline constexpr std::string_view kXyz =
    "4\nformaldehyde\nC 0.0 0.0 0.0\nO 1.2 0.0 0.0\nH -0.6 0.9 0.0\nH -0.6 -0.9 0.1\n";

inline std::string pdb_atom(std::string_view name, std::string_view residue, int number, Vec3d p,
                            std::string_view symbol, char location = ' ', char chain = 'A') {
    return fmt::format("ATOM  {:5} {:4}{}{:>3} {}{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00{:>12}\n",
                       1, name, location, residue, chain, number, p.x, p.y, p.z, symbol);
}

inline std::string formaldehyde_pdb() {
    return pdb_atom(" C1 ", "FOR", 1, {0, 0, 0}, "C") +
           pdb_atom(" O1 ", "FOR", 1, {1.2, 0, 0}, "O") +
           pdb_atom(" H1 ", "FOR", 1, {-0.6, 0.9, 0}, "H") +
           pdb_atom(" H2 ", "FOR", 1, {-0.6, -0.9, 0.1}, "H") + "END\n";
}

inline constexpr std::string_view kCifHeader =
    "data_test\nloop_\n_atom_site.group_PDB\n_atom_site.type_symbol\n_atom_site.label_alt_id\n"
    "_atom_site.label_comp_id\n_atom_site.auth_asym_id\n_atom_site.auth_seq_id\n"
    "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
    "_atom_site.pdbx_PDB_model_num\n";

inline std::string cif(std::string_view rows) {
    return std::string(kCifHeader) + std::string(rows);
}

inline constexpr std::string_view kCifRows =
    "HETATM C . FOR A 1 0.0 0.0 0.0 1\nHETATM O . FOR A 1 1.2 0.0 0.0 1\n"
    "HETATM H . 'FOR' A 1 -0.6 0.9(2) 0.0 1\nHETATM H . FOR A 1 -0.6 -0.9 0.1 1\n";

inline constexpr std::string_view kSdf =
    "formaldehyde\n test\n\n  4  3  0  0  0  0  0  0  0  0999 V2000\n"
    "    0.0000    0.0000    0.0000 C   0  0\n    1.2000    0.0000    0.0000 O   0  0\n"
    "   -0.6000    0.9000    0.0000 H   0  0\n   -0.6000   -0.9000    0.1000 H   0  0\n"
    "  1  2  2  0\n  1  3  1  0\n  1  4  1  0\nM  END\n$$$$\n";

inline constexpr std::string_view kV3000 =
    "formaldehyde\n test\n\n  0  0  0  0  0  0  0  0  0  0999 V3000\nM  V30 BEGIN CTAB\n"
    "M  V30 COUNTS 4 3 0 0 0\nM  V30 BEGIN ATOM\nM  V30 1 C 0 0 0 0\nM  V30 2 O 1.2 0 -\n"
    "M  V30 0 0\nM  V30 7 H -0.6 0.9 0 0\nM  V30 9 H -0.6 -0.9 0.1 0\nM  V30 END ATOM\n"
    "M  V30 BEGIN BOND\nM  V30 1 2 1 2\nM  V30 2 1 1 7\nM  V30 3 1 1 9\nM  V30 END BOND\n"
    "M  V30 END CTAB\nM  END\n";

}  // namespace ink::test

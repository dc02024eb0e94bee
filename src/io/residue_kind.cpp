#include <gemmi/resinfo.hpp>
#include <string>

#include "io/molecule_file.h"

namespace ink {

ResidueKind residue_kind(std::string_view name) {
    // Water as simulations name it; gemmi knows HOH, DOD and WAT.
    for (const std::string_view water : {"SOL", "TIP3", "TIP4", "TIP", "T3P", "SPC"}) {
        if (name == water) return ResidueKind::water;
    }
    const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(std::string(name));
    if (info.is_water()) return ResidueKind::water;
    if (info.is_amino_acid()) return ResidueKind::protein;
    if (info.is_nucleic_acid()) return ResidueKind::nucleic;
    return ResidueKind::other;
}

}  // namespace ink

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "scene/clip_box.h"
#include "scene/colormap.h"

namespace ink {

/// How a molecule is drawn.
enum class Representation : std::uint8_t {
    spheres,         ///< each atom with its full radius (Corey and Pauling 1953)
    ball_and_stick,  ///< small atoms, and a stick for each bond
    sticks           ///< bonds alone, with rounded ends
};

/// Radii of atoms, in angstrom (scene/elements.h).
enum class RadiiTable : std::uint8_t {
    vdw,      ///< van der Waals, Mantina et al. 2009
    bondi,    ///< van der Waals, Bondi 1964, as PyMOL draws them; vdw where Bondi gives none
    covalent  ///< Cordero et al. 2008
};

/// What particles are drawn as.
enum class Glyph : std::uint8_t { sphere, box, ellipsoid };

/// What of a file is drawn, and as what. Names of fields are checked where the file is known.
struct DataSettings {
    std::string assembly =
        {};  ///< biological assembly by its name in the file; empty: its atoms alone
    std::string select = {};  ///< which atoms (scene/selection.h); empty: all
    ClipBox clip = {};

    Representation representation = Representation::spheres;
    RadiiTable radii = RadiiTable::vdw;
    std::optional<double> stick_radius = {};  ///< of bonds; default: by the representation
    std::string radius = {};  ///< a number for all, or a field; empty: the file's, else chosen
    Glyph glyph = Glyph::sphere;
    std::string glyph_field = {};  ///< the tensor or orientation of glyphs; empty: by its name

    std::string color_by =
        {};  ///< "element", "chain", ... or a field; empty: the file's, else usual_coloring
    const ColorMap* color_map = &color_maps().front();
    std::optional<std::pair<double, double>> color_range = {};  ///< of a field; default: all of it

    std::string parts = {};  ///< "chain", "residue", ... or a field of whole numbers; empty: chains
    /// Unless `parts` says otherwise: residues, and lines run between them. For molecules whose
    /// file names any.
    bool by_residue = false;
};

}  // namespace ink

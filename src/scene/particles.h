#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/color.h"
#include "base/vec.h"
#include "scene/data_settings.h"
#include "scene/field.h"
#include "scene/scene.h"

namespace ink {

/// One frame of a particle data set. Arrays of one entry a particle are complete or empty.
struct Particles {
    std::string name;
    Vec3d origin;                  ///< the first particle
    std::vector<Vec3f> positions;  ///< from `origin`, in the units of the file
    std::vector<Rgb8> colors;      ///< that the file gives
    std::vector<Field> fields;     ///< those that are drawn; others are not kept

    std::size_t count() const { return positions.size(); }
};

/// Names that a field of radii goes by, in lower case; of diameters, likewise.
bool is_radius_name(std::string_view name);
bool is_diameter_name(std::string_view name);

/// The names of fields that the settings ask for; radii, glyphs and kinds that go by their usual
/// names are wanted beside them.
std::vector<std::string> requested_fields(const DataSettings& settings);

/// Half the usual distance from a particle to its nearest neighbour: the radius at which particles
/// without one touch. Positive; the median over a sample. Places that are not finite do not count.
/// Linear in time and memory.
double touching_radius(const std::vector<Vec3f>& positions);

/// The particles as objects to draw, with what was left out or chosen in `warnings`, and with their
/// fields as facts if asked for. Throws Error where the settings name what the particles do not
/// have, or nothing is left to draw.
std::vector<Object> represent(Particles particles, const DataSettings& settings,
                              std::vector<std::string>& warnings, bool facts = false);

}  // namespace ink

#pragma once

#include <optional>

#include "base/vec.h"
#include "scene/glyphs.h"

namespace ink {

/// The first s in [lo, hi] where the point o + s d of a ray lies on the height field
/// z = f(x, y) of a unit shape of kind gaussian or waves.
std::optional<double> first_on_height_field(const UnitShape& shape, Vec3d o, Vec3d d, double lo,
                                            double hi);

/// (df/dx, df/dy) of the height field.
struct Slopes {
    double x, y;
};
Slopes height_field_slopes(const UnitShape& shape, double x, double y);

}  // namespace ink

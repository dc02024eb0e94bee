#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace ink {

/// Cuts a polygon into triangles and appends them to `triangles`, as indices into `corners` (at
/// least 3), keeping the winding: a fan where the first corner sees all others, else ear clipping
/// (Meisters 1975) in the plane of the mean normal. Holes may be joined to the outline by a cut.
/// False, with nothing appended, when the outline is too long and winding to be cut in good time.
bool triangulate(std::span<const Vec3f> corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace ink

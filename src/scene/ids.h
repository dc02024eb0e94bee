#pragma once

#include <cstdint>

namespace ink {

/// The level at which two hits count as the same geometry (paper, section 3.1, footnote 1).
enum class IdLevel : std::uint8_t {
    primitive,  ///< sphere, triangle, glyph
    part,       ///< residue, chain, mesh group, particle body
    object      ///< whole molecule, whole mesh
};

/// Which normals creases are found by.
enum class NormalSource : std::uint8_t {
    automatic,  ///< smooth across every edge of a mesh but its own creases
    shading,    ///< as the surface is shaded: what a file's own normals smooth over, hides
    geometric   ///< of the surface itself: every edge between triangles that do not lie in a plane
};

/// What a ray hit, as a number: equal for two hits exactly when they are the same geometry.
using GeometryId = std::uint32_t;

/// The ID of a miss.
inline constexpr GeometryId kBackground = 0;

}  // namespace ink

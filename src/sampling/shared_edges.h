#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sampling/samples.h"
#include "scene/mesh.h"

namespace ink {

/// As many triangles and vertices a mesh may have for `find_shared_edges`.
inline constexpr std::size_t kMostShared = (std::size_t{1} << 31U) / 3;

/// Of pairs of triangles of a mesh, by their numbers less `base`: the edge of the first, 3 *
/// triangle + k, behind which the second one goes on, with the same side towards the viewer;
/// kNoTwin where there is none, or a number is no triangle.
/// The spans have equal length.
void find_shared_edges(const Mesh& mesh, const Viewpoint& viewpoint, std::uint32_t base,
                       std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                       std::span<std::uint32_t> edges);

}  // namespace ink

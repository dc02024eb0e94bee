#pragma once

#include <memory>

#include "accel/tracer.h"

namespace ink {

/// The scene seen through one camera without its nearest surfaces: along each ray, what is behind
/// `layer` others. Layer 0 is what a camera sees.
///
/// Solids (spheres, hexahedra, closed glyphs) count as one body where they overlap: a surface of
/// one that lies within another is none, as if all had been united. Meshes, and glyphs that are
/// open, count sheet by sheet; what lies within a solid is hidden in it and is none either.
///
/// `front` is the same camera's frame without peeling. All but the camera must outlive the frame.
std::unique_ptr<FrameTracer> make_peeled_frame(const Scene& scene, const Tracer& tracer,
                                               const FrameTracer& front, int layer);

}  // namespace ink

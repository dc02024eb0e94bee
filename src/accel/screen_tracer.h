#pragma once

#include <memory>

#include "accel/clusters.h"
#include "accel/tracer.h"

namespace ink {

/// Traces camera rays without a general hierarchy. All rays of a camera fan out from one point (or
/// run parallel), so what a primitive shows of itself is a region of the screen, known in closed
/// form: an ellipse for a sphere, three edges for a triangle; and rays in the coordinates of a
/// glyph are an affine function of the screen. A tile finds the clusters whose screen bounds reach
/// it, nearest first. The blocks of a lattice are traced cluster by cluster, other points packet by
/// packet, sixteen points by one primitive at a time, up to the first cluster behind what is found;
/// triangles that may show at a few points only, point by point.
///
/// The clusters must outlive the tracer. The projection must see all of the scene. Positions on the
/// screen are rounded once, from double precision, relative to the picture's centre: outlines are
/// within 2^-14 pixel in pictures of up to 4096 pixels; those of glyphs also within a few 1e-7 of
/// their size. Neighbouring triangles share the arithmetic of their common edge, so that no ray
/// passes between them. A hit depends on the ray's point alone, not on tiles or packets.
std::unique_ptr<FrameTracer> make_screen_tracer(const Clusters& clusters,
                                                const Projection& projection);

/// Null where that is likely to be slower than Embree, by the clusters that a few small squares of
/// the picture take. Where a pixel sees through many small primitives, a hierarchy is better. The
/// choice does not depend on tiles or threads: the hits of the two differ in their last digits.
std::unique_ptr<FrameTracer> make_suited_screen_tracer(const Clusters& clusters,
                                                       const Projection& projection);

}  // namespace ink

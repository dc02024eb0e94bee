#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "lines/density.h"
#include "lines/detect.h"
#include "lines/edge_balls.h"
#include "lines/ink.h"
#include "lines/line_type.h"
#include "lines/locate.h"
#include "lines/segment.h"
#include "render/edge_smoothing.h"
#include "render/pipeline.h"
#include "render/small_things.h"
#include "render/tiles.h"
#include "sampling/mesh_walk.h"
#include "sampling/samples.h"
#include "sampling/surfaces.h"

namespace ink {

/// The lines of one tile on their way from the pass that finds them to the pass that draws.
struct TileLines {
    std::vector<InkStroke> strokes;  ///< to be inked
    std::size_t inner = 0;           ///< of them, the first so many ink no pixel of another tile
    std::vector<Segment> segments;   ///< all, in full, where anything asks for more than ink
    Fringe fringe;
};

/// What method "edges" settles before it goes over the tiles, which share it: what is searched and
/// drawn, in which styles, by which thresholds and on which tiles.
struct EdgesPlan {
    explicit EdgesPlan(const Pipeline& shared);

    /// Index into the ink's styles, of which those of hidden lines come last.
    std::size_t style_of(const Segment& segment) const {
        if (styles_by_type && !segment.hidden) return static_cast<std::size_t>(segment.type);
        return find_style(segment);
    }
    std::size_t find_style(const Segment& segment) const;
    /// Index of the tile that a point was searched in.
    std::size_t search_tile_at(Vec2f point) const;
    std::size_t search_tiles_across() const { return static_cast<std::size_t>(tiles_across); }
    /// What all search tiles cover.
    Tile search_area() const {
        const Tile& last = search_tiles.back();
        return {search_tiles.front().x0, search_tiles.front().y0, last.x1, last.y1};
    }
    std::size_t style_of(LineType type, std::uint32_t object) const;
    /// Whether self-occlusions are made whole once all are found.
    bool mends_lines() const {
        return find_lines && wanted.has(LineType::self_occlusion) && !balls_only;
    }
    /// Whether anything asks for whole lines, and not only for their ink.
    bool wants_segments() const {
        return pipeline.lines.segments || pipeline.lines.drawing != nullptr ||
               (pipeline.aovs && pipeline.aovs->wants_line_planes());
    }
    /// Whether tiles keep whole lines until all are found.
    bool keeps_segments() const { return mends_lines() || wants_segments(); }
    /// How far from a stroke's ends a tile may lie that it still inks pixels of.
    float stroke_reach() const { return std::ceil(ink.reach()) + 1.0F; }
    bool wants_faces() const { return find_lines && has_meshes && wanted.has(LineType::mesh); }
    /// Whether the line where a face goes out of sight covers all that its edges behind it could
    /// ink, so that lines between faces need not end there.
    bool outlines_cover_faces() const;
    /// Whether lines between faces are drawn from BorderMap: if it is all the same which faces
    /// they lie between, and each triangle is a face.
    bool draws_borders() const;
    bool wants_ridges() const { return find_lines && wanted.has(LineType::ridge) && !balls_only; }

    /// Whether both sides of a line belong to one whole, where that makes a difference.
    bool is_inner(const Segment& segment) const;
    /// How far back in the scene lies what a point of the screen sees at distance t, in [0, 1].
    float depth_at(Vec2f point, float t) const;
    /// Whether lines get fainter or thinner the farther back they lie.
    bool cues_depth() const;
    /// Whether some lines are drawn with less than the width of their style for what they are lines
    /// of: something far away, or small.
    bool attenuates_lines() const { return cues_depth() || small_things.any(); }
    /// Makes a line so. The one place that asks what a line belongs to; what asks how dense lines
    /// are about it, LineThinning, waits until all are found, and counts them as wide as this
    /// leaves them.
    void attenuate(Segment& segment) const;

    const Pipeline& pipeline;
    int q;  ///< lattice points along a pixel's side
    Surfaces surfaces;
    MeshWalk mesh_walk;
    bool draw_lines;  ///< on the film
    bool find_lines;  ///< for the film, or as data
    bool has_meshes;
    bool tones;           ///< divide geometries into light and shade, as data
    bool smooth_shading;  ///< blend the colours of pixels that a line cuts
    /// Every geometry is one ball, on which there are no lines.
    bool balls_only;
    std::optional<BallTable> balls;  ///< then, if they are one set of spheres
    DetectSettings detect;
    LocateSettings locate;
    LineTypes wanted;
    bool styles_by_object;
    bool tells_inner;     ///< lines within one whole have styles of their own
    int style_levels;     ///< levels with styles of their own, and those beyond: 1 if all are alike
    bool styles_by_type;  ///< and by nothing else, but for hidden lines
    /// Styles by type, object after object where they have styles of their own, and all that level
    /// after level likewise; then, if they are told apart, all that for lines within one whole.
    InkSettings ink;
    float halo_px;
    std::size_t halo_style = 0;  ///< of the paper that halos show, if there are any
    float depth_range;           ///< of the scene as the camera sees it, scene units
    SmallThings small_things;
    /// Empty, for the tiles' workers to start from.
    LineDensity no_lines;
    Viewpoint viewpoint;
    int margin;  ///< pixels searched beyond the film's edge, for lines that reach in
    int tiles_across, tiles_down;  ///< that are searched
    std::vector<Tile> search_tiles, draw_tiles;
    /// The surfaces behind the nearest ones, layer by layer; empty unless hidden lines are wanted.
    std::vector<std::unique_ptr<FrameTracer>> behind;
};

}  // namespace ink

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lines/detect.h"
#include "lines/line_type.h"
#include "lines/predict.h"
#include "sampling/samples.h"

namespace ink {

/// How crossings are found and what they count as. Like detection's, these thresholds have no
/// length in them.
struct LocateSettings {
    int steps = 6;  ///< of bisection: to 2^-6 of the lattice's spacing
    /// A predicted crossing is checked by a ray this far beside it, in lattice spacings. (A
    /// sphere's outline is where its rays end; on it, rounding decides.)
    float check_offset = 1.0F / 64.0F;
    /// Where one of the two balls has a smaller radius than this, in lattice spacings, predictions
    /// are not checked. A third surface in between, seen by no lattice point, is then missed, as it
    /// may be anyway; of 1ffk at 1024 x 1024 (radius 7) the picture stays the same to the eye and
    /// takes three quarters of the time. It bounds the rays where lines are dense.
    float least_checked = 10.0F;
    /// Two surfaces meet if their tangent planes do within the last interval, or this many lengths
    /// of it beside it; the planes of facets are exact, those of curved surfaces nearly so.
    float meeting_slack = 0.25F;
    /// Where a slope is steeper than this, the planes say too little: bisect further, then decide.
    float steep_slope = 4.0F;
    int steep_steps = 5;
    /// A surface turns away at a crossing if its slope, going on as it did, becomes infinite within
    /// so many lengths of the last interval.
    float contour_slack = 1.5F;
    /// Within one geometry, and only if the depth differs by this many times what one surface that
    /// curves from one normal to the other can do.
    float leap = 1.5F;
    /// Each step must leave this share of a jump or a turn, or it is none: on a smooth surface a
    /// step halves it at least. The jump at a contour shrinks too, as the front surface's normal
    /// tilts, but only by the root of 1/2.
    float surviving_share = 0.6F;
    /// No step need leave less than this of a turn: the rest is the curve of the sides.
    float surviving_turn = 0.3F;
    /// A surface ends at an open edge if the crossing lies within this many last intervals of one.
    float rim_slack = 2.0F;
    /// A surface that is seen through a slit in another one, narrower than this many lattice
    /// spacings, has no line: meshes whose triangles do not quite meet are full of such slits, and
    /// which lattice points see through them is chance.
    float slit_width = 0.25F;
    /// Creases: none below the first angle, full strength from the second on, smoothstep between.
    float crease_min_deg = 10.0F;
    float crease_full_deg = 30.0F;
};

/// A point where a line crosses an edge of the lattice.
struct Crossing {
    Vec2f point;
    LineType type = LineType::silhouette;
    float strength = 1.0F;
    float t = 0.0F;          ///< of the nearer side
    std::uint32_t edge = 0;  ///< index of the suspect edge
    /// IDs at the edge's first and second end's side; of a mesh line, numbers for the faces.
    GeometryId first = kBackground, second = kBackground;
    GeometryId nearer = kBackground;  ///< the one of the two that lies in front
    bool first_in_front = true;       ///< whether that is the first end's side
};

/// Rounding of positions, in a scene of size 1.
inline constexpr float kPositionRounding = 4e-6F;

/// Of a crease at which the surface turns by an angle, radians.
float crease_strength(const LocateSettings& settings, float angle);
/// Of a crease, as the chord on the unit sphere.
float least_turn(const LocateSettings& settings);

/// One side of a predicted crossing: what the edge's end saw there.
struct PredictedSide {
    Vec2f end;  ///< on the screen, pixels
    GeometryId id = kBackground;
    float t = 0.0F;  ///< as in Sample
    Ball ball{};
};

/// Whether a ray must confirm a prediction, and where along the edge it goes, in [0, 1].
inline bool needs_check(const LocateSettings& settings, const Prediction& p) {
    using Kind = Prediction::Kind;
    // The check would repeat what the edge's end has seen.
    const bool known = (p.kind == Kind::first_contour && p.at + settings.check_offset >= 1.0F) ||
                       (p.kind == Kind::second_contour && p.at <= settings.check_offset);
    return !known && p.squared_radius >= settings.least_checked * settings.least_checked;
}
inline float checked_place(const LocateSettings& settings, const Prediction& p) {
    if (p.kind == Prediction::Kind::first_contour) return p.at + settings.check_offset;
    if (p.kind == Prediction::Kind::second_contour) return p.at - settings.check_offset;
    return p.at;
}

/// Fills in all of a crossing but its edge; false where there is no line. What a prediction says
/// needs no measuring: a contour hides, a seam joins.
inline bool cross_as_predicted(const Viewpoint& viewpoint, const LocateSettings& settings,
                               const Prediction& p, const PredictedSide& first,
                               const PredictedSide& second, Crossing& crossing) {
    using Kind = Prediction::Kind;
    const bool first_in_front =
        p.kind == Kind::first_contour || (p.kind != Kind::second_contour && first.t <= second.t);
    crossing.point = first.end + (second.end - first.end) * p.at;
    crossing.first = first.id;
    crossing.second = second.id;
    crossing.nearer = first_in_front ? first.id : second.id;
    crossing.first_in_front = first_in_front;
    crossing.t = p.t;
    crossing.strength = 1.0F;
    const bool one_id = first.id == second.id;
    if (p.kind != Kind::seam) {
        crossing.type = one_id ? LineType::self_occlusion : LineType::silhouette;
        return true;
    }
    crossing.type = one_id ? LineType::crease : LineType::intersection;
    if (one_id) {
        const float angle = seam_angle(viewpoint, crossing.point, p.t, first.ball, second.ball);
        crossing.strength = crease_strength(settings, angle);
    }
    return crossing.strength > 0.0F;
}

/// Finds where lines cross suspect edges, and classifies them. Between balls the crossing is
/// computed and checked by one more sample; else the edge is bisected, all edges in step. Where a
/// third geometry turns up in between, both crossings are kept; what proves to be smooth is
/// dropped. Crossings come in the order of the edges, those of one edge from its first end on.
class Locator {
  public:
    /// `way_out` may be empty if nothing is known of triangles.
    Locator(const Viewpoint& viewpoint, const LocateSettings& settings,
            WayOutFunction way_out = {});

    /// `describe` may be empty if nothing is known of the grid's surfaces.
    void locate(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                const SurfaceFunction& describe, const SampleFunction& sample,
                std::vector<Crossing>& crossings);
    /// The same of some of the edges, by their indices; adds to the crossings.
    void locate_some(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                     std::span<const std::uint32_t> some, const SurfaceFunction& describe,
                     const SampleFunction& sample, std::vector<Crossing>& crossings);

    /// Suspect edges of the last call whose first end looks into a slit, and their second beside
    /// it.
    std::span<const std::uint32_t> slits() const { return slits_; }

  private:
    enum class State : std::uint8_t {
        open,
        smooth,   ///< proved to hold nothing
        located,  ///< by bisection
        foreseen  ///< by prediction
    };

    /// The part of a lattice edge that still holds a discontinuity.
    struct Interval {
        Vec2f a, b;
        Sample at_a, at_b;
        Suspicion suspicion = Suspicion::id;
        bool may_split = true;
        bool a_moved = false, b_moved = false;  ///< off the ends of the lattice edge
        std::uint32_t edge = 0;
        float first_jump = 0.0F, first_gap = 0.0F, first_turn = 0.0F;  ///< between the edge's ends
        /// The square of the cosine between normal and ray, and where, at the ends before these:
        /// it falls to zero along a straight line towards a contour. Negative: not known.
        float before_a = -1.0F, before_b = -1.0F;
        Vec2f point_before_a{}, point_before_b{};
        int steps = 0;  ///< of bisection so far
        State state = State::open;
        std::optional<Prediction> prediction{};
    };

    void start(const SampleGrid& grid, std::span<const SuspectEdge> edges,
               std::span<const std::uint32_t> some, const SurfaceFunction& describe);
    void predict(Interval& interval) const;
    void step(const SampleFunction& sample);
    Vec2f next_point(const Interval& interval) const;
    void check(std::size_t k, Vec2f point, const Sample& sample);
    void narrow(std::size_t k, Vec2f point, const Sample& sample);
    void split(std::size_t k, Vec2f point, const Sample& sample);
    void drop_specks(const SampleFunction& sample);
    bool is_speck(const Interval& interval, const Sample& beyond) const;
    bool touch(const Interval& interval) const;
    void drop_slits(float spacing, const SampleFunction& sample);
    void drop_slit(Interval& interval, bool first_within);
    bool lies_in_slit(const Interval& interval, const Sample& beyond,
                      const Sample& on_other_side) const;
    void refine_steep(const SampleFunction& sample);
    void move_end(Interval& interval, bool first, Vec2f point, const Sample& sample) const;
    bool surfaces_meet(const Interval& interval) const;
    bool planes_meet(const Interval& interval) const;
    bool may_meet(const Interval& interval) const;
    bool ends_before(const Interval& interval) const;
    struct Depths {
        float at_a, at_b;
    };
    Depths depths_between(const Interval& interval) const;
    float across(const Interval& interval) const;
    bool leaps(const Interval& interval) const;
    bool has_contour(const Interval& interval) const;
    bool has_jump(const Interval& interval) const;
    bool has_crease(const Interval& interval) const;
    bool classify(const Interval& interval, Crossing& crossing) const;
    bool ends_at_rim(const Interval& interval) const;
    float jump_share(const Interval& interval) const;
    float facing(const Sample& sample) const;
    float slope(const Sample& sample) const;
    float steeper_slope(const Interval& interval) const;
    float gap(const Interval& interval) const;

    Viewpoint viewpoint_;
    LocateSettings settings_;
    WayOutFunction way_out_;
    float least_turn_;                ///< of a crease, as a chord
    std::vector<float> jump_shares_;  ///< that must be left after so many steps
    std::vector<Interval> intervals_;
    std::vector<std::uint32_t> all_, order_, bins_;
    std::vector<std::uint32_t> slits_;
    std::vector<std::size_t> active_;
    std::vector<Vec2f> points_;
    std::vector<Sample> samples_;
};

}  // namespace ink

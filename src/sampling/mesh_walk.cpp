#include "sampling/mesh_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <variant>

namespace ink {

namespace {

/// The way from one point of the screen to another, as numbers that are linear in a point X of the
/// scene: on which side of the way it lies, how far along, and how deep, the first two times W,
/// the length of a pixel at its depth.
struct Line {
    Vec3d start, side, along, forward;
    double side_at_start, along_at_from;
    double pixel_at_start, pixel_a_depth;  ///< W = pixel_at_start + pixel_a_depth * depth
};

Line line_between(const Projection& projection, Vec2f from, Vec2f to) {
    const Vec2d a = to_double(from - projection.centre);
    const Vec2d d = to_double(to - from);
    const double squared = dot(d, d);
    const Vec2d along{d.x / squared, d.y / squared};
    const double offset = cross(d, a);
    return {projection.start,
            projection.down * d.x - projection.right * d.y -
                projection.forward * (offset * projection.slope_step),
            projection.right * along.x + projection.down * along.y,
            projection.forward,
            -offset * projection.origin_step,
            dot(along, a),
            projection.origin_step,
            projection.slope_step};
}

/// Where a vertex is, seen from a line.
struct Foot {
    double side, along, depth;
    bool above() const { return side >= 0.0; }
};

/// The two ends of an edge.
using Feet = std::array<Foot, 2>;

Foot foot_of(const Line& line, Vec3f vertex) {
    const Vec3d p = to_double(vertex) - line.start;
    return {dot(line.side, p) + line.side_at_start, dot(line.along, p), dot(line.forward, p)};
}

/// Where a line crosses an edge of a mesh.
struct Passage {
    double at;        ///< along the line: 0 at its first point, 1 at its second
    double nearness;  ///< linear on the screen over any plane, larger in front
    double share;     ///< along the edge
    bool in_sight;    ///< not behind the eye
};

/// Between feet on different sides.
Passage passage_between(const Line& line, const Foot& p, const Foot& q) {
    const double share = p.side / (p.side - q.side);
    const double depth = p.depth + share * (q.depth - p.depth);
    const double pixel = line.pixel_at_start + line.pixel_a_depth * depth;
    const double along = p.along + share * (q.along - p.along);
    return {along / pixel - line.along_at_from, line.pixel_a_depth > 0.0 ? 1.0 / pixel : -depth,
            share, pixel > 0.0};
}

/// The triangles that a way crosses, beginning with that which its first point sees.
struct Way {
    enum class End : std::uint8_t {
        unknown,
        arrived,  ///< at the triangle it was to lead to
        beyond,   ///< of what was asked for
        turned,   ///< the surface turns away from the viewer
        rim       ///< the surface ends
    };
    /// A triangle, from where it is entered on. The last step says where the way ends.
    struct Step {
        double at, nearness;
        std::uint32_t triangle;
    };
    static constexpr std::size_t kMostSteps = 64;

    std::array<Step, kMostSteps + 2> steps;
    std::size_t count = 0;
    End end = End::unknown;
    bool backwards = false;  ///< from the line's second point to its first
    /// The sharpest crease on the way.
    double crease_at = 0.0, crease_nearness = 0.0;
    float crease_turn = 0.0F;
    Feet crease{}, last{};  ///< that crease, and the edge at which the way ends

    bool ends() const { return end == End::turned || end == End::rim; }
    double from_start(double along_line) const { return backwards ? 1.0 - along_line : along_line; }

    double end_at() const { return steps[count - 1].at; }
    /// Of walls that are seen edge on, the near end counts.
    double end_nearness() const {
        constexpr double kEdgeOn = 1e-7;
        std::size_t k = count - 1;
        while (k > 1 && steps[k - 1].at >= end_at() - kEdgeOn) --k;
        return steps[k].nearness;
    }
    double nearness(double at) const {
        std::size_t k = 1;
        while (k + 1 < count && steps[k].at < at) ++k;
        const Step& a = steps[k - 1];
        const Step& b = steps[k];
        const double length = b.at - a.at;
        if (!(length > 0.0)) return b.nearness;
        return a.nearness + (b.nearness - a.nearness) * std::clamp((at - a.at) / length, 0.0, 1.0);
    }
};

/// Between two places of a way that are nearer than this, rounding decides; and what a ray hits
/// there, too.
constexpr double kRounding = 1e-7;
constexpr double kRayRounding = 1e-3;

/// What turns by less, as a chord on the unit sphere, is one side of a slit: about 10 degrees.
constexpr float kOneSurface = 0.17F;

/// Walks over one surface along one line.
class Walker {
  public:
    Walker(const Line& line, const MeshWalk::Surface& surface)
        : line_(line), surface_(surface), mesh_(*surface.mesh) {}

    /// From a triangle on which the way begins to `target` if it leads there, but no farther than
    /// `limit`.
    void walk(std::uint32_t triangle, std::uint32_t target, double limit, Way& way) const {
        way.count = 0;
        way.end = Way::End::unknown;
        Hop hop;
        if (!begin(triangle, way, hop)) return;
        double most = hop.passage.at;
        for (;;) {
            if (hop.passage.at >= limit) return finish(Way::End::beyond, hop, most, way);
            const std::uint32_t twin = mesh_.twins[hop.edge];
            if (twin == Mesh::kManyTwins || way.count == Way::kMostSteps) return;
            if (twin == Mesh::kNoTwin) return finish(Way::End::rim, hop, most, way);
            const Hop entered = hop;
            if (!go_through(twin, way, hop)) return;
            if (hop.passage.at < most - kRounding) {
                return finish(Way::End::turned, entered, most, way);
            }
            note_crease(entered, way);
            way.steps[way.count++] = {entered.passage.at, entered.passage.nearness, twin / 3};
            most = std::max(most, hop.passage.at);
            if (twin / 3 == target) return finish(Way::End::arrived, hop, most, way);
        }
    }

  private:
    /// How the way leaves a triangle: by an edge, from its first corner to its second.
    struct Hop {
        std::uint32_t edge = 0;
        Feet feet{};
        Passage passage{};
    };

    Foot foot(std::uint32_t vertex) const { return foot_of(line_, mesh_.vertices[vertex]); }

    Passage passage(const Foot& p, const Foot& q, const Way& way) const {
        Passage result = passage_between(line_, p, q);
        result.at = way.from_start(result.at);
        return result;
    }

    static void finish(Way::End end, const Hop& hop, double at, Way& way) {
        way.steps[way.count++] = {at, hop.passage.nearness, 0};
        way.end = end;
        way.last = hop.feet;
    }

    /// Of the two edges of the first triangle that the line crosses, the way leaves by the later.
    bool begin(std::uint32_t triangle, Way& way, Hop& hop) const {
        const Mesh::Triangle& corners = mesh_.triangles[triangle];
        const std::array<Foot, 3> feet{foot(corners[0]), foot(corners[1]), foot(corners[2])};
        std::array<Hop, 2> hops;
        std::size_t found = 0;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const Foot& p = feet[k];
            const Foot& q = feet[(k + 1) % 3];
            if (p.above() == q.above()) continue;
            hops[found++] = {3 * triangle + k, {p, q}, passage(p, q, way)};
        }
        if (found != 2 || !hops[0].passage.in_sight || !hops[1].passage.in_sight) return false;
        if (hops[1].passage.at < hops[0].passage.at) std::swap(hops[0], hops[1]);
        way.steps[way.count++] = {hops[0].passage.at, hops[0].passage.nearness, triangle};
        hop = hops[1];
        return true;
    }

    /// Through the triangle behind an edge, to the edge it is left by.
    bool go_through(std::uint32_t edge, const Way& way, Hop& hop) const {
        const std::uint32_t first = edge - edge % 3;
        const std::uint32_t after = first + (edge + 1) % 3;
        const std::uint32_t before = first + (edge + 2) % 3;
        const Mesh::Triangle& corners = mesh_.triangles[edge / 3];
        const Mesh::Triangle& left = mesh_.triangles[hop.edge / 3];
        Foot a = hop.feet[1];
        Foot b = hop.feet[0];
        // Seldom do two neighbours run their edge the same way.
        if (corners[edge % 3] == left[hop.edge % 3]) std::swap(a, b);
        const Foot c = foot(corners[before % 3]);
        if (c.above() == b.above()) {
            hop = {before, {c, a}, passage(c, a, way)};
        } else {
            hop = {after, {b, c}, passage(b, c, way)};
        }
        return hop.passage.in_sight;
    }

    void note_crease(const Hop& hop, Way& way) const {
        if (surface_.creases_flagged && !mesh_.is_crease(hop.edge / 3, hop.edge % 3)) return;
        const float turn = turn_across(hop.edge, hop.passage.share);
        if (turn <= way.crease_turn) return;
        way.crease_turn = turn;
        way.crease_at = hop.passage.at;
        way.crease_nearness = hop.passage.nearness;
        way.crease = hop.feet;
    }

    /// How far the normal turns at a place of an edge, as the chord on the unit sphere.
    float turn_across(std::uint32_t edge, double share) const {
        const std::uint32_t twin = mesh_.twins[edge];
        const bool flipped =
            mesh_.triangles[edge / 3][edge % 3] == mesh_.triangles[twin / 3][twin % 3];
        const Vec3f n = normal(edge, share);
        const Vec3f m = normal(twin, flipped ? share : 1.0 - share);
        return length(flipped ? n + m : n - m);
    }

    Vec3f normal(std::uint32_t edge, double share) const {
        const std::uint32_t triangle = edge / 3;
        if (surface_.normals != nullptr) {
            const Vec3f p = unpack_normal(surface_.normals[edge]);
            const Vec3f q = unpack_normal(surface_.normals[3 * triangle + (edge + 1) % 3]);
            const auto s = static_cast<float>(share);
            const Vec3f sum = p * (1.0F - s) + q * s;
            // Opposite normals can cancel.
            if (dot(sum, sum) > 1e-6F) return normalize(sum);
        }
        const Mesh::Triangle& corners = mesh_.triangles[triangle];
        const Vec3d a = to_double(mesh_.vertices[corners[0]]);
        const Vec3d b = to_double(mesh_.vertices[corners[1]]);
        const Vec3d c = to_double(mesh_.vertices[corners[2]]);
        return to_float(normalize(cross(b - a, c - a)));
    }

    const Line& line_;
    const MeshWalk::Surface& surface_;
    const Mesh& mesh_;
};

/// Finds the crossing on one line.
class Crosser {
  public:
    Crosser(const Projection& projection, const std::vector<MeshWalk::Surface>& surfaces,
            Vec2f from, Vec2f to, const MeshChecks& checks, std::vector<SurfaceKey>& expected)
        : projection_(projection),
          surfaces_(surfaces),
          line_(line_between(projection, from, to)),
          from_point_(from),
          to_point_(to),
          from_(to_double(from - projection.centre)),
          step_(to_double(to - from)),
          checks_(checks),
          expected_(expected) {}

    MeshCrossing run(SurfaceKey first, SurfaceKey second) {
        first_ = first;
        second_ = second;
        if (first == second) return along_surface(way_a_);
        const bool same = first.object == second.object;
        way_b_.backwards = true;
        if (first.object != SurfaceKey::kNothing) {
            walk(first, same ? second.primitive : kNoTarget, way_a_);
            if (way_a_.end == Way::End::arrived) return along_surface(way_a_);
            if (way_a_.end == Way::End::unknown) return {};
            if (second.object == SurfaceKey::kNothing) return before_background(way_a_, true);
        }
        walk(second, same ? first.primitive : kNoTarget, way_b_);
        if (way_b_.end == Way::End::arrived) return along_surface(way_b_);
        if (way_b_.end == Way::End::unknown) return {};
        if (first.object == SurfaceKey::kNothing) return before_background(way_b_, false);
        return between_surfaces();
    }

  private:
    static constexpr std::uint32_t kNoTarget = 0xFFFFFFFFU;

    void walk(SurfaceKey from, std::uint32_t target, Way& way) const {
        // A ray may hit a triangle a little beside it.
        constexpr double kSlack = 1e-3;
        Walker(line_, surfaces_[from.object]).walk(from.primitive, target, 1.0 + kSlack, way);
    }

    MeshCrossing along_surface(const Way& way) {
        MeshCrossing crossing;
        crossing.kind = MeshCrossing::Kind::smooth;
        if (way.crease_turn > 0.0F) {
            crossing.kind = MeshCrossing::Kind::crease;
            crossing.turn = way.crease_turn;
            place(way.from_start(way.crease_at), way.crease_nearness, crossing);
            // What an end sees in a slit does not go on to where the check goes.
            const bool second = crossing.at > 0.5;
            check_past(second, way.crease, second ? second_ : first_, crossing);
        }
        return crossing;
    }

    MeshCrossing before_background(const Way& way, bool first) {
        if (!way.ends() || way.end_at() <= 0.0 || way.end_at() >= 1.0) return {};
        return limb(way, first, nullptr);
    }

    MeshCrossing between_surfaces() {
        const double low = way_b_.ends() ? std::max(1.0 - way_b_.end_at(), 0.0) : 0.0;
        const double high = way_a_.ends() ? std::min(way_a_.end_at(), 1.0) : 1.0;
        if (low > high) return {};  // something else is seen between them
        const double at_low = lead(low);
        const double at_high = lead(high);
        if (at_low >= 0.0 && at_high >= 0.0 && high < 1.0) return limb(way_a_, true, &way_b_);
        if (at_low <= 0.0 && at_high <= 0.0 && low > 0.0) return limb(way_b_, false, &way_a_);
        if (at_low > 0.0 && at_high < 0.0) return seam(low, high);
        return {};
    }

    /// By how much the first surface is nearer.
    double lead(double at) const { return nearness(way_a_, at) - nearness(way_b_, 1.0 - at); }
    static double nearness(const Way& way, double at) {
        return way.ends() && at >= way.end_at() ? way.end_nearness() : way.nearness(at);
    }

    MeshCrossing limb(const Way& way, bool first, const Way* behind) {
        MeshCrossing crossing;
        crossing.kind = first ? MeshCrossing::Kind::first_limb : MeshCrossing::Kind::second_limb;
        crossing.at_rim = way.end == Way::End::rim;
        place(way.from_start(way.end_at()), way.end_nearness(), crossing);
        if (behind != nullptr) {
            const double other = behind->nearness(1.0 - way.end_at());
            crossing.gap = static_cast<float>((depth_of(other) - depth_of(way.end_nearness())) *
                                              stretch(crossing.at));
        }
        add_check(way, first, behind, crossing);
        return crossing;
    }

    /// Where the lead changes its sign: it is linear between the steps of both ways.
    MeshCrossing seam(double low, double high) {
        const auto narrow = [&](double at) {
            if (at > low && at < high) (lead(at) > 0.0 ? low : high) = at;
        };
        for (std::size_t k = 1; k < way_a_.count; ++k) narrow(way_a_.steps[k].at);
        for (std::size_t k = way_b_.count; k-- > 1;) narrow(1.0 - way_b_.steps[k].at);
        const double at_low = lead(low);
        const double share = at_low / (at_low - lead(high));
        MeshCrossing crossing;
        crossing.kind = MeshCrossing::Kind::seam;
        const double at = low + share * (high - low);
        place(at, nearness(way_a_, at), crossing);
        begin_check(at, crossing);
        expect(first_.object, way_a_, at);
        expect(second_.object, way_b_, 1.0 - at);
        end_check(crossing);
        return crossing;
    }

    /// Beside a limb, what is behind it should be seen.
    void add_check(const Way& way, bool first, const Way* behind, MeshCrossing& crossing) {
        const SurfaceKey far = first ? second_ : first_;
        if (check_past(first, way.last, far, crossing)) {
            crossing.unless_object = (first ? first_ : second_).object;
            return;
        }
        const double at = way.end_at() + (crossing.at_rim ? checks_.slit : checks_.offset);
        begin_check(way.from_start(at), crossing);
        if (behind == nullptr) {
            expected_.push_back({});
        } else {
            expect(far.object, *behind, 1.0 - at);
        }
        end_check(crossing);
    }

    /// Where an end of the way is so near to a line along `edge` that it may look into a slit: past
    /// that end, the surface that it sees must go on, without a crease. False where it is not.
    bool check_past(bool second, const Feet& edge, SurfaceKey end, MeshCrossing& crossing) {
        const Vec2d way = second ? step_ : step_ * -1.0;
        const Vec2d away = normal_of(edge, way);
        const double size = length(step_);
        const double left = second ? 1.0 - crossing.at : crossing.at;
        if (left * dot(away, way) >= checks_.slit * size) return false;

        const Vec2f from = second ? to_point_ : from_point_;
        const Vec2d past = way * -left + away * (checks_.slit * size);  // from that end on
        crossing.needs_check = true;
        crossing.in_slit = second ? MeshCrossing::InSlit::second : MeshCrossing::InSlit::first;
        crossing.checked = from + Vec2f{static_cast<float>(past.x), static_cast<float>(past.y)};
        crossing.first_expected = static_cast<std::uint32_t>(expected_.size());
        if (end.object == SurfaceKey::kNothing) {
            expected_.push_back({});
        } else {
            const double slack = kRayRounding * size / std::max(length(past), 1e-3 * size);
            Way on;
            Walker(line_between(projection_, from, crossing.checked), surfaces_[end.object])
                .walk(end.primitive, kNoTarget, 1.0 + slack, on);
            if (on.crease_turn < kOneSurface) expect(end.object, on, 1.0, slack);
        }
        end_check(crossing);
        return true;
    }

    /// Of an edge on the screen, a unit vector, to the side to which `way` leads.
    Vec2d normal_of(const Feet& edge, Vec2d way) const {
        const auto place = [&](const Foot& foot) {
            const double pixel = line_.pixel_at_start + line_.pixel_a_depth * foot.depth;
            return Vec2d{foot.along / pixel, foot.side / pixel / dot(step_, step_)};
        };
        const Vec2d p = place(edge[0]);
        const Vec2d q = place(edge[1]);
        const Vec2d along = step_ * (q.x - p.x) + Vec2d{-step_.y, step_.x} * (q.y - p.y);
        const double size = length(along);
        // A corner behind the eye is nowhere on the screen.
        const bool known = size > 0.0 && std::isfinite(size);
        const Vec2d normal =
            known ? Vec2d{-along.y, along.x} * (1.0 / size) : way * (1.0 / length(way));
        return dot(normal, way) < 0.0 ? normal * -1.0 : normal;
    }

    void begin_check(double at, MeshCrossing& crossing) const {
        crossing.needs_check = true;
        crossing.checked_at = static_cast<float>(at);
        crossing.checked = from_point_ + (to_point_ - from_point_) * crossing.checked_at;
        crossing.first_expected = static_cast<std::uint32_t>(expected_.size());
    }
    void end_check(MeshCrossing& crossing) const {
        crossing.expected = static_cast<std::uint32_t>(expected_.size()) - crossing.first_expected;
    }

    /// The triangles that a ray at this place of a way may hit.
    void expect(std::uint32_t object, const Way& way, double at, double slack = kRayRounding) {
        for (std::size_t k = 0; k + 1 < way.count; ++k) {
            if (way.steps[k].at - slack <= at && at <= way.steps[k + 1].at + slack) {
                expected_.push_back({object, way.steps[k].triangle});
            }
        }
    }

    double depth_of(double nearness) const {
        return projection_.orthographic()
                   ? -nearness
                   : (1.0 / nearness - projection_.origin_step) / projection_.slope_step;
    }

    /// How much longer the ray through a place is than its depth.
    double stretch(double at) const {
        const double x = (from_.x + step_.x * at) * projection_.slope_step;
        const double y = (from_.y + step_.y * at) * projection_.slope_step;
        return std::sqrt(1.0 + x * x + y * y);
    }

    void place(double at, double nearness, MeshCrossing& crossing) const {
        const double depth = depth_of(nearness);
        crossing.at = std::clamp(at, 0.0, 1.0);
        crossing.t = static_cast<float>(depth * stretch(at));
        crossing.footprint =
            static_cast<float>(projection_.origin_step + projection_.slope_step * depth);
    }

    const Projection& projection_;
    const std::vector<MeshWalk::Surface>& surfaces_;
    Line line_;
    Vec2f from_point_, to_point_;
    Vec2d from_, step_;
    MeshChecks checks_;
    std::vector<SurfaceKey>& expected_;
    SurfaceKey first_, second_;
    Way way_a_, way_b_;
};

}  // namespace

MeshWalk::MeshWalk(const Scene& scene, const Projection& projection, NormalSource normals)
    : projection_(projection), surfaces_(scene.objects().size()) {
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
        const Object& object = scene.objects()[k];
        const auto* mesh = std::get_if<Mesh>(&object.shape);
        if (mesh == nullptr || mesh->twins.empty() || mesh->edge_flags.empty()) continue;
        Surface& surface = surfaces_[k];
        surface.mesh = mesh;
        // As Shader::line_normals.
        const NormalSource source = object.normals.value_or(normals);
        const bool own = source == NormalSource::automatic && !mesh->line_normals.empty();
        const auto& corners = own ? mesh->line_normals : mesh->corner_normals;
        if (source != NormalSource::geometric && !corners.empty()) {
            surface.normals = corners[0].data();
        }
        // Normals of a file may be discontinuous anywhere.
        surface.creases_flagged = surface.normals != nullptr && (own || mesh->line_normals.empty());
    }
}

MeshCrossing MeshWalk::cross(Vec2f from, SurfaceKey first, Vec2f to, SurfaceKey second,
                             const MeshChecks& checks, std::vector<SurfaceKey>& expected) const {
    return Crosser(projection_, surfaces_, from, to, checks, expected).run(first, second);
}

}  // namespace ink

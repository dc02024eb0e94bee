#include "lines/predict.h"

#include <algorithm>
#include <cmath>

namespace ink {

namespace {

/// Not of unit length: what is asked of a ray mostly does not depend on it, and roots cost more
/// than all the rest.
struct Ray {
    Vec3d origin, direction;

    double length() const { return std::sqrt(dot(direction, direction)); }
};

/// The rays through the points of a lattice edge, s in [0, 1] along it. Double precision: the
/// square of a distance across a small sphere is the difference of two large squares.
class EdgeRays {
  public:
    EdgeRays(const Viewpoint& viewpoint, Vec2f a, Vec2f b)
        : origin_(viewpoint.origin(a)),
          origin_step_(viewpoint.origin(b) - origin_),
          direction_(viewpoint.direction(a)),
          direction_step_(viewpoint.direction(b) - direction_) {}

    Ray at(double s) const {
        return {origin_ + origin_step_ * s, direction_ + direction_step_ * s};
    }
    /// Length of the edge on a surface across the rays at distance t, squared; `length` is that of
    /// the first ray.
    double squared_length(double t, double length) const {
        const Vec3d step = origin_step_ + direction_step_ * (t / length);
        return dot(step, step);
    }

  private:
    Vec3d origin_, origin_step_, direction_, direction_step_;
};

/// How a ray passes a sphere. L is the length of the ray's direction.
struct Passage {
    double nearest;  ///< distance along the ray to the point nearest to the centre, times L
    double inside;   ///< radius squared less the distance squared there, times L^2: < 0 on a miss

    /// Distance to where it enters, times L.
    double entry() const { return nearest - std::sqrt(std::max(inside, 0.0)); }
};

/// Where a parabola with these values at 0, 1/2 and 1 is zero; NaN where it is not.
struct ParabolaRoots {
    double first, second;

    ParabolaRoots(double at_0, double middle, double at_1) {
        const double b = 4.0 * middle - 3.0 * at_0 - at_1;
        const double a = at_1 - at_0 - b;
        // Without cancellation.
        const double q = -0.5 * (b + std::copysign(std::sqrt(b * b - 4.0 * a * at_0), b));
        first = q != 0.0 ? at_0 / q : 0.0;
        second = a != 0.0 ? q / a : first;
    }
};

struct BallOnEdge {
    Vec3d centre;
    double radius;

    explicit BallOnEdge(const Ball& ball) : centre(to_double(ball.centre)), radius(ball.radius) {}

    Passage at(const Ray& ray) const {
        const Vec3d to_centre = centre - ray.origin;
        const Vec3d across = cross(to_centre, ray.direction);
        return {dot(to_centre, ray.direction),
                radius * radius * dot(ray.direction, ray.direction) - dot(across, across)};
    }

    /// Whether it is the ball's outer side that a sample on this ray, of that length, saw.
    bool shows(const Passage& passage, const Sample& sample, double length) const {
        constexpr double kRounding = 1e-3;  // of the radius
        return passage.inside > 0.0 &&
               sample.t * length < passage.nearest + kRounding * radius * length;
    }

    /// Where `inside` passes through zero, given its values of different sign at 0 and 1. Over a
    /// lattice edge it is a parabola, but for the fan of the rays, which bends it by less than a
    /// millionth.
    double contour(const EdgeRays& rays, double at_0, double at_1) const {
        const ParabolaRoots roots(at_0, at(rays.at(0.5)).inside, at_1);
        const bool is_first = !(std::abs(roots.first - 0.5) > std::abs(roots.second - 0.5));
        return std::clamp(is_first ? roots.first : roots.second, 0.0, 1.0);
    }
};
/// Zero of the difference of two depths between `low`, where it is `at_low` < 0, and `high`: false
/// position with the Illinois rule (Dowell and Jarratt 1971).
double find_seam(const EdgeRays& rays, const BallOnEdge& a, const BallOnEdge& b, double low,
                 double at_low, double high, double at_high) {
    constexpr int kMostSteps = 16;
    constexpr double kPrecise = 1e-3;  // of a lattice edge
    double s = 0.5 * (low + high);
    for (int step = 0; step < kMostSteps && high - low > kPrecise; ++step) {
        const double before = s;
        s = (low * at_high - high * at_low) / (at_high - at_low);
        const Ray ray = rays.at(s);
        const double at_s = a.at(ray).entry() - b.at(ray).entry();
        if (at_s < 0.0) {
            low = s;
            at_low = at_s;
            at_high *= 0.5;
        } else {
            high = s;
            at_high = at_s;
            at_low *= 0.5;
        }
        if (step > 0 && std::abs(s - before) < 0.5 * kPrecise) break;
    }
    return s;
}

/// Where two balls meet, both of which the rays enter from `begin` to `end`: there the difference
/// of their depths passes from below zero, `before`, to above, `after`.
double seam(const EdgeRays& rays, const BallOnEdge& a, const BallOnEdge& b, double begin,
            double before, double end, double after) {
    // They meet in the plane normal . (x - centre of a) = height. Zero where the ray meets the
    // plane on the sphere; like `inside` a parabola over the edge.
    const Vec3d normal = b.centre - a.centre;
    const double height = 0.5 * (dot(normal, normal) + a.radius * a.radius - b.radius * b.radius);
    const auto off_sphere = [&](double way) {
        const Ray ray = rays.at(begin + way * (end - begin));
        const Vec3d from_centre = ray.origin - a.centre;
        const double fall = dot(normal, ray.direction);
        const Vec3d at_plane =
            from_centre * fall + ray.direction * (height - dot(normal, from_centre));
        return dot(at_plane, at_plane) - a.radius * a.radius * fall * fall;
    };
    const ParabolaRoots roots(off_sphere(0.0), off_sphere(0.5), off_sphere(1.0));
    const auto within = [](double root) { return root >= 0.0 && root <= 1.0; };
    // Where both are, one of them is where the rays leave the spheres.
    if (within(roots.first) == within(roots.second)) {
        return find_seam(rays, a, b, begin, before, end, after);
    }
    return begin + (end - begin) * (within(roots.first) ? roots.first : roots.second);
}

}  // namespace

std::optional<Prediction> predict_crossing(const Viewpoint& viewpoint, Vec2f a, const Sample& at_a,
                                           Vec2f b, const Sample& at_b) {
    using Kind = Prediction::Kind;
    const bool first = at_a.id != kBackground;
    const bool second = at_b.id != kBackground;
    if ((first && !at_a.ball) || (second && !at_b.ball) || (!first && !second)) return {};
    const EdgeRays rays(viewpoint, a, b);
    const BallOnEdge ball_a(at_a.ball);
    const BallOnEdge ball_b(at_b.ball);
    const Ray ray_0 = rays.at(0.0);
    const Ray ray_1 = rays.at(1.0);
    const double length_0 = ray_0.length();
    const double length_1 = ray_1.length();
    const auto found = [&](Kind kind, double at, double t) {
        const double smaller = !second  ? ball_a.radius
                               : !first ? ball_b.radius
                                        : std::min(ball_a.radius, ball_b.radius);
        const double squared_radius = smaller * smaller / rays.squared_length(t, length_0);
        return Prediction{kind, static_cast<float>(at), static_cast<float>(t),
                          static_cast<float>(squared_radius)};
    };

    // Whether each surface is there at both ends, and where it ends if not.
    const Passage a_0 = first ? ball_a.at(ray_0) : Passage{};
    const Passage a_1 = first ? ball_a.at(ray_1) : Passage{};
    const Passage b_0 = second ? ball_b.at(ray_0) : Passage{};
    const Passage b_1 = second ? ball_b.at(ray_1) : Passage{};
    if ((first && !ball_a.shows(a_0, at_a, length_0)) ||
        (second && !ball_b.shows(b_1, at_b, length_1))) {
        return {};
    }
    const bool a_ends = first && a_1.inside <= 0.0;
    const bool b_begins = second && b_0.inside <= 0.0;
    if ((!second && !a_ends) || (!first && !b_begins)) return {};
    const double end = a_ends ? ball_a.contour(rays, a_0.inside, a_1.inside) : 1.0;
    const double begin = b_begins ? ball_b.contour(rays, b_0.inside, b_1.inside) : 0.0;
    const auto contour_t = [&](const BallOnEdge& ball, double s) {
        const Ray ray = rays.at(s);
        return ball.at(ray).nearest / ray.length();
    };
    const auto entry = [&](const BallOnEdge& ball, double s) {
        const Ray ray = rays.at(s);
        return ball.at(ray).entry() / ray.length();
    };

    if (!second) return found(Kind::first_contour, end, contour_t(ball_a, end));
    if (!first) return found(Kind::second_contour, begin, contour_t(ball_b, begin));
    if (end < begin) {
        const double middle = 0.5 * (end + begin);
        return found(Kind::gap, middle,
                     std::min(contour_t(ball_a, middle), contour_t(ball_b, middle)));
    }

    double before = a_0.entry() - b_0.entry();  // negative while the first is in front
    if (b_begins) {
        const double t = contour_t(ball_b, begin);
        before = entry(ball_a, begin) - t;
        if (before >= 0.0) return found(Kind::second_contour, begin, t);
    }
    double after = a_1.entry() - b_1.entry();
    if (a_ends) {
        const double t = contour_t(ball_a, end);
        after = t - entry(ball_b, end);
        if (after <= 0.0) return found(Kind::first_contour, end, t);
    }
    if (before >= 0.0 || after <= 0.0) return {};
    const double at = seam(rays, ball_a, ball_b, begin, before, end, after);
    return found(Kind::seam, at, entry(ball_a, at));
}

float seam_angle(const Viewpoint& viewpoint, Vec2f point, float t, const Ball& a, const Ball& b) {
    const Vec3d at =
        viewpoint.origin(point) + normalize(viewpoint.direction(point)) * static_cast<double>(t);
    const double cosine = dot(at - to_double(a.centre), at - to_double(b.centre)) /
                          (static_cast<double>(a.radius) * static_cast<double>(b.radius));
    return static_cast<float>(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

}  // namespace ink

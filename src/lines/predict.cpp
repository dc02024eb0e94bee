#include "lines/predict.h"

#include <algorithm>
#include <cmath>

namespace ink {

namespace {

struct Ray {
    Vec3d origin, direction;  ///< unit
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
        return {origin_ + origin_step_ * s, normalize(direction_ + direction_step_ * s)};
    }
    /// Length of the edge on a surface across the rays at distance t, squared.
    double squared_length(double t) const {
        const Vec3d step = origin_step_ + direction_step_ * (t / length(direction_));
        return dot(step, step);
    }

  private:
    Vec3d origin_, origin_step_, direction_, direction_step_;
};

/// How a ray passes a sphere.
struct Passage {
    double nearest;  ///< distance along the ray to the point nearest to the centre
    double inside;   ///< radius squared less the distance squared there: negative on a miss

    double entry() const { return nearest - std::sqrt(std::max(inside, 0.0)); }
};

struct BallOnEdge {
    Vec3d centre;
    double radius;

    explicit BallOnEdge(const Ball& ball) : centre(to_double(ball.centre)), radius(ball.radius) {}

    Passage at(const Ray& ray) const {
        const Vec3d to_centre = centre - ray.origin;
        const double along = dot(to_centre, ray.direction);
        const Vec3d across = to_centre - ray.direction * along;
        return {along, radius * radius - dot(across, across)};
    }

    /// Whether it is the ball's outer side that a sample on this ray saw.
    bool shows(const Passage& passage, const Sample& sample) const {
        constexpr double kRounding = 1e-3;  // of the radius
        return passage.inside > 0.0 && sample.t < passage.nearest + kRounding * radius;
    }

    /// Where `inside` passes through zero, given its values of different sign at 0 and 1. Over a
    /// lattice edge it is a parabola, but for the fan of the rays, which bends it by less than a
    /// millionth.
    double limb(const EdgeRays& rays, double at_0, double at_1) const {
        const double middle = at(rays.at(0.5)).inside;
        const double b = 4.0 * middle - 3.0 * at_0 - at_1;
        const double a = at_1 - at_0 - b;
        const double root = std::sqrt(std::max(b * b - 4.0 * a * at_0, 0.0));
        // The one of the two roots that lies in the interval, without cancellation.
        const double q = -0.5 * (b + std::copysign(root, b));
        const double first = q != 0.0 ? at_0 / q : 0.0;
        const double second = a != 0.0 ? q / a : first;
        const double s = std::abs(first - 0.5) <= std::abs(second - 0.5) ? first : second;
        return std::clamp(s, 0.0, 1.0);
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
    const auto found = [&](Kind kind, double at, double t) {
        const double smaller = !second  ? ball_a.radius
                               : !first ? ball_b.radius
                                        : std::min(ball_a.radius, ball_b.radius);
        const double squared_radius = smaller * smaller / rays.squared_length(t);
        return Prediction{kind, static_cast<float>(at), static_cast<float>(t),
                          static_cast<float>(squared_radius)};
    };

    // Whether each surface is there at both ends, and where it ends if not.
    const Ray ray_0 = rays.at(0.0);
    const Ray ray_1 = rays.at(1.0);
    const Passage a_0 = first ? ball_a.at(ray_0) : Passage{};
    const Passage a_1 = first ? ball_a.at(ray_1) : Passage{};
    const Passage b_0 = second ? ball_b.at(ray_0) : Passage{};
    const Passage b_1 = second ? ball_b.at(ray_1) : Passage{};
    if ((first && !ball_a.shows(a_0, at_a)) || (second && !ball_b.shows(b_1, at_b))) return {};
    const bool a_ends = first && a_1.inside <= 0.0;
    const bool b_begins = second && b_0.inside <= 0.0;
    if ((!second && !a_ends) || (!first && !b_begins)) return {};
    const double end = a_ends ? ball_a.limb(rays, a_0.inside, a_1.inside) : 1.0;
    const double begin = b_begins ? ball_b.limb(rays, b_0.inside, b_1.inside) : 0.0;
    // Along an edge of a pixel the nearest point of a passing ray hardly moves in depth.
    const auto limb_t = [](double s, const Passage& at_0, const Passage& at_1) {
        return at_0.nearest + s * (at_1.nearest - at_0.nearest);
    };

    if (!second) return found(Kind::first_limb, end, limb_t(end, a_0, a_1));
    if (!first) return found(Kind::second_limb, begin, limb_t(begin, b_0, b_1));
    if (end < begin) {
        return found(Kind::gap, 0.5 * (end + begin), std::min(a_0.nearest, b_1.nearest));
    }

    double before = a_0.entry() - b_0.entry();  // negative while the first is in front
    if (b_begins) {
        const double t = limb_t(begin, b_0, b_1);
        before = ball_a.at(rays.at(begin)).entry() - t;
        if (before >= 0.0) return found(Kind::second_limb, begin, t);
    }
    double after = a_1.entry() - b_1.entry();
    if (a_ends) {
        const double t = limb_t(end, a_0, a_1);
        after = t - ball_b.at(rays.at(end)).entry();
        if (after <= 0.0) return found(Kind::first_limb, end, t);
    }
    if (before >= 0.0 || after <= 0.0) return {};
    const double seam = find_seam(rays, ball_a, ball_b, begin, before, end, after);
    return found(Kind::seam, seam, ball_a.at(rays.at(seam)).entry());
}

float seam_angle(const Viewpoint& viewpoint, Vec2f point, float t, const Ball& a, const Ball& b) {
    const Vec3d at =
        viewpoint.origin(point) + normalize(viewpoint.direction(point)) * static_cast<double>(t);
    const double cosine = dot(at - to_double(a.centre), at - to_double(b.centre)) /
                          (static_cast<double>(a.radius) * static_cast<double>(b.radius));
    return static_cast<float>(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

}  // namespace ink

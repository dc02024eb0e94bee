#include "io/triangulate.h"

#include <cmath>
#include <cstddef>
#include <numeric>

namespace ink {

namespace {

/// Point-in-ear tests before a polygon is given up: about a second.
constexpr std::size_t kMostTests = 200'000'000;

struct Point {
    double x = 0.0, y = 0.0;
    friend bool operator==(Point, Point) = default;
};

/// Twice the signed area; positive: counter-clockwise.
double turn(Point a, Point b, Point c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell's normal: right for concave and slightly bent polygons, too.
Vec3d mean_normal(std::span<const Vec3f> corners) {
    const Vec3d origin = to_double(corners[0]);
    Vec3d sum;
    for (std::size_t i = 2; i < corners.size(); ++i) {
        sum = sum + cross(to_double(corners[i - 1]) - origin, to_double(corners[i]) - origin);
    }
    return sum;
}

/// Drops the coordinate along which the polygon is seen best; the outline comes out
/// counter-clockwise.
std::vector<Point> flatten(std::span<const Vec3f> corners) {
    const Vec3d normal = mean_normal(corners);
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    std::vector<Point> points;
    points.reserve(corners.size());
    for (const Vec3f& c : corners) {
        if (z >= x && z >= y) {
            points.push_back(normal.z >= 0.0 ? Point{c.x, c.y} : Point{c.y, c.x});
        } else if (x >= y) {
            points.push_back(normal.x >= 0.0 ? Point{c.y, c.z} : Point{c.z, c.y});
        } else {
            points.push_back(normal.y >= 0.0 ? Point{c.z, c.x} : Point{c.x, c.z});
        }
    }
    return points;
}

bool first_corner_sees_all(const std::vector<Point>& points) {
    for (std::size_t i = 2; i < points.size(); ++i) {
        if (!(turn(points[0], points[i - 1], points[i]) > 0.0)) return false;
    }
    return true;
}

class EarClipper {
  public:
    explicit EarClipper(const std::vector<Point>& points) : points_(points), rest_(points.size()) {
        std::iota(rest_.begin(), rest_.end(), 0u);
    }

    /// False when the work runs out.
    bool clip(std::vector<std::array<std::uint32_t, 3>>& triangles) {
        std::size_t at = 0;
        while (rest_.size() > 3) {
            at = next_ear(at);
            if (tests_ > kMostTests) return false;
            const auto [before, ear, after] = ear_at(at);
            triangles.push_back({before, ear, after});
            rest_.erase(rest_.begin() + static_cast<std::ptrdiff_t>(at));
            // Skipping one corner keeps the triangles from forming a fan of slivers.
            at = (at + 1) % rest_.size();
        }
        triangles.push_back({rest_[0], rest_[1], rest_[2]});
        return true;
    }

  private:
    std::array<std::uint32_t, 3> ear_at(std::size_t at) const {
        const std::size_t n = rest_.size();
        return {rest_[(at + n - 1) % n], rest_[at], rest_[(at + 1) % n]};
    }

    /// The next place from `start` on that can be cut off. An outline that crosses itself may have
    /// none: then any, so that every corner is used and the work ends.
    std::size_t next_ear(std::size_t start) {
        for (std::size_t i = 0; i < rest_.size(); ++i) {
            const std::size_t at = (start + i) % rest_.size();
            if (is_ear(at)) return at;
        }
        return start;
    }

    bool is_ear(std::size_t at) {
        const auto [ia, ib, ic] = ear_at(at);
        const Point a = points_[ia], b = points_[ib], c = points_[ic];
        if (!(turn(a, b, c) > 0.0)) return false;
        tests_ += rest_.size();
        for (const std::uint32_t i : rest_) {
            const Point p = points_[i];
            // Where a cut joins a hole to the outline, two corners share a place.
            if (p == a || p == b || p == c) continue;
            if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
        }
        return true;
    }

    const std::vector<Point>& points_;
    std::vector<std::uint32_t> rest_;  ///< corners not cut off yet
    std::size_t tests_ = 0;
};

}  // namespace

bool triangulate(std::span<const Vec3f> corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
    if (corners.size() == 3) {
        triangles.push_back({0, 1, 2});
        return true;
    }
    const std::vector<Point> points = flatten(corners);
    if (first_corner_sees_all(points)) {
        for (std::uint32_t i = 2; i < corners.size(); ++i) triangles.push_back({0, i - 1, i});
        return true;
    }
    const std::size_t before = triangles.size();
    if (EarClipper(points).clip(triangles)) return true;
    triangles.resize(before);
    return false;
}

}  // namespace ink

#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "lines/connect.h"
#include "lines/detect.h"
#include "lines/ink.h"
#include "lines/locate.h"

/// Invented worlds, the search for their lines, and what is checked of them.
namespace ink::test {

inline constexpr double kDegrees = std::numbers::pi / 180.0;

// Invented worlds: surfaces seen from straight above, in pixels. x right, y down as on the screen,
// z towards the viewer. Normals are those of the scene's frame, where y points up.

struct Hit {
    double z;
    Vec3d normal;
    double radius = 0.0;  ///< of the sphere, if it is one
    Vec3d centre{};
    Vec3d facet{};  ///< geometric normal, if that is another one
};

struct Surface {
    GeometryId id;
    std::function<std::optional<Hit>(double x, double y)> at;
};

struct World {
    std::vector<Surface> surfaces;
    double unit = 1.0 / 64;    ///< of the scene's frame, in which the scene has a size of about 1
    bool knows_balls = false;  ///< samples say which sphere they lie on

    /// With facets as for further samples; a grid keeps none.
    Sample operator()(Vec2f p) const {
        Sample sample;
        double nearest = -1e30;
        for (const Surface& surface : surfaces) {
            const auto hit = surface.at(p.x, p.y);
            if (!hit || hit->z <= nearest) continue;
            nearest = hit->z;
            sample = {surface.id, to_float(Vec3d{p.x, -p.y, hit->z} * unit),
                      to_float(normalize(hit->normal)),
                      static_cast<float>((2.0 / unit - hit->z) * unit)};
            if (hit->facet.z > 0.0) sample.facet = to_float(normalize(hit->facet));
            if (knows_balls && hit->radius > 0.0) {
                sample.ball = {to_float(Vec3d{hit->centre.x, -hit->centre.y, hit->centre.z} * unit),
                               static_cast<float>(hit->radius * unit)};
            }
        }
        return sample;
    }
};

using Region = std::function<bool(double x, double y)>;

inline Surface flat(GeometryId id, double z, Region region) {
    return {id, [=](double x, double y) -> std::optional<Hit> {
                if (!region(x, y)) return std::nullopt;
                return Hit{z, {0, 0, 1}};
            }};
}

/// The points on the left of a line, seen along it, at `angle_deg` clockwise from the x axis.
inline Region beside(double angle_deg, Vec3d through) {
    const double nx = std::sin(angle_deg * kDegrees);
    const double ny = -std::cos(angle_deg * kDegrees);
    return [=](double x, double y) { return (x - through.x) * nx + (y - through.y) * ny > 0.0; };
}

inline Region disc(Vec3d c, double r) {
    return [=](double x, double y) { return std::hypot(x - c.x, y - c.y) < r; };
}

inline Region everywhere() {
    return [](double, double) { return true; };
}

inline Surface sphere(GeometryId id, Vec3d c, double r) {
    return {id, [=](double x, double y) -> std::optional<Hit> {
                const double dx = x - c.x;
                const double dy = y - c.y;
                const double rest = r * r - dx * dx - dy * dy;
                if (rest <= 0.0) return std::nullopt;
                const double z = std::sqrt(rest);
                return Hit{c.z + z, {dx, -dy, z}, r, c};
            }};
}

/// The plane through `c` with a normal in the scene's frame, normal.z > 0.
inline Surface plane(GeometryId id, Vec3d c, Vec3d normal) {
    return {id, [=](double x, double y) -> std::optional<Hit> {
                return Hit{c.z - (normal.x * (x - c.x) - normal.y * (y - c.y)) / normal.z, normal};
            }};
}

/// One surface that shows the lower of two: an edge that sticks out.
inline Surface lower(const Surface& a, const Surface& b) {
    return {a.id, [=](double x, double y) {
                const auto p = a.at(x, y);
                const auto q = b.at(x, y);
                return p->z < q->z ? p : q;
            }};
}

/// A torus whose axis leans by `tilt_deg` from the direction of sight, found by marching.
inline Surface torus(GeometryId id, Vec3d c, double ring, double tube, double tilt_deg) {
    const double cosine = std::cos(tilt_deg * kDegrees);
    const double sine = std::sin(tilt_deg * kDegrees);
    return {
        id, [=](double x, double y) -> std::optional<Hit> {
            const auto local = [&](double z) {
                const Vec3d p{x - c.x, -(y - c.y), z};
                return Vec3d{p.x, cosine * p.y + sine * p.z, cosine * p.z - sine * p.y};
            };
            const double reach = ring + tube;
            double z = reach * 1.01;
            for (int step = 0; step < 20000 && z > -reach; ++step) {
                const Vec3d p = local(z);
                const double radial = std::hypot(p.x, p.y);
                const double distance = std::hypot(radial - ring, p.z) - tube;
                if (distance < 1e-7 * reach) {
                    const double spoke = (radial - ring) / radial;
                    const Vec3d n{p.x * spoke, p.y * spoke, p.z};
                    const Vec3d turned{n.x, cosine * n.y - sine * n.z, sine * n.y + cosine * n.z};
                    return Hit{c.z + z, turned.z < 0.0 ? -turned : turned};
                }
                // A ray that grazes the surface nears it in ever smaller steps.
                z -= std::max(distance, 1e-6 * reach);
            }
            return std::nullopt;
        }};
}

// Finding lines

struct Found {
    SampleGrid grid;
    std::vector<SuspectEdge> suspects;
    std::vector<Crossing> crossings;
    std::vector<Segment> segments;
    std::size_t samples = 0;  ///< beyond the lattice
};

inline constexpr int kSide = 48;  ///< of a tile, pixels

/// How worlds are seen: straight down, in parallel, pixels of side `unit`.
inline Viewpoint viewpoint_of(double unit) {
    Viewpoint viewpoint;
    viewpoint.dir = {0, 0, -1};
    viewpoint.parallel = true;
    viewpoint.origin = {{0, 0, 2}, {unit, 0, 0}, {0, -unit, 0}};
    viewpoint.direction = {{0, 0, -1}, {}, {}};
    return viewpoint;
}

/// Searches `columns` x `rows` points of a lattice of q x q a pixel, from point (i0, j0) on.
inline Found search(const World& world, int q, int i0, int j0, int columns, int rows) {
    Found found;
    SampleGrid& grid = found.grid;
    grid.x0 = i0;
    grid.y0 = j0;
    grid.spacing = 1.0F / static_cast<float>(q);
    grid.resize(columns, rows);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const Sample sample = world(grid.point(i, j));
            const std::size_t k = grid.index(i, j);
            grid.id[k] = sample.id;
            grid.px[k] = sample.position.x;
            grid.py[k] = sample.position.y;
            grid.pz[k] = sample.position.z;
            grid.nx[k] = sample.normal.x;
            grid.ny[k] = sample.normal.y;
            grid.nz[k] = sample.normal.z;
            grid.t[k] = sample.t;
        }
    }
    const Viewpoint viewpoint = viewpoint_of(world.unit);
    const SurfaceFunction describe = [&](std::size_t k, Sample& sample) {
        const auto width = static_cast<std::size_t>(columns);
        const Sample whole =
            world(grid.point(static_cast<int>(k % width), static_cast<int>(k / width)));
        sample.ball = whole.ball;
        sample.facet = whole.facet;
    };
    const DetectSettings detection;
    detect(grid, detection, found.suspects);
    Locator locator(viewpoint, LocateSettings{});
    locator.locate(
        grid, found.suspects, describe,
        [&](std::span<const Vec2f> points, std::span<Sample> out) {
            found.samples += points.size();
            std::ranges::transform(points, out.begin(), world);
        },
        found.crossings);
    Connector().connect(grid, found.suspects, found.crossings, found.segments);
    return found;
}

inline Found search(const World& world, int q, int side = kSide) {
    return search(world, q, 0, 0, side * q, side * q);
}

/// Ink of the segments on a tile of side x side pixels.
inline std::vector<double> draw(const std::vector<Segment>& segments, double width,
                                int side = kSide) {
    InkSettings settings;
    settings.styles.assign(kLineTypes, {static_cast<float>(width), {0, 0, 0}, 1.0F});
    InkTile tile(settings);
    tile.begin(0, 0, side, side);
    for (const Segment& segment : segments) tile.draw(segment);
    tile.finish();
    std::vector<double> ink(static_cast<std::size_t>(side * side));
    if (tile.empty()) return ink;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            ink[static_cast<std::size_t>(y * side + x)] = tile.alpha()[tile.index(x, y)];
        }
    }
    return ink;
}

// What is checked of segments

double distance(Vec2f a, Vec2f b) { return std::hypot(a.x - b.x, a.y - b.y); }

double length(const Segment& s) { return distance(s.a, s.b); }

inline double distance_to(const Segment& s, Vec2f p) {
    const double dx = s.b.x - s.a.x;
    const double dy = s.b.y - s.a.y;
    const double squared = dx * dx + dy * dy;
    double along = squared > 0.0 ? ((p.x - s.a.x) * dx + (p.y - s.a.y) * dy) / squared : 0.0;
    along = std::clamp(along, 0.0, 1.0);
    return std::hypot(p.x - s.a.x - along * dx, p.y - s.a.y - along * dy);
}

inline bool between(const Segment& s, GeometryId a, GeometryId b) {
    return (s.left == a && s.right == b) || (s.left == b && s.right == a);
}

inline std::set<LineType> types(const Found& found) {
    std::set<LineType> types;
    for (const Segment& segment : found.segments) types.insert(segment.type);
    return types;
}

inline std::size_t count(const Found& found, LineType type) {
    return static_cast<std::size_t>(std::ranges::count(found.segments, type, &Segment::type));
}

inline double total_length(const Found& found) {
    double sum = 0.0;
    for (const Segment& segment : found.segments) sum += length(segment);
    return sum;
}

/// Whether a point is so near the border of what was searched that its line may go on beyond it.
inline bool at_border(const SampleGrid& grid, Vec2f p) {
    const Vec2f low = grid.point(0, 0);
    const Vec2f high = grid.point(grid.width - 1, grid.height - 1);
    const float slack = 1e-4F;
    return p.x < low.x + slack || p.y < low.y + slack || p.x > high.x - slack ||
           p.y > high.y - slack;
}

/// Ends inside the grid that no other segment touches.
inline std::vector<Vec2f> loose_ends(const Found& found) {
    constexpr double kTouching = 1e-4;
    const auto cell = [](double v) { return static_cast<int>(std::floor(v)); };
    // By pixel, the segments that come near it.
    std::map<std::pair<int, int>, std::vector<const Segment*>> near;
    for (const Segment& s : found.segments) {
        const auto [left, right] = std::minmax(s.a.x, s.b.x);
        const auto [top, bottom] = std::minmax(s.a.y, s.b.y);
        for (int y = cell(top - kTouching); y <= cell(bottom + kTouching); ++y) {
            for (int x = cell(left - kTouching); x <= cell(right + kTouching); ++x) {
                near[{x, y}].push_back(&s);
            }
        }
    }
    std::vector<Vec2f> loose;
    for (const Segment& segment : found.segments) {
        for (const Vec2f end : {segment.a, segment.b}) {
            if (at_border(found.grid, end)) continue;
            const auto& others = near.at({cell(end.x), cell(end.y)});
            const bool touched = std::ranges::any_of(others, [&](const Segment* other) {
                return other != &segment && distance_to(*other, end) < kTouching;
            });
            if (!touched) loose.push_back(end);
        }
    }
    return loose;
}

inline std::string list(const std::vector<Vec2f>& points) {
    std::ostringstream text;
    for (const Vec2f p : points) text << "(" << p.x << ", " << p.y << ") ";
    return text.str();
}

/// Ends that are not shared by exactly one other segment.
inline int unpaired_ends(const Found& found) {
    int unpaired = 0;
    for (const Segment& segment : found.segments) {
        for (const Vec2f end : {segment.a, segment.b}) {
            int shared = -1;  // itself
            for (const Segment& other : found.segments) {
                shared += (other.a == end ? 1 : 0) + (other.b == end ? 1 : 0);
            }
            unpaired += shared == 1 ? 0 : 1;
        }
    }
    return unpaired;
}

}  // namespace ink::test

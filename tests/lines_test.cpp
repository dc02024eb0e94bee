#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "lines/connect.h"
#include "lines/coverage.h"
#include "lines/detect.h"
#include "lines/ink.h"
#include "lines/locate.h"

namespace ink::test {
namespace {

constexpr double kDegrees = std::numbers::pi / 180.0;

// Invented worlds: surfaces seen from straight above, in pixels. x right, y down as on the screen,
// z towards the viewer. Normals are those of the scene's frame, where y points up.

struct Hit {
    double z;
    Vec3d normal;
    double radius = 0.0;  ///< of the sphere, if it is one
    Vec3d centre{};
};

struct Surface {
    GeometryId id;
    std::function<std::optional<Hit>(double x, double y)> at;
};

struct World {
    std::vector<Surface> surfaces;
    double unit = 1.0 / 64;    ///< of the scene's frame, in which the scene has a size of about 1
    bool knows_balls = false;  ///< samples say which sphere they lie on

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
            if (knows_balls && hit->radius > 0.0) {
                sample.ball = {to_float(Vec3d{hit->centre.x, -hit->centre.y, hit->centre.z} * unit),
                               static_cast<float>(hit->radius * unit)};
            }
        }
        return sample;
    }
};

using Region = std::function<bool(double x, double y)>;

Surface flat(GeometryId id, double z, Region region) {
    return {id, [=](double x, double y) -> std::optional<Hit> {
                if (!region(x, y)) return std::nullopt;
                return Hit{z, {0, 0, 1}};
            }};
}

/// The points on the left of a line, seen along it, at `angle_deg` clockwise from the x axis.
Region beside(double angle_deg, Vec3d through) {
    const double nx = std::sin(angle_deg * kDegrees);
    const double ny = -std::cos(angle_deg * kDegrees);
    return [=](double x, double y) { return (x - through.x) * nx + (y - through.y) * ny > 0.0; };
}

Region disc(Vec3d c, double r) {
    return [=](double x, double y) { return std::hypot(x - c.x, y - c.y) < r; };
}

Region everywhere() {
    return [](double, double) { return true; };
}

Surface sphere(GeometryId id, Vec3d c, double r) {
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
Surface plane(GeometryId id, Vec3d c, Vec3d normal) {
    return {id, [=](double x, double y) -> std::optional<Hit> {
                return Hit{c.z - (normal.x * (x - c.x) - normal.y * (y - c.y)) / normal.z, normal};
            }};
}

/// One surface that shows the lower of two: an edge that sticks out.
Surface lower(const Surface& a, const Surface& b) {
    return {a.id, [=](double x, double y) {
                const auto p = a.at(x, y);
                const auto q = b.at(x, y);
                return p->z < q->z ? p : q;
            }};
}

/// A torus whose axis leans by `tilt_deg` from the direction of sight, found by marching.
Surface torus(GeometryId id, Vec3d c, double ring, double tube, double tilt_deg) {
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

constexpr int kSide = 48;  ///< of a tile, pixels

/// Searches `columns` x `rows` points of a lattice of q x q a pixel, from point (i0, j0) on.
Found search(const World& world, int q, int i0, int j0, int columns, int rows) {
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
    Viewpoint viewpoint;
    viewpoint.dir = {0, 0, -1};
    viewpoint.parallel = true;
    viewpoint.origin = {{0, 0, 2}, {world.unit, 0, 0}, {0, -world.unit, 0}};
    viewpoint.direction = {{0, 0, -1}, {}, {}};
    SurfaceFunction describe;
    if (world.knows_balls) {
        describe = [&](std::size_t k, Sample& sample) {
            const auto width = static_cast<std::size_t>(columns);
            sample.ball =
                world(grid.point(static_cast<int>(k % width), static_cast<int>(k / width))).ball;
        };
    }
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

Found search(const World& world, int q, int side = kSide) {
    return search(world, q, 0, 0, side * q, side * q);
}

/// Ink of the segments on a tile of side x side pixels.
std::vector<double> draw(const std::vector<Segment>& segments, double width, int side = kSide) {
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

double distance_to(const Segment& s, Vec2f p) {
    const double dx = s.b.x - s.a.x;
    const double dy = s.b.y - s.a.y;
    const double squared = dx * dx + dy * dy;
    double along = squared > 0.0 ? ((p.x - s.a.x) * dx + (p.y - s.a.y) * dy) / squared : 0.0;
    along = std::clamp(along, 0.0, 1.0);
    return std::hypot(p.x - s.a.x - along * dx, p.y - s.a.y - along * dy);
}

bool between(const Segment& s, GeometryId a, GeometryId b) {
    return (s.left == a && s.right == b) || (s.left == b && s.right == a);
}

std::set<LineType> types(const Found& found) {
    std::set<LineType> types;
    for (const Segment& segment : found.segments) types.insert(segment.type);
    return types;
}

std::size_t count(const Found& found, LineType type) {
    return static_cast<std::size_t>(std::ranges::count(found.segments, type, &Segment::type));
}

double total_length(const Found& found) {
    double sum = 0.0;
    for (const Segment& segment : found.segments) sum += length(segment);
    return sum;
}

/// Whether a point is so near the border of what was searched that its line may go on beyond it.
bool at_border(const SampleGrid& grid, Vec2f p) {
    const Vec2f low = grid.point(0, 0);
    const Vec2f high = grid.point(grid.width - 1, grid.height - 1);
    const float slack = 1e-4F;
    return p.x < low.x + slack || p.y < low.y + slack || p.x > high.x - slack ||
           p.y > high.y - slack;
}

/// Ends inside the grid that no other segment touches.
std::vector<Vec2f> loose_ends(const Found& found) {
    std::vector<Vec2f> loose;
    for (const Segment& segment : found.segments) {
        for (const Vec2f end : {segment.a, segment.b}) {
            if (at_border(found.grid, end)) continue;
            const bool touched = std::ranges::any_of(found.segments, [&](const Segment& other) {
                return &other != &segment && distance_to(other, end) < 1e-4;
            });
            if (!touched) loose.push_back(end);
        }
    }
    return loose;
}

std::string list(const std::vector<Vec2f>& points) {
    std::ostringstream text;
    for (const Vec2f p : points) text << "(" << p.x << ", " << p.y << ") ";
    return text.str();
}

/// Ends that are not shared by exactly one other segment.
int unpaired_ends(const Found& found) {
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

// Coverage

TEST(SquareCoverage, IsTheAreaOfThePixelBesideTheLine) {
    constexpr int kRows = 1000;
    for (int angle_deg = 0; angle_deg < 360; angle_deg += 7) {
        const double nx = std::cos(angle_deg * kDegrees);
        const double ny = std::sin(angle_deg * kDegrees);
        for (int step = -20; step <= 20; ++step) {
            const double inside = step * 0.05;
            double area = 0.0;
            for (int row = 0; row < kRows; ++row) {
                const double y = (row + 0.5) / kRows - 0.5;
                // Inner side: nx x + ny y < inside.
                const double rest = inside - ny * y;
                const double share =
                    std::abs(nx) < 1e-9 ? (rest > 0.0 ? 1.0 : 0.0) : rest / std::abs(nx) + 0.5;
                area += std::clamp(share, 0.0, 1.0) / kRows;
            }
            EXPECT_NEAR(square_coverage(static_cast<float>(inside), static_cast<float>(nx),
                                        static_cast<float>(ny)),
                        area, 1.5e-3)
                << angle_deg << " degrees, " << inside;
        }
    }
}

TEST(BandCoverage, AddsUpToTheBandsWidthAcrossTheLine) {
    for (const double width : {0.01, 0.3, 0.5, 1.0, 2.0, 3.3, 8.0, 20.0}) {
        for (int angle_deg = 0; angle_deg < 360; ++angle_deg) {
            const double nx = std::cos(angle_deg * kDegrees);
            const double ny = std::sin(angle_deg * kDegrees);
            for (const double offset : {0.0, 0.137, 0.5, 0.77}) {
                // A column of pixels if the line is flat, else a row.
                const double step = std::max(std::abs(nx), std::abs(ny));
                double sum = 0.0;
                for (int i = -40; i <= 40; ++i) {
                    const double signed_distance = i * step + offset;
                    // As the line is drawn: the normal points from it to the pixel.
                    const float side = signed_distance < 0.0 ? -1.0F : 1.0F;
                    sum +=
                        band_coverage(static_cast<float>(std::abs(signed_distance)),
                                      static_cast<float>(width / 2), side * static_cast<float>(nx),
                                      side * static_cast<float>(ny));
                }
                EXPECT_NEAR(sum * step, width, 1e-4) << angle_deg << " degrees, " << offset;
            }
        }
    }
}

// Width

class StraightLine : public testing::TestWithParam<int> {};

struct Band {
    double width = 0.0;   ///< ink per unit of length
    double offset = 0.0;  ///< of the ink's middle from the edge
};

/// Ink of a line at `angle_deg` in [0, 90], in the inner part of a tile.
Band measure(const std::vector<double>& ink, int side, double angle_deg, Vec3d through) {
    const bool flat_line = angle_deg <= 45.0;
    const double nx = std::sin(angle_deg * kDegrees);
    const double ny = -std::cos(angle_deg * kDegrees);
    constexpr int kInner = 16;
    Band band;
    double moment = 0.0;
    for (int along = side / 2 - kInner / 2; along < side / 2 + kInner / 2; ++along) {
        for (int across = 0; across < side; ++across) {
            const int x = flat_line ? along : across;
            const int y = flat_line ? across : along;
            const double alpha = ink[static_cast<std::size_t>(y * side + x)];
            band.width += alpha;
            moment += alpha * ((x + 0.5 - through.x) * nx + (y + 0.5 - through.y) * ny);
        }
    }
    band.offset = moment / band.width;
    band.width *= std::max(std::abs(nx), std::abs(ny)) / kInner;
    return band;
}

TEST_P(StraightLine, HasTheWidthThatWasAskedForAtAnyAngleAndIsCentred) {
    constexpr int kTile = 64;
    const int q = GetParam();
    double worst_width = 0.0;
    double worst_offset = 0.0;
    for (int angle_deg = 0; angle_deg <= 90; angle_deg += 3) {
        std::vector<double> offsets(6);
        for (int phase = 0; phase < 4; ++phase) {
            const Vec3d through{32.137 + phase * 0.25, 32.211 + phase * 0.75, 0};
            const World world{{flat(1, 0.0, beside(angle_deg, through))}};
            const Found found = search(world, q, kTile);
            std::size_t n = 0;
            for (const double width : {0.5, 1.0, 2.0, 3.3, 8.0, 20.0}) {
                const Band band =
                    measure(draw(found.segments, width, kTile), kTile, angle_deg, through);
                EXPECT_NEAR(band.width, width, 0.02 * width)
                    << angle_deg << " degrees, width " << width;
                worst_width = std::max(worst_width, std::abs(band.width / width - 1.0));
                offsets[n++] += band.offset / 4;
            }
        }
        // A narrow line within one row of pixels cannot show where in it it lies: the mean can.
        for (const double offset : offsets) {
            EXPECT_NEAR(offset, 0.0, 0.05) << angle_deg << " degrees";
            worst_offset = std::max(worst_offset, std::abs(offset));
        }
    }
    RecordProperty("worst_width", std::to_string(worst_width));
    RecordProperty("worst_offset", std::to_string(worst_offset));
}

INSTANTIATE_TEST_SUITE_P(OnALatticeOf, StraightLine, testing::Values(1, 2, 3, 4),
                         testing::PrintToStringParamName());

// Position

TEST(DiscOutline, LiesOnItsCircle) {
    for (const double r : {5.0, 7.3, 12.0, 20.0}) {
        for (int q = 1; q <= 4; ++q) {
            for (const Vec3d c :
                 {Vec3d{24.0, 24.0, 0}, Vec3d{24.5, 24.5, 0}, Vec3d{24.137, 23.711, 0}}) {
                const Found found = search({{flat(1, 0.0, disc(c, r))}}, q);
                ASSERT_FALSE(found.segments.empty());
                for (const Segment& s : found.segments) {
                    EXPECT_NEAR(std::hypot(s.a.x - c.x, s.a.y - c.y), r, 0.05);
                    EXPECT_NEAR(std::hypot(s.b.x - c.x, s.b.y - c.y), r, 0.05);
                    EXPECT_NEAR(std::hypot((s.a.x + s.b.x) / 2 - c.x, (s.a.y + s.b.y) / 2 - c.y), r,
                                0.1);
                }
            }
        }
    }
    const Vec3d c{50.2, 49.9, 0};
    const Found large = search({{flat(1, 0.0, disc(c, 40.0))}}, 1, 100);
    for (const Segment& s : large.segments) {
        EXPECT_NEAR(std::hypot(s.a.x - c.x, s.a.y - c.y), 40.0, 0.05);
        EXPECT_NEAR(std::hypot(s.b.x - c.x, s.b.y - c.y), 40.0, 0.05);
    }
}

TEST(DiscOutline, IsOneClosedChainAsLongAsTheCircle) {
    for (const double r : {3.0, 5.0, 7.3, 12.0, 20.0}) {
        for (int q = 1; q <= 4; ++q) {
            for (const Vec3d c :
                 {Vec3d{24.0, 24.0, 0}, Vec3d{24.5, 24.5, 0}, Vec3d{24.137, 23.711, 0}}) {
                const Found found = search({{flat(1, 0.0, disc(c, r))}}, q);
                EXPECT_EQ(unpaired_ends(found), 0) << r << ", " << q << ", " << c.x;
                EXPECT_NEAR(total_length(found), 2 * std::numbers::pi * r,
                            0.01 * 2 * std::numbers::pi * r)
                    << r << ", " << q << ", " << c.x;
                EXPECT_EQ(types(found), std::set{LineType::silhouette});
            }
        }
    }
}

TEST(Outline, HasTheGeometriesOnTheSidesThatItSays) {
    const Vec3d c{24.137, 23.711, 0};
    const World world{{flat(1, 0.0, disc(c, 12.3)), flat(2, -5.0, everywhere())}};
    for (int q = 1; q <= 4; ++q) {
        const Found found = search(world, q);
        for (const Segment& s : found.segments) {
            const double dx = (s.b.x - s.a.x) / length(s);
            const double dy = (s.b.y - s.a.y) / length(s);
            const auto probe = [&](double side) {
                // Left of (dx, dy) is (dy, -dx), as y points down.
                return world({static_cast<float>((s.a.x + s.b.x) / 2 + side * 0.2 * dy),
                              static_cast<float>((s.a.y + s.b.y) / 2 - side * 0.2 * dx)})
                    .id;
            };
            EXPECT_EQ(probe(1.0), s.left);
            EXPECT_EQ(probe(-1.0), s.right);
            EXPECT_EQ(found.grid.id[s.left_sample], s.left);
            EXPECT_EQ(found.grid.id[s.right_sample], s.right);
        }
    }
}

/// Two spheres that overlap, and the curves that can be seen of them.
struct TwoSpheres {
    Vec3d c, d;
    double r, s;

    World world(double unit = 1.0 / 64) const { return {{sphere(1, c, r), sphere(2, d, s)}, unit}; }
    /// Distance on screen from the projection of the circle in which the spheres meet, to first
    /// order; for centres at different depths.
    double to_seam(Vec2f p) const {
        const Vec3d a{2 * (d.x - c.x), 2 * (d.y - c.y), 2 * (d.z - c.z)};
        const double rhs = dot(d, d) - dot(c, c) - s * s + r * r;
        const double z = (rhs - a.x * p.x - a.y * p.y) / a.z;
        const Vec3d v{p.x - c.x, p.y - c.y, z - c.z};
        const double f = dot(v, v) - r * r;
        return f / std::hypot(2 * v.x - 2 * v.z * a.x / a.z, 2 * v.y - 2 * v.z * a.y / a.z);
    }
    double to_limb(Vec2f p) const {
        return std::min(std::abs(std::hypot(p.x - c.x, p.y - c.y) - r),
                        std::abs(std::hypot(p.x - d.x, p.y - d.y) - s));
    }
};

std::vector<TwoSpheres> overlapping_spheres() {
    std::vector<TwoSpheres> all;
    for (const double r : {5.0, 9.0, 16.0, 40.0}) {
        for (const double ratio : {0.6, 1.0}) {
            for (const double lean_deg : {10.0, 30.0, 50.0, 70.0, 80.0}) {
                const double s = r * ratio;
                const double apart = 0.75 * (r + s);
                const Vec3d c{r + 2.137, r + 2.711, 0};
                const double turned = lean_deg * 3.7 * kDegrees;
                const double aside = apart * std::sin(lean_deg * kDegrees);
                const Vec3d d{c.x + aside * std::abs(std::cos(turned)),
                              c.y + aside * std::abs(std::sin(turned)),
                              apart * std::cos(lean_deg * kDegrees)};
                all.push_back({c, d, r, s});
            }
        }
    }
    return all;
}

TEST(SphereSeam, LiesWhereTheSpheresMeet) {
    double worst_end = 0.0;
    double worst_junction = 0.0;
    for (const TwoSpheres& spheres : overlapping_spheres()) {
        const int side = static_cast<int>(4 * spheres.r) + 6;
        for (const int q : {1, 2, 4}) {
            const Found found = search(spheres.world(1.0 / side), q, side);
            for (const Segment& segment : found.segments) {
                if (!between(segment, 1, 2)) continue;
                const auto off = [&](Vec2f p) {
                    return std::min(std::abs(spheres.to_seam(p)), spheres.to_limb(p));
                };
                EXPECT_LT(off(segment.a), 0.05);
                (segment.spans_cell ? worst_end : worst_junction) =
                    std::max(segment.spans_cell ? worst_end : worst_junction, off(segment.b));
                EXPECT_LT(off(segment.b), 0.05)
                    << (segment.spans_cell ? "crossing" : "junction") << " at " << segment.b.x
                    << ", " << segment.b.y << ", r " << spheres.r << ", s " << spheres.s << ", q "
                    << q;
                // The seam's ellipse bends the most at its tips.
                EXPECT_LT(off((segment.a + segment.b) * 0.5F), q == 1 ? 0.15 : 0.1);
            }
        }
    }
    RecordProperty("worst_end", std::to_string(worst_end));
    RecordProperty("worst_junction", std::to_string(worst_junction));
}

// Types

TEST(SphereSeam, IsAnIntersectionAndALimbASilhouette) {
    for (const TwoSpheres& spheres : overlapping_spheres()) {
        const int side = static_cast<int>(4 * spheres.r) + 6;
        for (const int q : {1, 2, 4}) {
            const Found found = search(spheres.world(1.0 / side), q, side);
            for (const Segment& segment : found.segments) {
                if (!between(segment, 1, 2)) {
                    EXPECT_EQ(segment.type, LineType::silhouette);
                    continue;
                }
                const double seam = std::abs(spheres.to_seam(segment.a));
                const double limb = spheres.to_limb(segment.a);
                if (seam < 0.2 && limb < 0.2) continue;  // where one turns into the other
                EXPECT_EQ(segment.type, seam < limb ? LineType::intersection : LineType::silhouette)
                    << segment.a.x << ", " << segment.a.y << ": seam " << seam << " limb " << limb
                    << ", r " << spheres.r << ", s " << spheres.s << ", d.z " << spheres.d.z
                    << ", q " << q;
            }
        }
    }
}

TEST(SphereSeam, SeenFromTheSideIsAnIntersectionFromLimbToLimb) {
    for (const double r : {5.0, 10.0, 20.0}) {
        for (const double overlap : {0.02, 0.1, 0.5, 1.0}) {
            for (int angle_deg = 0; angle_deg < 90; angle_deg += 11) {
                const Vec3d c{2 * r + 4.137, 2 * r + 3.711, 0};
                const double apart = r * (2.0 - overlap) / 2.0;
                const Vec3d half{apart * std::cos(angle_deg * kDegrees),
                                 apart * std::sin(angle_deg * kDegrees), 0};
                const World world{{sphere(1, c - half, r), sphere(2, c + half, r)}, 0.25 / r};
                const int side = static_cast<int>(4 * r) + 8;
                const Found found = search(world, 1, side);
                std::size_t seam = 0;
                std::size_t wrong = 0;
                for (const Segment& segment : found.segments) {
                    if (!between(segment, 1, 2)) continue;
                    ++seam;
                    wrong += segment.type == LineType::intersection ? 0 : 1;
                }
                EXPECT_LE(wrong, 1U) << "r " << r << ", overlap " << overlap << ", " << angle_deg
                                     << " degrees";  // of a seam that is a pixel long
                if (overlap * r > 1.0) {
                    EXPECT_GT(seam, 0U);
                }
            }
        }
    }
}

// Spheres that the samples tell of

TEST(PredictedOutline, LiesOnItsCircle) {
    const World world{{sphere(1, {24.3, 23.6, 0}, 17.4)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    ASSERT_GT(found.crossings.size(), 50U);
    for (const Crossing& c : found.crossings) {
        EXPECT_NEAR(std::hypot(c.point.x - 24.3, c.point.y - 23.6), 17.4, 2e-3);
    }
}

TEST(PredictedSeam, LiesWhereTheSpheresMeet) {
    // Radii 20 and 15, centres 20 apart on screen and 5 in depth.
    const Vec3d a{15, 24, 0};
    const Vec3d b{35, 24, 5};
    const World world{{sphere(1, a, 20), sphere(2, b, 15)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    std::size_t seams = 0;
    for (const Crossing& c : found.crossings) {
        if (c.type != LineType::intersection) continue;
        ++seams;
        const double xa = c.point.x - a.x;
        const double xb = c.point.x - b.x;
        const double y = c.point.y - 24.0;
        const double za = a.z + std::sqrt(400.0 - xa * xa - y * y);
        const double zb = b.z + std::sqrt(225.0 - xb * xb - y * y);
        const double slope = std::abs(xa / (za - a.z) - xb / (zb - b.z)) + 1e-3;
        EXPECT_LT(std::abs(za - zb) / slope, 0.01);
    }
    EXPECT_GT(seams, 15U);
}

TEST(PredictedLimb, IsASilhouetteHoweverLittleItStandsOut) {
    for (const double gap : {3.0, 1.0, 0.3, 0.1, 0.03, 0.01}) {
        // The limb of the first sphere, at depth 0, is `gap` in front of the second's face.
        const World world{
            {sphere(1, {24, 24, 0}, 12), sphere(2, {24, 24, -400 - gap}, std::hypot(400.0, 12.0))},
            1.0 / 512,
            true};
        for (const Crossing& c : search(world, 1).crossings) {
            EXPECT_EQ(c.type, LineType::silhouette) << gap;
        }
    }
}

TEST(PredictedCrossings, TakeOneSampleEach) {
    const World world{{sphere(1, {20, 24, 0}, 15), sphere(2, {32, 22, 3}, 12)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    EXPECT_GT(found.crossings.size(), 80U);
    EXPECT_LE(found.samples, found.crossings.size());
}

TEST(PredictedCrossings, OfSmallSpheresTakeNoSample) {
    const World world{{sphere(1, {20, 24, 0}, 5), sphere(2, {26, 22, 3}, 6)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    EXPECT_GT(found.crossings.size(), 30U);
    EXPECT_EQ(found.samples, 0U);
}

TEST(PredictedCrossings, AreThoseThatBisectionFinds) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0.0, kSide);
    World world;
    for (GeometryId id = 1; id <= 40; ++id) {
        const double x = place(random);
        const double y = place(random);
        world.surfaces.push_back(sphere(id, {x, y, place(random)}, 11.0));
    }
    const Found bisected = search(world, 1);
    world.knows_balls = true;
    const Found predicted = search(world, 1);
    std::size_t apart = 0;
    for (const Crossing& p : predicted.crossings) {
        const bool same = std::ranges::any_of(bisected.crossings, [&](const Crossing& c) {
            return c.edge == p.edge && c.first == p.first && c.second == p.second &&
                   distance(c.point, p.point) < 1.0 / 64;
        });
        apart += same ? 0 : 1;
    }
    EXPECT_GT(predicted.crossings.size(), 400U);
    // Slivers within one lattice edge may be seen by one and missed by the other.
    EXPECT_LE(apart, predicted.crossings.size() / 100);
    EXPECT_LT(2 * predicted.samples, bisected.samples);
}

TEST(PredictedSeam, WithinOneGeometryIsACrease) {
    const World world{{sphere(1, {15, 24, 0}, 20), sphere(1, {35, 24, 5}, 15)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    EXPECT_GT(count(found, LineType::crease), 15U);
    EXPECT_EQ(count(found, LineType::intersection), 0U);
}

TEST(GapOfOnePercentBetweenSpheres, IsASilhouette) {
    for (const double r : {20.0, 50.0, 120.0, 250.0, 500.0}) {
        for (const double ratio : {0.5, 1.0, 2.0, 4.0}) {
            for (const double lean_deg : {20.0, 40.0, 60.0, 70.0, 80.0, 85.0}) {
                for (const double turn_deg : {0.0, 33.0}) {
                    // The front sphere's limb, where it is nearest to the sphere behind, is in the
                    // middle of the tile.
                    const Vec3d aside{std::cos(turn_deg * kDegrees), std::sin(turn_deg * kDegrees),
                                      0};
                    const Vec3d c = Vec3d{24.137, 23.711, 0} - aside * r;
                    const double apart = r * (1.0 + ratio + 0.01);
                    Vec3d d = c + aside * (apart * std::sin(lean_deg * kDegrees));
                    d.z = -apart * std::cos(lean_deg * kDegrees);
                    const World world{{sphere(1, c, r), sphere(2, d, r * ratio)},
                                      0.25 / (r * std::max(ratio, 1.0))};
                    for (const int q : {1, 3}) {
                        const Found found = search(world, q);
                        for (const Segment& segment : found.segments) {
                            EXPECT_EQ(segment.type, LineType::silhouette)
                                << segment.a.x << ", " << segment.a.y << ", r " << r << ", ratio "
                                << ratio << ", lean " << lean_deg << ", turn " << turn_deg << ", q "
                                << q;
                        }
                    }
                }
            }
        }
    }
}

TEST(LimbInFrontOfAPlate, IsASilhouetteAtAnyGapThatCanBeSeen) {
    for (const double r : {20.0, 50.0, 120.0, 250.0, 500.0}) {
        for (const double gap : {0.02, 0.05, 0.1, 0.3}) {
            for (const int q : {1, 4}) {
                std::size_t wrong = 0;
                std::size_t all = 0;
                for (int angle_deg = 0; angle_deg < 360; angle_deg += 20) {
                    const Vec3d c{24.137 - r * std::cos(angle_deg * kDegrees),
                                  23.711 - r * std::sin(angle_deg * kDegrees), 0};
                    // The plate cuts the sphere a little behind its equator.
                    const Found found = search(
                        {{sphere(1, c, r), plane(2, {24, 24, -gap * r}, {0, 0, 1})}, 0.5 / r}, q);
                    wrong += count(found, LineType::intersection);
                    all += found.segments.size();
                }
                // A gap of less than a pixel behind a limb can still pass for contact.
                EXPECT_LE(wrong, gap * r < 2.5 ? all / 100 : 0U)
                    << "of " << all << " segments: radius " << r << " px, gap " << gap
                    << " of it, q " << q;
            }
        }
    }
}

TEST(SphereSunkIntoAPlate, MeetsItInAnIntersection) {
    for (const double r : {10.0, 20.0, 120.0, 500.0}) {
        // Nearer to the equator the plate touches the limb, and both types are right.
        for (const double above_equator : {0.05, 0.2, 0.5, 0.9}) {
            for (int angle_deg = 0; angle_deg < 360; angle_deg += 40) {
                const double ring = r * std::sqrt(1.0 - above_equator * above_equator);
                const Vec3d c{24.137 - ring * std::cos(angle_deg * kDegrees),
                              23.711 - ring * std::sin(angle_deg * kDegrees), 0};
                const Found found = search(
                    {{sphere(1, c, r), plane(2, {24, 24, above_equator * r}, {0, 0, 1})}, 0.5 / r},
                    1);
                EXPECT_EQ(types(found), std::set{LineType::intersection})
                    << r << ", " << above_equator;
            }
        }
    }
}

TEST(SmoothSurface, HasNoLineButItsOutline) {
    for (const double r : {1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 24.0, 100.0, 1000.0, 10000.0}) {
        for (const int q : {1, 2, 4}) {
            for (int angle_deg = 0; angle_deg < 360; angle_deg += 40) {
                // The limb is in the middle of the tile, or the whole sphere in the tile.
                const double back = r > 20.0 ? r : 0.0;
                const Vec3d c{24.137 - back * std::cos(angle_deg * kDegrees),
                              23.711 - back * std::sin(angle_deg * kDegrees), 0};
                const Found found = search({{sphere(1, c, r)}, 0.5 / std::max(r, 20.0)}, q);
                EXPECT_EQ(types(found), std::set{LineType::silhouette}) << r << ", " << q;
            }
        }
    }
}

TEST(Torus, HasSelfOcclusionsWhereItHidesItselfAndNeverACrease) {
    for (const double tube : {1.0, 2.0, 4.0, 8.0, 100.0, 1000.0, 10000.0}) {
        const double ring = 2.5 * tube;
        for (const double tilt_deg : {0.0, 20.0, 45.0, 60.0, 75.0, 90.0}) {
            for (const int q : {1, 2}) {
                // Small ones whole; of large ones, parts where the hole's rim is seen.
                for (const double shift : {0.0, 0.35, 0.6, 1.0, 1.4}) {
                    if (tube < 10.0 && shift > 0.0) continue;
                    const double away = tube < 10.0 ? 0.0 : shift * ring;
                    const Vec3d c{24.137 + away * 0.8,
                                  23.711 + away * 0.6 * (tilt_deg < 50 ? 1 : 0), 0};
                    const World world{{torus(1, c, ring, tube, tilt_deg)},
                                      0.4 / std::max(ring, 10.0)};
                    const Found found = search(world, q);
                    EXPECT_EQ(count(found, LineType::crease), 0U)
                        << "tube " << tube << ", tilt " << tilt_deg << ", q " << q << ", shift "
                        << shift;
                    EXPECT_EQ(count(found, LineType::intersection), 0U);
                    if (tilt_deg == 0.0) {
                        EXPECT_EQ(count(found, LineType::self_occlusion), 0U) << tube;
                    }
                    if (tilt_deg == 60.0 && tube >= 2.0 && tube < 10.0) {
                        EXPECT_GT(count(found, LineType::self_occlusion), 0U) << tube;
                    }
                }
            }
        }
    }
}

TEST(Torus, ShowsEveryPlaceWhereItHidesItself) {
    for (const double tube : {2.0, 4.0, 8.0}) {
        for (const double tilt_deg : {45.0, 60.0, 75.0, 85.0}) {
            const World world{{torus(1, {24.137, 23.711, 0}, 2.5 * tube, tube, tilt_deg)},
                              0.4 / (2.5 * tube + 5)};
            const Found found = search(world, 1);
            const SampleGrid& grid = found.grid;
            const auto z = [&](Vec2f p) { return -world(p).t / world.unit; };
            int missed = 0;
            int jumps = 0;
            for (int j = 0; j + 1 < grid.height; ++j) {
                for (int i = 0; i + 1 < grid.width; ++i) {
                    for (const bool down : {false, true}) {
                        const Vec2f a = grid.point(i, j);
                        const Vec2f b = down ? grid.point(i, j + 1) : grid.point(i + 1, j);
                        if (grid.id[grid.index(i, j)] == kBackground ||
                            world(b).id == kBackground || std::abs(z(a) - z(b)) < 0.5) {
                            continue;
                        }
                        // The surface alone rises by less than 0.3 px in a hundredth of a pixel.
                        double jump = 0.0;
                        bool gap = false;
                        for (int k = 0; k < 400; ++k) {
                            const Vec2f p = a + (b - a) * (static_cast<float>(k) / 400);
                            const Vec2f next = a + (b - a) * (static_cast<float>(k + 1) / 400);
                            gap |= world(next).id == kBackground;
                            jump = std::max(jump, std::abs(z(next) - z(p)));
                        }
                        if (gap || jump < 1.0) continue;
                        ++jumps;
                        const bool shown =
                            std::ranges::any_of(found.crossings, [&](const Crossing& crossing) {
                                const SuspectEdge& edge = found.suspects[crossing.edge];
                                return edge.i == i && edge.j == j && edge.down == down &&
                                       crossing.type == LineType::self_occlusion;
                            });
                        missed += shown ? 0 : 1;
                    }
                }
            }
            // At either end of the line, where the jump fades out, its sides are as steep as each
            // other.
            EXPECT_LE(missed, 2) << "of " << jumps << " jumps of more than a pixel: tube " << tube
                                 << ", tilt " << tilt_deg;
        }
    }
}

TEST(Step, IsASelfOcclusion) {
    for (int angle_deg = 0; angle_deg < 180; angle_deg += 15) {
        const Vec3d through{24.137, 23.711, 0};
        const Region front = beside(angle_deg, through);
        for (const double height : {1.0, 3.0, 20.0, 1000.0}) {
            for (const Vec3d normal : {Vec3d{0, 0, 1}, Vec3d{0.5, 0.3, 1}, Vec3d{-0.8, 1.5, 1}}) {
                const Surface ground = plane(1, {24, 24, 0}, normal);
                const Surface step{1, [=](double x, double y) {
                                       auto hit = ground.at(x, y);
                                       if (front(x, y)) hit->z += height;
                                       return hit;
                                   }};
                for (const int q : {1, 2, 4}) {
                    const Found found = search({{step}, 0.5 / std::max(height, 32.0)}, q);
                    EXPECT_EQ(types(found), std::set{LineType::self_occlusion})
                        << angle_deg << ", height " << height << ", q " << q << ", normal "
                        << normal.x;
                    // Its whole length, and nothing twice.
                    const Found outline = search({{flat(1, 0.0, front)}}, q);
                    EXPECT_NEAR(total_length(found), total_length(outline), 0.5)
                        << angle_deg << ", height " << height << ", q " << q << ", normal "
                        << normal.x;
                    EXPECT_TRUE(loose_ends(found).empty());
                }
            }
        }
    }
}

// Creases

struct Wedge {
    World world;
    Vec3d first, second;  ///< normals
};

/// Two faces of one surface whose normals are `angle_deg` apart, in any orientation in which both
/// are seen.
Wedge random_wedge(double angle_deg, std::mt19937& random, double unit) {
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-23 - 1.0; };
    for (;;) {
        const Vec3d a = normalize(Vec3d{uniform(), uniform(), uniform()});
        const Vec3d side = normalize(cross(a, Vec3d{uniform(), uniform(), uniform()}));
        const Vec3d b = a * std::cos(angle_deg * kDegrees) + side * std::sin(angle_deg * kDegrees);
        if (a.z < 0.2 || b.z < 0.2) continue;
        const Vec3d c{24.137 + uniform(), 23.711 + uniform(), 0};
        return {{{lower(plane(1, c, a), plane(1, c, b))}, unit}, a, b};
    }
}

TEST(Crease, HasAStrengthThatGrowsWithItsAngleAlone) {
    std::mt19937 random(1);
    for (const auto& [angle_deg, least, most] :
         {std::tuple{5.0, 0.0, 0.0}, std::tuple{20.0, 0.2, 0.9}, std::tuple{60.0, 1.0, 1.0},
          std::tuple{90.0, 1.0, 1.0}}) {
        std::optional<float> strength;
        for (int k = 0; k < 60; ++k) {
            const double unit = std::pow(10.0, -k % 4) / 64;
            const Wedge wedge = random_wedge(angle_deg, random, unit);
            for (int q = 1; q <= 4; ++q) {
                const Found found = search(wedge.world, q);
                if (most == 0.0) {
                    EXPECT_TRUE(found.segments.empty()) << angle_deg;
                    continue;
                }
                EXPECT_EQ(types(found), std::set{LineType::crease})
                    << angle_deg << " degrees, q " << q << ", normals " << wedge.first.x << ","
                    << wedge.first.y << "," << wedge.first.z << " and " << wedge.second.x << ","
                    << wedge.second.y << "," << wedge.second.z << ", unit " << unit;
                EXPECT_TRUE(loose_ends(found).empty()) << list(loose_ends(found));
                for (const Segment& segment : found.segments) {
                    EXPECT_GE(segment.strength, least);
                    EXPECT_LE(segment.strength, most);
                    if (!strength) strength = segment.strength;
                    EXPECT_NEAR(segment.strength, *strength, 1e-3F);
                }
            }
        }
    }
}

TEST(Crease, RunsAlongTheWedgesEdge) {
    std::mt19937 random(2);
    for (const double angle_deg : {20.0, 60.0, 90.0}) {
        for (int k = 0; k < 40; ++k) {
            const Wedge wedge = random_wedge(angle_deg, random, 1.0 / 64);
            for (int q = 1; q <= 4; ++q) {
                const Found found = search(wedge.world, q);
                // The line through the tile is at least as long as the part of the tile's middle
                // row or column that it must cross.
                EXPECT_GT(total_length(found), kSide - 6.0);
                for (const Segment& segment : found.segments) {
                    for (const Vec2f p : {segment.a, segment.b}) {
                        // Both faces are at the same height there: the heights' difference over its
                        // gradient.
                        const Vec3d g{
                            wedge.first.x / wedge.first.z - wedge.second.x / wedge.second.z,
                            wedge.first.y / wedge.first.z - wedge.second.y / wedge.second.z, 0};
                        const auto z = [&](Vec2f at) {
                            const Vec3f n = wedge.world(at).normal;
                            return std::abs(dot(to_double(n), wedge.first) - 1.0) < 1e-4;
                        };
                        // On either side, within 0.05 px, lies the other face.
                        const double size = std::hypot(g.x, g.y);
                        const Vec2f step{static_cast<float>(0.05 * g.x / size),
                                         static_cast<float>(-0.05 * g.y / size)};
                        EXPECT_NE(z(p + step), z(p - step)) << p.x << ", " << p.y;
                    }
                }
            }
        }
    }
}

// Junctions

/// Three regions of different ID that meet at a point, at the same depth or one before the others.
World three_regions(Vec3d at, double turn_deg, double first_height) {
    const auto sector = [=](double from_deg, double to_deg) -> Region {
        return [=](double x, double y) {
            double angle = std::atan2(y - at.y, x - at.x) / kDegrees - turn_deg;
            while (angle < 0.0) angle += 360.0;
            return angle >= from_deg && angle < to_deg;
        };
    };
    return {{flat(1, first_height, sector(0, 120)), flat(2, 0.0, sector(120, 240)),
             flat(3, 0.0, sector(240, 360))}};
}

void expect_no_gap_at(const World& world, Vec3d at, const std::string& what) {
    for (int q = 1; q <= 4; ++q) {
        const Found found = search(world, q);
        const auto loose = loose_ends(found);
        EXPECT_TRUE(loose.empty()) << what << ", q " << q << ": " << list(loose);
        const std::vector<double> ink = draw(found.segments, 3.0);
        const auto x = static_cast<std::size_t>(at.x);
        const auto y = static_cast<std::size_t>(at.y);
        EXPECT_NEAR(ink[y * kSide + x], 1.0, 1e-5) << what << ", q " << q;
    }
}

std::vector<std::pair<Vec3d, double>> junction_places() {
    std::mt19937 random(3);
    std::vector<std::pair<Vec3d, double>> places;
    for (int k = 0; k < 60; ++k) {
        const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
        const double x = 24 + uniform();
        const double y = 24 + uniform();
        places.push_back({{x, y, 0}, 360 * uniform()});
    }
    return places;
}

TEST(Junction, OfThreeRegionsHasNoGap) {
    for (const auto& [at, turn_deg] : junction_places()) {
        expect_no_gap_at(three_regions(at, turn_deg, 0.0), at, "Y at " + std::to_string(at.x));
        expect_no_gap_at(three_regions(at, turn_deg, 9.0), at, "raised at " + std::to_string(at.x));
    }
}

TEST(Junction, OfFourRegionsHasNoGap) {
    for (const auto& [at, turn_deg] : junction_places()) {
        const Region a = beside(turn_deg, at);
        const Region b = beside(turn_deg + 90.0, at);
        World checkerboard;
        World quarters;
        for (int k = 0; k < 4; ++k) {
            const Region quarter = [=](double x, double y) {
                return a(x, y) == (k / 2 == 0) && b(x, y) == (k % 2 == 0);
            };
            checkerboard.surfaces.push_back(
                flat(static_cast<GeometryId>(k / 2 == k % 2 ? 1 : 2), 0.0, quarter));
            quarters.surfaces.push_back(flat(static_cast<GeometryId>(k + 1), 0.0, quarter));
        }
        const std::string place = std::to_string(at.x) + ", " + std::to_string(at.y) + " turned " +
                                  std::to_string(turn_deg);
        expect_no_gap_at(quarters, at, "four IDs at " + place);
        expect_no_gap_at(checkerboard, at, "two IDs at " + place);
    }
}

TEST(Junction, WhereALineGoesBehindASurfaceHasNoGap) {
    for (const auto& [at, turn_deg] : junction_places()) {
        for (const double meeting_deg : {25.0, 60.0, 90.0, 130.0}) {
            const World world{{flat(1, 9.0, beside(turn_deg, at)),
                               flat(2, 0.0, beside(turn_deg + meeting_deg, at)),
                               flat(3, -9.0, everywhere())}};
            expect_no_gap_at(world, at,
                             "T at " + std::to_string(at.x) + ", " + std::to_string(at.y) +
                                 " turned " + std::to_string(turn_deg) + " by " +
                                 std::to_string(meeting_deg));
            const World before_nothing{{world.surfaces[0], world.surfaces[1]}};
            expect_no_gap_at(before_nothing, at, "T before background");
        }
    }
}

World random_spheres(unsigned seed, int spheres, double least, double most) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
    World world;
    for (int k = 1; k <= spheres; ++k) {
        const double x = kSide * uniform();
        const double y = kSide * uniform();
        const double z = 20 * uniform();
        world.surfaces.push_back(
            sphere(static_cast<GeometryId>(k), {x, y, z}, least + (most - least) * uniform()));
    }
    return world;
}

TEST(Lines, OfManySpheresHaveNoLooseEnds) {
    std::size_t loose = 0;
    std::size_t segments = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        for (int q = 1; q <= 4; ++q) {
            const Found found = search(random_spheres(seed, 40, 2.0, 9.0), q);
            const auto ends = loose_ends(found);
            EXPECT_TRUE(ends.empty()) << "seed " << seed << ", q " << q << ": " << list(ends);
            loose += ends.size();
            segments += found.segments.size();
        }
    }
    RecordProperty("loose", std::to_string(loose) + " of " + std::to_string(2 * segments));
}

TEST(Lines, OfManySpheresLieWhereTheIdChanges) {
    // Each segment has what it says on its two sides, where no third surface is near.
    for (unsigned seed = 0; seed < 10; ++seed) {
        const World world = random_spheres(seed, 40, 2.0, 9.0);
        for (int q = 1; q <= 4; ++q) {
            const Found found = search(world, q);
            std::size_t wrong = 0;
            std::size_t checked = 0;
            for (const Segment& s : found.segments) {
                EXPECT_NE(s.left, s.right);
                EXPECT_LE(length(s), 1.5 / q);
                if (!s.spans_cell || length(s) < 0.1) continue;
                const double dx = (s.b.x - s.a.x) / length(s);
                const double dy = (s.b.y - s.a.y) / length(s);
                const auto probe = [&](double along, double side) {
                    return world({static_cast<float>((s.a.x + s.b.x) / 2 + along * dx + side * dy),
                                  static_cast<float>((s.a.y + s.b.y) / 2 + along * dy - side * dx)})
                        .id;
                };
                bool alone = true;
                for (int k = 0; k < 24; ++k) {
                    const double angle = k * 15 * kDegrees;
                    for (const double r : {0.15, 0.3, 0.6}) {
                        const GeometryId id = probe(r * std::cos(angle), r * std::sin(angle));
                        alone &= id == s.left || id == s.right;
                    }
                }
                if (!alone) continue;
                ++checked;
                wrong += probe(0, 0.15) == s.left && probe(0, -0.15) == s.right ? 0 : 1;
            }
            // Small spheres bend by a tenth of a pixel within a cell of one pixel.
            EXPECT_LE(static_cast<double>(wrong),
                      (q == 1 ? 0.02 : 0.005) * static_cast<double>(checked))
                << "seed " << seed << ", q " << q << ", of " << checked;
        }
    }
}

// Small things

TEST(Wire, WiderThanTheLatticesSpacingIsTwoUnbrokenLines) {
    for (int q = 1; q <= 4; ++q) {
        for (const double ratio : {1.02, 1.1, 1.5, 2.0, 3.0}) {
            const double width = ratio / q;
            for (int angle_deg = 0; angle_deg < 180; angle_deg += 7) {
                for (const double shift : {0.0, 0.3, 0.7}) {
                    const double nx = std::sin(angle_deg * kDegrees);
                    const double ny = -std::cos(angle_deg * kDegrees);
                    const Vec3d c{24.0 + shift, 24.137 + shift, 0};
                    const World world{{flat(1, 0.0, [=](double x, double y) {
                        return std::abs((x - c.x) * nx + (y - c.y) * ny) < width / 2;
                    })}};
                    const Found found = search(world, q);
                    const auto loose = loose_ends(found);
                    EXPECT_TRUE(loose.empty()) << width << " px at " << angle_deg << " degrees, q "
                                               << q << ": " << list(loose);
                    double upper = 0.0;
                    double under = 0.0;
                    for (const Segment& s : found.segments) {
                        const double side =
                            ((s.a.x + s.b.x) / 2 - c.x) * nx + ((s.a.y + s.b.y) / 2 - c.y) * ny;
                        EXPECT_NEAR(std::abs(side), width / 2, 0.03);
                        (side > 0.0 ? upper : under) += length(s);
                    }
                    const double chord =
                        (kSide - 1.0 / q) / std::max(std::abs(std::cos(angle_deg * kDegrees)),
                                                     std::abs(std::sin(angle_deg * kDegrees)));
                    EXPECT_NEAR(upper, chord, 3.5)
                        << width << " px at " << angle_deg << ", q " << q;
                    EXPECT_NEAR(under, chord, 3.5)
                        << width << " px at " << angle_deg << ", q " << q;
                }
            }
        }
    }
}

TEST(Wire, ThinnerThanTheLatticesSpacingLeavesNoLooseEndsWhereItIsMissed) {
    for (const double width : {0.3, 0.5, 0.8}) {
        for (int angle_deg = 1; angle_deg < 90; angle_deg += 8) {
            const double nx = std::sin(angle_deg * kDegrees);
            const double ny = -std::cos(angle_deg * kDegrees);
            const World world{{flat(1, 0.0, [=](double x, double y) {
                return std::abs((x - 24.2) * nx + (y - 24.3) * ny) < width / 2;
            })}};
            const Found found = search(world, 1);
            EXPECT_TRUE(loose_ends(found).empty())
                << width << " px at " << angle_deg << ": " << list(loose_ends(found));
            for (const Segment& s : found.segments) EXPECT_EQ(s.type, LineType::silhouette);
        }
    }
}

TEST(Dust, IsClosedOutlinesWhereTheLatticeMeetsIt) {
    std::mt19937 random(4);
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
    for (int k = 0; k < 200; ++k) {
        const Vec3d c{24 + uniform(), 24 + uniform(), 0};
        for (int q = 1; q <= 4; ++q) {
            const Found found = search({{flat(1, 0.0, disc(c, 0.4))}}, q);
            const bool met =
                std::ranges::any_of(found.grid.id, [](GeometryId id) { return id == 1; });
            EXPECT_EQ(found.segments.empty(), !met);
            EXPECT_EQ(unpaired_ends(found), 0);
            for (const Segment& s : found.segments) {
                EXPECT_EQ(s.type, LineType::silhouette);
                EXPECT_NEAR(std::hypot(s.a.x - c.x, s.a.y - c.y), 0.4, 0.05);
            }
        }
    }
}

TEST(Dust, OnASurfaceIsClosedOutlinesToo) {
    std::mt19937 random(5);
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
    World world{{flat(1, -5.0, everywhere())}};
    for (GeometryId id = 2; id < 400; ++id) {
        const Vec3d c{kSide * uniform(), kSide * uniform(), 0};
        world.surfaces.push_back(flat(id, 10 * uniform(), disc(c, 0.4)));
    }
    for (int q = 1; q <= 4; ++q) {
        const Found found = search(world, q);
        const auto loose = loose_ends(found);
        EXPECT_TRUE(loose.empty()) << "q " << q << ": " << loose.size() << " of "
                                   << 2 * found.segments.size() << " ends: " << list(loose);
    }
}

// Tiles

using Key = std::tuple<float, float, float, float, LineType, float, float, GeometryId, GeometryId>;

std::vector<Key> keys(const Found& found) {
    std::vector<Key> keys;
    for (const Segment& s : found.segments) {
        keys.emplace_back(s.a.x, s.a.y, s.b.x, s.b.y, s.type, s.strength, s.t, s.left, s.right);
    }
    return keys;
}

TEST(Lines, AreTheSameHoweverTheLatticeIsCut) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        World world = random_spheres(seed, 60, 0.3, 9.0);
        world.surfaces.push_back(torus(99, {20, 20, 10}, 14, 4, 60));
        std::mt19937 random(seed);
        world.surfaces.push_back(random_wedge(50, random, 1.0).world.surfaces[0]);
        for (int q = 1; q <= 4; ++q) {
            std::vector<Key> whole = keys(search(world, q, 0, 0, 48 * q, 48 * q));
            const int half = 20 * q + 1;
            std::vector<Key> parts;
            for (const auto& [i0, j0, columns, rows] :
                 {std::tuple{0, 0, half + 1, half + 1},
                  std::tuple{half, 0, 48 * q - half, half + 1},
                  std::tuple{0, half, half + 1, 48 * q - half},
                  std::tuple{half, half, 48 * q - half, 48 * q - half}}) {
                const auto part = keys(search(world, q, i0, j0, columns, rows));
                parts.insert(parts.end(), part.begin(), part.end());
            }
            std::ranges::sort(whole);
            std::ranges::sort(parts);
            EXPECT_EQ(whole.size(), parts.size()) << "seed " << seed << ", q " << q;
            EXPECT_TRUE(whole == parts) << "seed " << seed << ", q " << q;
        }
    }
}

/// Another surface behind a pinhole in the nearer one, just where a lattice point looks.
TEST(Speck, ThatOneRayAloneSeesHasNoLine) {
    const Vec3d hole{20.5, 24.5, 0};
    const auto holed = [&](Surface surface) {
        return Surface{surface.id, [=](double x, double y) -> std::optional<Hit> {
                           if (std::hypot(x - hole.x, y - hole.y) < 0.004) return std::nullopt;
                           return surface.at(x, y);
                       }};
    };
    const Surface front = holed(plane(1, {24, 24, 0}, {0.1, 0.2, 1}));
    for (const GeometryId id : {1U, 2U}) {
        const Surface behind = plane(id, {24, 24, -5}, {0.1, 0.2, 1});
        EXPECT_TRUE(search({{front, behind}}, 1).segments.empty());
    }
    EXPECT_TRUE(search({{front}}, 1).segments.empty());
}

// Ink

TEST(Ink, OfTheNearerLineLiesOnTop) {
    InkSettings settings;
    settings.styles.assign(kLineTypes, {3.0F, {1, 0, 0}, 1.0F});
    settings.styles[static_cast<std::size_t>(LineType::crease)].color = {0, 0, 1};
    Segment near_line{{2, 8.5F}, {14, 8.5F}};
    near_line.t = 1.0F;
    Segment far_line{{8.5F, 2}, {8.5F, 14}};
    far_line.t = 2.0F;
    for (const bool crease_in_front : {false, true}) {
        (crease_in_front ? near_line : far_line).type = LineType::crease;
        (crease_in_front ? far_line : near_line).type = LineType::silhouette;
        for (const bool near_first : {false, true}) {
            InkTile tile(settings);
            tile.begin(0, 0, 16, 16);
            tile.draw(near_first ? near_line : far_line);
            tile.draw(near_first ? far_line : near_line);
            tile.finish();
            const std::size_t k = tile.index(8, 8);
            EXPECT_FLOAT_EQ(tile.alpha()[k], 1.0F);
            EXPECT_FLOAT_EQ(tile.color()[0][k], crease_in_front ? 0.0F : 1.0F);
            EXPECT_FLOAT_EQ(tile.color()[2][k], crease_in_front ? 1.0F : 0.0F);
        }
    }
}

TEST(Ink, OfThreeCrossingLinesIsLaidFrontToBack) {
    InkSettings settings;
    settings.styles.assign(kLineTypes, {40.0F, {1, 0, 0}, 0.5F});
    settings.styles[1].color = {0, 1, 0};
    settings.styles[2].color = {0, 0, 1};
    for (const std::array<int, 3> order :
         {std::array{0, 1, 2}, std::array{2, 0, 1}, std::array{1, 2, 0}, std::array{2, 1, 0}}) {
        InkTile tile(settings);
        tile.begin(0, 0, 16, 16);
        for (const int k : order) {
            Segment line{{0, 8}, {16, 8}};
            line.type = static_cast<LineType>(k);
            line.t = std::array{2.0F, 3.0F, 1.0F}[static_cast<std::size_t>(k)];
            tile.draw(line);
        }
        tile.finish();
        const std::size_t k = tile.index(8, 8);
        // The third type is nearest, then the first, then the second.
        EXPECT_FLOAT_EQ(tile.color()[2][k], 0.5F);
        EXPECT_FLOAT_EQ(tile.color()[0][k], 0.25F);
        EXPECT_FLOAT_EQ(tile.color()[1][k], 0.125F);
        EXPECT_FLOAT_EQ(tile.alpha()[k], 0.875F);
    }
}

TEST(Ink, IsTheSameOnAnyTile) {
    const Found found = search(random_spheres(1, 40, 2.0, 9.0), 2);
    for (const double width : {0.5, 3.0, 11.0}) {
        const std::vector<double> whole = draw(found.segments, width);
        InkSettings settings;
        settings.styles.assign(kLineTypes, {static_cast<float>(width), {0, 0, 0}, 1.0F});
        InkTile tile(settings);
        for (const auto& [x0, y0, w, h] :
             {std::tuple{0, 0, 20, 48}, std::tuple{20, 0, 28, 7}, std::tuple{20, 7, 28, 41}}) {
            tile.begin(x0, y0, w, h);
            for (const Segment& segment : found.segments) tile.draw(segment);
            tile.finish();
            for (int y = 0; y < h; ++y) {
                for (int x = 0; x < w; ++x) {
                    const double alpha = tile.empty() ? 0.0 : tile.alpha()[tile.index(x, y)];
                    EXPECT_EQ(alpha, whole[static_cast<std::size_t>((y0 + y) * kSide + x0 + x)]);
                }
            }
        }
    }
}

TEST(Ink, OfACircleIsItsLengthTimesTheWidth) {
    const Vec3d c{24.137, 23.711, 0};
    for (const int q : {1, 2, 4}) {
        for (const double r : {3.0, 5.0, 10.0, 18.0}) {
            const Found found = search({{flat(1, 0.0, disc(c, r))}}, q);
            for (const double width : {0.5, 1.0, 2.0, 3.0, 5.5}) {
                double sum = 0.0;
                for (const double alpha : draw(found.segments, width)) sum += alpha;
                const double area = 2 * std::numbers::pi * r * width;
                EXPECT_NEAR(sum, area, 0.015 * area) << r << ", width " << width << ", q " << q;
            }
        }
    }
}

TEST(Ink, OfADotIsADiscOfTheLinesWidth) {
    for (const double width : {2.0, 3.3, 8.0, 20.0}) {
        for (const double shift : {0.0, 0.3, 0.5}) {
            const auto at = static_cast<float>(24 + shift);
            const std::vector<double> ink = draw({{{at, at}, {at, at}}}, width);
            double sum = 0.0;
            for (const double alpha : ink) sum += alpha;
            const double area = std::numbers::pi * width * width / 4;
            // Each pixel takes the disc's rim to be straight.
            EXPECT_NEAR(sum, area, 0.01 * area + 0.25) << width;
        }
    }
}

}  // namespace
}  // namespace ink::test

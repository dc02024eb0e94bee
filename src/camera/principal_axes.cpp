#include "camera/principal_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "base/parallel.h"

namespace ink {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// Where the mass of a scene is: the centres of all but its meshes.
std::size_t centre_count(const Shape& shape) {
    return std::holds_alternative<Mesh>(shape) ? 0 : primitive_count(shape);
}

/// Of a stored one, before it is copied.
Vec3d centre(const Spheres& shape, std::size_t i) { return to_double(shape.spheres[i].centre); }
Vec3d centre(const Glyphs& shape, std::size_t i) { return to_double(shape.placements[i].origin); }
Vec3d centre(const Hexahedra& shape, std::size_t i) {
    return to_double(hexahedron_bounds(shape.corners[i]).centre());
}

/// Sums over points: their number, and of where they lie from some point the coordinates and their
/// products, the upper triangle of a symmetric matrix row by row.
struct Moments {
    double count = 0.0;
    Vec3d sum;
    std::array<double, 6> products{};

    Moments& operator+=(const Moments& other) {
        count += other.count;
        sum = sum + other.sum;
        for (std::size_t k = 0; k < products.size(); ++k) products[k] += other.products[k];
        return *this;
    }

    Matrix matrix() const {
        const auto& p = products;
        return {{{p[0], p[1], p[2]}, {p[1], p[3], p[4]}, {p[2], p[4], p[5]}}};
    }
    Matrix covariance() const {
        Matrix m = matrix();
        const std::array<double, 3> s{sum.x, sum.y, sum.z};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) m[i][j] -= s[i] * s[j] / std::max(count, 1.0);
        }
        return m;
    }
};

struct PointLanes {
    Lanes<double> x{}, y{}, z{};
};

/// Sixteen sums of each kind: lane i is of every sixteenth point, whatever the processor has.
INKTRACE_MULTIVERSION
void add(const PointLanes& p, std::array<Lanes<double>, 9>& sums) {
    for (int i = 0; i < kLanes; ++i) sums[0][i] += p.x[i];
    for (int i = 0; i < kLanes; ++i) sums[1][i] += p.y[i];
    for (int i = 0; i < kLanes; ++i) sums[2][i] += p.z[i];
    for (int i = 0; i < kLanes; ++i) sums[3][i] += p.x[i] * p.x[i];
    for (int i = 0; i < kLanes; ++i) sums[4][i] += p.x[i] * p.y[i];
    for (int i = 0; i < kLanes; ++i) sums[5][i] += p.x[i] * p.z[i];
    for (int i = 0; i < kLanes; ++i) sums[6][i] += p.y[i] * p.y[i];
    for (int i = 0; i < kLanes; ++i) sums[7][i] += p.y[i] * p.z[i];
    for (int i = 0; i < kLanes; ++i) sums[8][i] += p.z[i] * p.z[i];
}

/// Of points `first` to `end` about a point.
template <class Centre>
Moments moments_of_range(const Centre& centre, std::size_t first, std::size_t end, Vec3d about) {
    std::array<Lanes<double>, 9> sums{};
    for (std::size_t k = first; k < end; k += kLanes) {
        PointLanes points;
        const int used = static_cast<int>(std::min<std::size_t>(kLanes, end - k));
        for (int i = 0; i < used; ++i) {
            const Vec3d d = centre(k + static_cast<std::size_t>(i)) - about;
            points.x[i] = d.x;
            points.y[i] = d.y;
            points.z[i] = d.z;
        }
        add(points, sums);
    }
    std::array<double, 9> total{};
    for (std::size_t n = 0; n < total.size(); ++n) {
        for (const double lane : sums[n]) total[n] += lane;
    }
    return {static_cast<double>(end - first),
            {total[0], total[1], total[2]},
            {total[3], total[4], total[5], total[6], total[7], total[8]}};
}

/// Chunks are summed in their order, so that the sum does not depend on threads.
template <class Centre>
Moments moments_of(const Centre& centre, std::size_t count, Vec3d about) {
    constexpr std::size_t kChunk = 1 << 15;
    std::vector<Moments> sums((count + kChunk - 1) / kChunk);
    parallel_ranges(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            sums[k] =
                moments_of_range(centre, k * kChunk, std::min((k + 1) * kChunk, count), about);
        }
    });
    Moments total;
    for (const Moments& sum : sums) total += sum;
    return total;
}

/// Of points that are moved: `shift` is where the point goes that they are about, from what they
/// are to be about then.
Moments moved(const Moments& of, const Motion& motion, Vec3d shift) {
    const Matrix m = of.matrix();
    const Vec3d turned = motion.turn(of.sum);
    const std::array<double, 3> s{turned.x, turned.y, turned.z};
    const std::array<double, 3> v{shift.x, shift.y, shift.z};
    const auto r = [&](std::size_t row, std::size_t column) {
        return motion.rotation[3 * row + column];
    };
    Moments result{of.count, turned + shift * of.count};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = i; j < 3; ++j) {
            double& product = result.products[n++];
            product = s[i] * v[j] + v[i] * s[j] + of.count * v[i] * v[j];
            for (std::size_t a = 0; a < 9; ++a)
                product += r(i, a / 3) * m[a / 3][a % 3] * r(j, a % 3);
        }
    }
    return result;
}

/// Adds those of a shape; the first one of all says what they are about, so that points which
/// coincide have no spread at all.
template <class S>
void add_moments(const S& shape, std::span<const Copy> copies, std::size_t stored,
                 std::optional<Vec3d>& about, Moments& sum) {
    const Vec3d first = centre(shape, 0);
    const auto all_of = [&](Vec3d point) {
        return moments_of([&](std::size_t i) { return centre(shape, i); }, stored, point);
    };
    if (!about) about = copies.empty() ? first : copies[0].motion(first);
    if (copies.empty()) {
        sum += all_of(*about);
        return;
    }
    const Moments one = all_of(first);
    for (const Copy& copy : copies) {
        sum += moved(one, copy.motion, copy.motion(first) - *about);
    }
}

Matrix covariance(const Scene& scene) {
    Moments sum;
    std::optional<Vec3d> about;
    for (const Object& object : scene.objects()) {
        if (centre_count(object.shape) == 0) continue;
        if (const auto* solids = std::get_if<Hexahedra>(&object.shape)) {
            add_moments(*solids, {}, solids->corners.size(), about, sum);
        } else if (const auto* spheres = std::get_if<Spheres>(&object.shape)) {
            add_moments(*spheres, spheres->copies, spheres->spheres.size(), about, sum);
        } else if (const auto* glyphs = std::get_if<Glyphs>(&object.shape)) {
            add_moments(*glyphs, glyphs->copies, glyphs->placements.size(), about, sum);
        }
    }
    return sum.covariance();
}

/// Cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 8.5): leaves the eigenvalues
/// on the diagonal of `a`, returns the eigenvectors as columns.
Matrix diagonalize(Matrix& a) {
    Matrix v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int sweep = 0; sweep < 32; ++sweep) {
        for (std::size_t p = 0; p < 2; ++p) {
            for (std::size_t q = p + 1; q < 3; ++q) {
                if (a[p][q] == 0.0) continue;
                const double tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                const double t =
                    std::copysign(1.0, tau) / (std::abs(tau) + std::sqrt(1.0 + tau * tau));
                const double c = 1.0 / std::sqrt(1.0 + t * t);
                const double s = t * c;
                for (std::size_t k = 0; k < 3; ++k) {
                    const double kp = a[k][p];
                    const double kq = a[k][q];
                    a[k][p] = c * kp - s * kq;
                    a[k][q] = s * kp + c * kq;
                }
                for (std::size_t k = 0; k < 3; ++k) {
                    const double pk = a[p][k];
                    const double qk = a[q][k];
                    a[p][k] = c * pk - s * qk;
                    a[q][k] = s * pk + c * qk;
                    const double vp = v[k][p];
                    const double vq = v[k][q];
                    v[k][p] = c * vp - s * vq;
                    v[k][q] = s * vp + c * vq;
                }
            }
        }
    }
    return v;
}

/// An axis has no sign of its own: point it along the file axis that it follows most.
Vec3d along_file_axis(Vec3d axis) {
    const std::array<double, 3> v{axis.x, axis.y, axis.z};
    const double largest =
        *std::ranges::max_element(v, {}, [](double component) { return std::abs(component); });
    return largest < 0.0 ? -axis : axis;
}

}  // namespace

PrincipalAxes principal_axes(const Scene& scene) {
    Matrix m = covariance(scene);
    const Matrix vectors = diagonalize(m);
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t k) { return m[k][k]; });

    // Nearly round, two axes would be a matter of rounding: the picture must not jump when a file
    // gives its coordinates with a digit less.
    const double longest = m[order[0]][order[0]];
    const double middle = m[order[1]][order[1]];
    const double shortest = m[order[2]][order[2]];
    const bool clear = middle < 0.95 * longest && shortest < 0.95 * middle;
    constexpr double kFlat = 0.01;  // of the variance: a tenth as thick as long
    if (!clear) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, shortest > kFlat * longest};

    const auto column = [&](std::size_t k) {
        return Vec3d{vectors[0][k], vectors[1][k], vectors[2][k]};
    };
    PrincipalAxes axes;
    axes.longest = along_file_axis(column(order[0]));
    axes.middle = along_file_axis(column(order[1]));
    axes.shortest = cross(axes.longest, axes.middle);
    return axes;
}

}  // namespace ink

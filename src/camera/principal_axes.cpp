#include "camera/principal_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>
#include <vector>

#include "base/parallel.h"

namespace ink {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// Where the mass of a scene is: the centres of all but its meshes.
std::size_t centre_count(const Shape& shape) {
    return std::holds_alternative<Mesh>(shape) ? 0 : primitive_count(shape);
}

Vec3d centre(const Spheres& shape, std::size_t i) { return to_double(shape.at(i).centre); }
Vec3d centre(const Glyphs& shape, std::size_t i) { return to_double(shape.at(i).origin); }
Vec3d centre(const Hexahedra& shape, std::size_t i) {
    return to_double(hexahedron_bounds(shape.corners[i]).centre());
}
Vec3d centre(const Mesh& /*shape*/, std::size_t /*i*/) { return {}; }

/// Sum of `term(p)` over all centres. Chunks are summed in their order, so that the sum does not
/// depend on threads.
template <class Sum, class Term>
Sum sum_over_centres(const Scene& scene, const Term& term) {
    constexpr std::size_t kChunk = 1 << 15;
    Sum total{};
    for (const Object& object : scene.objects()) {
        const std::size_t count = centre_count(object.shape);
        std::vector<Sum> sums((count + kChunk - 1) / kChunk);
        std::visit(
            [&](const auto& shape) {
                parallel_ranges(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
                    for (std::size_t i = begin * kChunk; i < std::min(end * kChunk, count); ++i) {
                        sums[i / kChunk] += term(centre(shape, i));
                    }
                });
            },
            object.shape);
        for (const Sum& sum : sums) total += sum;
    }
    return total;
}

struct Mean {
    Vec3d sum;
    double count = 0.0;

    Mean& operator+=(const Mean& other) {
        sum = sum + other.sum;
        count += other.count;
        return *this;
    }
};

/// Upper triangle of a symmetric matrix, row by row.
struct Moments {
    std::array<double, 6> m{};

    Moments& operator+=(const Moments& other) {
        for (std::size_t k = 0; k < m.size(); ++k) m[k] += other.m[k];
        return *this;
    }
};

Matrix covariance(const Scene& scene) {
    const auto all = sum_over_centres<Mean>(scene, [](Vec3d p) { return Mean{p, 1.0}; });
    const Vec3d mean = all.sum / std::max(all.count, 1.0);
    const auto [m] = sum_over_centres<Moments>(scene, [&](Vec3d p) {
        const Vec3d d = p - mean;
        return Moments{{d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z}};
    });
    return {{{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}}};
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

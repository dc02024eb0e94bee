#include "camera/principal_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <variant>

namespace ink {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix covariance(const Scene& scene) {
    Vec3d sum;
    std::size_t count = 0;
    const auto for_each_centre = [&](const auto& visit) {
        for (const Object& object : scene.objects()) {
            if (const auto* shape = std::get_if<Spheres>(&object.shape)) {
                for (const Sphere& sphere : shape->spheres) visit(to_double(sphere.centre));
            } else if (const auto* glyphs = std::get_if<Glyphs>(&object.shape)) {
                for (const Placement& p : glyphs->placements) visit(to_double(p.origin));
            } else if (const auto* solids = std::get_if<Hexahedra>(&object.shape)) {
                for (const auto& corners : solids->corners) {
                    visit(to_double(hexahedron_bounds(corners).centre()));
                }
            }
        }
    };
    for_each_centre([&](Vec3d p) {
        sum = sum + p;
        ++count;
    });
    const Vec3d mean = sum / static_cast<double>(std::max<std::size_t>(count, 1));
    Matrix m{};
    for_each_centre([&](Vec3d p) {
        const Vec3d d = p - mean;
        const std::array<double, 3> v{d.x, d.y, d.z};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) m[i][j] += v[i] * v[j];
        }
    });
    return m;
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
    if (!clear) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

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

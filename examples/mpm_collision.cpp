// Two elastic bodies collide: a small Material Point Method simulation that writes what Inktrace
// draws. MLS-MPM with quadratic B-splines (Hu et al., A Moving Least Squares Material Point Method,
// SIGGRAPH 2018, after Sulsky, Zhou and Schreyer 1995) of a neo-Hookean solid, in 3D.
//
//     mpm_collision OUT.csv [TIME]
//     inktrace render OUT.csv --glyph box --color-by body --colormap categories -o boxes.png
//
// The table has a row for each particle: x, y, z, body, and the deformation gradient F, row by row.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  // rows

constexpr Matrix kIdentity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

Matrix multiply(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
        }
    }
    return c;
}

double determinant(const Matrix& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

struct Particle {
    Vector position, velocity;
    Matrix affine{};  // velocity gradient
    Matrix deformation = kIdentity;
    int body = 0;
};

class Simulation {
  public:
    static constexpr double kSpacing = 0.025;  // of particles, m; two to a cell's side

    Simulation() {
        add_ball({0.36, 0.48, 0.5}, 0.13, {2.2, 0, 0}, 0);
        add_ball({0.64, 0.53, 0.5}, 0.13, {-2.2, 0, 0}, 1);
    }

    void run(double seconds) {
        for (double time = 0.0; time < seconds; time += kStep) step();
    }
    const std::vector<Particle>& particles() const { return particles_; }

  private:
    static constexpr int kCells = 20;  // along a side of the unit cube
    static constexpr double kCell = 1.0 / kCells;
    static constexpr double kStep = 2e-4;       // s; sound takes 3e-3 s to cross a cell
    static constexpr double kDensity = 1000.0;  // kg/m^3
    static constexpr double kYoung = 1e5;       // Pa
    static constexpr double kPoisson = 0.3;
    static constexpr double kVolume = kSpacing * kSpacing * kSpacing;

    struct Node {
        Vector momentum{};
        double mass = 0.0;
    };
    struct Stencil {
        std::array<int, 3> base;
        std::array<Vector, 3> weights;  // of three nodes along each axis
        Vector offset;                  // of the particle from the first of them, in cells
    };

    void add_ball(Vector center, double radius, Vector velocity, int body) {
        const int reach = static_cast<int>(radius / kSpacing) + 1;
        for (int i = -reach; i < reach; ++i) {
            for (int j = -reach; j < reach; ++j) {
                for (int k = -reach; k < reach; ++k) {
                    const Vector d{(i + 0.5) * kSpacing, (j + 0.5) * kSpacing,
                                   (k + 0.5) * kSpacing};
                    if (std::hypot(d[0], d[1], d[2]) > radius) continue;
                    Particle particle;
                    particle.position = {center[0] + d[0], center[1] + d[1], center[2] + d[2]};
                    particle.velocity = velocity;
                    particle.body = body;
                    particles_.push_back(particle);
                }
            }
        }
    }

    static Stencil stencil(const Vector& position) {
        Stencil s{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double x = position[axis] / kCell;
            s.base[axis] = static_cast<int>(x - 0.5);
            const double f = x - s.base[axis];
            s.offset[axis] = f;
            s.weights[axis] = {0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1) * (f - 1),
                               0.5 * (f - 0.5) * (f - 0.5)};
        }
        return s;
    }

    /// Calls `visit(node, weight, distance)` for the 27 nodes about a particle.
    template <class Visit>
    void for_each_node(const Vector& position, const Visit& visit) {
        const Stencil s = stencil(position);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const double weight = s.weights[0][i] * s.weights[1][j] * s.weights[2][k];
                    const Vector distance{(static_cast<double>(i) - s.offset[0]) * kCell,
                                          (static_cast<double>(j) - s.offset[1]) * kCell,
                                          (static_cast<double>(k) - s.offset[2]) * kCell};
                    const auto x = static_cast<std::size_t>(s.base[0]) + i;
                    const auto y = static_cast<std::size_t>(s.base[1]) + j;
                    const auto z = static_cast<std::size_t>(s.base[2]) + k;
                    constexpr std::size_t kSide = kCells + 1;
                    visit(grid_.at((x * kSide + y) * kSide + z), weight, distance);
                }
            }
        }
    }

    /// Kirchhoff stress of a neo-Hookean solid: mu (F F^T - I) + lambda log(J) I.
    static Matrix stress(const Matrix& f) {
        const double mu = kYoung / (2 * (1 + kPoisson));
        const double lambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
        Matrix transposed{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) transposed[i][j] = f[j][i];
        }
        Matrix tau = multiply(f, transposed);
        const double pressure = lambda * std::log(std::max(determinant(f), 1e-3));
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) tau[i][j] *= mu;
            tau[i][i] += pressure - mu;
        }
        return tau;
    }

    void step() {
        grid_.assign(static_cast<std::size_t>(kCells + 1) * (kCells + 1) * (kCells + 1), {});
        constexpr double kMass = kDensity * kVolume;
        constexpr double kInertia = 4.0 / (kCell * kCell);  // of quadratic splines
        for (const Particle& p : particles_) {
            const Matrix tau = stress(p.deformation);
            for_each_node(p.position, [&](Node& node, double weight, const Vector& d) {
                node.mass += weight * kMass;
                for (std::size_t i = 0; i < 3; ++i) {
                    double momentum = kMass * p.velocity[i];
                    for (std::size_t j = 0; j < 3; ++j) {
                        momentum +=
                            (kMass * p.affine[i][j] - kStep * kVolume * kInertia * tau[i][j]) *
                            d[j];
                    }
                    node.momentum[i] += weight * momentum;
                }
            });
        }
        for (Particle& p : particles_) {
            p.velocity = {};
            p.affine = {};
            for_each_node(p.position, [&](Node& node, double weight, const Vector& d) {
                if (node.mass <= 0.0) return;
                for (std::size_t i = 0; i < 3; ++i) {
                    const double velocity = node.momentum[i] / node.mass;
                    p.velocity[i] += weight * velocity;
                    for (std::size_t j = 0; j < 3; ++j) {
                        p.affine[i][j] += weight * kInertia * velocity * d[j];
                    }
                }
            });
            Matrix change = kIdentity;
            for (std::size_t i = 0; i < 3; ++i) {
                p.position[i] += kStep * p.velocity[i];
                for (std::size_t j = 0; j < 3; ++j) change[i][j] += kStep * p.affine[i][j];
            }
            p.deformation = multiply(change, p.deformation);
        }
    }

    std::vector<Particle> particles_;
    std::vector<Node> grid_;
};

void write_csv(const std::string& file, const std::vector<Particle>& particles) {
    std::ofstream out(file);
    out.precision(5);
    out << "x,y,z,body,F11,F12,F13,F21,F22,F23,F31,F32,F33\n";
    for (const Particle& p : particles) {
        out << p.position[0] << ',' << p.position[1] << ',' << p.position[2] << ',' << p.body;
        for (const Vector& row : p.deformation) {
            for (const double value : row) out << ',' << value;
        }
        out << '\n';
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') {
        std::fprintf(stderr, "usage: mpm_collision OUT.csv [TIME]\n");
        return 2;
    }
    Simulation simulation;
    simulation.run(argc > 2 ? std::atof(argv[2]) : 0.022);
    write_csv(argv[1], simulation.particles());
}

#include "scene/bonds.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "scene/elements.h"

namespace ink {

namespace {

constexpr double kSlack = 0.45;
constexpr double kNearest = 0.4;
constexpr std::size_t kGrain = 4096;
/// More atoms than lie within reach of one in any matter.
constexpr std::size_t kMostCandidates = 4096;

using Cell = std::array<std::int64_t, 3>;

/// Atoms by the cell of a grid that they lie in. Cells share buckets by a hash: strangers in a
/// bucket are told apart by their distance, and memory does not depend on how far atoms reach.
class CellGrid {
  public:
    CellGrid(const std::vector<Vec3d>& positions, double side)
        : positions_(positions), scale_(1.0 / side) {
        mask_ = std::bit_ceil(std::max<std::size_t>(positions.size(), 1)) - 1;
        begin_.assign(mask_ + 2, 0);
        for (const Vec3d& p : positions) ++begin_[bucket(cell(p)) + 1];
        for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
        atoms_.resize(positions.size());
        std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
        for (std::uint32_t i = 0; i < positions.size(); ++i) {
            atoms_[next[bucket(cell(positions[i]))]++] = i;
        }
    }

    /// The atoms after `atom` in its cell and those about it, each once, in order.
    void candidates(std::uint32_t atom, std::vector<std::uint32_t>& found) const {
        found.clear();
        const Cell home = cell(positions_[atom]);
        std::size_t looked_at = 0;
        for (std::int64_t k = 0; k < 27; ++k) {
            const Cell at{home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1};
            const std::size_t b = bucket(at);
            for (std::uint32_t n = begin_[b]; n < begin_[b + 1]; ++n) {
                if (++looked_at > kMostCandidates) break;
                if (atoms_[n] > atom) found.push_back(atoms_[n]);
            }
        }
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
    }

  private:
    Cell cell(Vec3d p) const {
        const auto index = [&](double x) {
            return static_cast<std::int64_t>(std::floor(x * scale_));
        };
        return {index(p.x), index(p.y), index(p.z)};
    }
    std::size_t bucket(const Cell& cell) const {
        std::uint64_t hash = 0;
        for (const std::int64_t x : cell) {
            hash = (hash ^ static_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15U;
            hash ^= hash >> 32U;
        }
        return hash & mask_;
    }

    const std::vector<Vec3d>& positions_;
    double scale_;
    std::size_t mask_ = 0;
    std::vector<std::uint32_t> begin_, atoms_;
};

bool are_bonded(const Molecule& m, std::uint32_t a, std::uint32_t b) {
    constexpr std::uint8_t kHydrogen = 1;
    if (m.elements[a] == kHydrogen && m.elements[b] == kHydrogen) return false;
    const double reach = static_cast<double>(atom_radius(RadiiTable::covalent, m.elements[a])) +
                         static_cast<double>(atom_radius(RadiiTable::covalent, m.elements[b])) +
                         kSlack;
    const Vec3d d = m.positions[a] - m.positions[b];
    const double squared = dot(d, d);
    return squared < reach * reach && squared > kNearest * kNearest;
}

}  // namespace

std::vector<Bond> bonds_by_distance(const Molecule& molecule) {
    double largest = 0.0;
    for (const std::uint8_t element : molecule.elements) {
        largest = std::max<double>(largest, atom_radius(RadiiTable::covalent, element));
    }
    const CellGrid grid(molecule.positions, 2.0 * largest + kSlack);
    std::vector<Bond> bonds;
    std::mutex mutex;
    parallel_ranges(molecule.atom_count(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> near;
        std::vector<Bond> own;
        for (auto a = static_cast<std::uint32_t>(begin); a < end; ++a) {
            grid.candidates(a, near);
            for (const std::uint32_t b : near) {
                if (are_bonded(molecule, a, b)) own.push_back({a, b});
            }
        }
        const std::scoped_lock lock(mutex);
        bonds.insert(bonds.end(), own.begin(), own.end());
    });
    std::ranges::sort(bonds);
    return bonds;
}

}  // namespace ink

#include "scene/bonds.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>

#include "base/bounds.h"
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
    CellGrid(std::span<const Vec3d> positions, double side)
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

    /// The atoms in the cell of a point and those about it, each once, in order.
    void near(Vec3d point, std::vector<std::uint32_t>& found) const {
        found.clear();
        const Cell home = cell(point);
        for (std::int64_t k = 0; k < 27; ++k) {
            const std::size_t b =
                bucket({home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1});
            for (std::uint32_t n = begin_[b]; n < begin_[b + 1]; ++n) {
                if (found.size() == kMostCandidates) break;
                found.push_back(atoms_[n]);
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

    std::span<const Vec3d> positions_;
    double scale_;
    std::size_t mask_ = 0;
    std::vector<std::uint32_t> begin_, atoms_;
};

double bond_radius(std::uint8_t element) { return atom_radius(RadiiTable::covalent, element); }

/// Whether two atoms are bonded whose places differ by `apart`.
bool are_bonded(std::uint8_t element_a, std::uint8_t element_b, Vec3d apart) {
    constexpr std::uint8_t kHydrogen = 1;
    if (element_a == kHydrogen && element_b == kHydrogen) return false;
    const double reach = bond_radius(element_a) + bond_radius(element_b) + kSlack;
    const double squared = dot(apart, apart);
    return squared < reach * reach && squared > kNearest * kNearest;
}

/// Farther apart, no two atoms are bonded.
double longest_bond(std::span<const std::uint8_t> elements) {
    double largest = 0.0;
    for (const std::uint8_t element : elements) largest = std::max(largest, bond_radius(element));
    return 2.0 * largest + kSlack;
}

/// One copy of a unit.
struct Place {
    std::uint32_t unit;
    std::uint32_t first_atom;  ///< as CopyBond numbers them
    Motion motion;
};

/// What of a unit all its copies share.
struct UnitAtoms {
    std::span<const Vec3d> positions;
    std::span<const std::uint8_t> elements;
    CellGrid grid;
    Bounds3d box;  ///< of the places that bonds reach to

    UnitAtoms(const Molecule& m, const Unit& unit, double reach)
        : positions(std::span(m.positions).subspan(unit.first, unit.count)),
          elements(std::span(m.elements).subspan(unit.first, unit.count)),
          grid(positions, reach) {
        for (const Vec3d& p : positions) {
            box.add(p - Vec3d{reach, reach, reach});
            box.add(p + Vec3d{reach, reach, reach});
        }
    }
    Vec3d centre() const { return box.centre(); }
    double radius() const { return 0.5 * length(box.extent()); }
    bool reaches(Vec3d p) const {
        return p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y &&
               p.y <= box.upper.y && p.z >= box.lower.z && p.z <= box.upper.z;
    }
};

std::vector<Place> places(const std::vector<Unit>& units) {
    std::vector<Place> out;
    for (std::uint32_t u = 0; u < units.size(); ++u) {
        if (units[u].copies.empty()) out.push_back({u, 0, {}});
        for (std::size_t k = 0; k < units[u].copies.size(); ++k) {
            out.push_back(
                {u, static_cast<std::uint32_t>(k * units[u].count), units[u].copies[k].motion});
        }
    }
    return out;
}

/// Bonds from atoms of the unit at `here` to those of the one at `there`.
void find_bonds(const Place& here, const UnitAtoms& own, const Place& there, const UnitAtoms& other,
                std::vector<std::uint32_t>& near, std::vector<CopyBond>& bonds) {
    for (std::uint32_t b = 0; b < other.positions.size(); ++b) {
        const Vec3d p = there.motion(other.positions[b]);
        const Vec3d at_home = here.motion.back(p);
        if (!own.reaches(at_home)) continue;
        own.grid.near(at_home, near);
        for (const std::uint32_t a : near) {
            const Vec3d apart = here.motion(own.positions[a]) - p;
            if (!are_bonded(own.elements[a], other.elements[b], apart)) continue;
            bonds.push_back({{here.unit, here.first_atom + a}, {there.unit, there.first_atom + b}});
        }
    }
}

}  // namespace

std::vector<Bond> bonds_by_distance(std::span<const Vec3d> positions,
                                    std::span<const std::uint8_t> elements) {
    const CellGrid grid(positions, longest_bond(elements));
    std::vector<Bond> bonds;
    std::mutex mutex;
    parallel_ranges(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> near;
        std::vector<Bond> own;
        for (auto a = static_cast<std::uint32_t>(begin); a < end; ++a) {
            grid.near(positions[a], near);
            for (const std::uint32_t b : near) {
                if (b <= a || !are_bonded(elements[a], elements[b], positions[a] - positions[b])) {
                    continue;
                }
                own.push_back({a, b});
            }
        }
        const std::scoped_lock lock(mutex);
        bonds.insert(bonds.end(), own.begin(), own.end());
    });
    std::ranges::sort(bonds);
    return bonds;
}

std::vector<CopyBond> bonds_between_copies(const Molecule& molecule) {
    // Motions are rounded in files, and rigid only so far.
    constexpr double kRounding = 0.5;
    const double reach = longest_bond(molecule.elements) + kRounding;
    std::vector<UnitAtoms> units;
    for (const Unit& unit : molecule.units) units.emplace_back(molecule, unit, reach);
    const std::vector<Place> all = places(molecule.units);
    std::vector<CopyBond> bonds;
    std::mutex mutex;
    parallel_ranges(all.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> near;
        std::vector<CopyBond> own;
        for (std::size_t i = begin; i < end; ++i) {
            const UnitAtoms& here = units[all[i].unit];
            const Vec3d centre = all[i].motion(here.centre());
            for (std::size_t k = i + 1; k < all.size(); ++k) {
                const UnitAtoms& there = units[all[k].unit];
                const double apart = length(all[k].motion(there.centre()) - centre);
                if (apart > here.radius() + there.radius()) continue;
                find_bonds(all[i], here, all[k], there, near, own);
            }
        }
        const std::scoped_lock lock(mutex);
        bonds.insert(bonds.end(), own.begin(), own.end());
    });
    std::ranges::sort(bonds);
    return bonds;
}

}  // namespace ink

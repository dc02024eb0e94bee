#include "scene/sticks.h"

#include <utility>

#include "scene/bonds.h"

namespace ink {

namespace {

constexpr double kStickWithBalls = 0.14;
constexpr double kStickAlone = 0.2;
/// Of sticks between atoms of two colours, where lines would part two halves.
constexpr Rgb8 kStickColor{168, 168, 168};

/// A stick a bond, in the colour and part of its ends. Where these differ, sticks alone are two
/// halves.
class StickBuilder {
  public:
    StickBuilder(const Spheres& atoms, double radius, bool in_halves)
        : atoms_(atoms), radius_(radius), in_halves_(in_halves) {
        sticks_.shape = {.kind = GlyphKind::frustum, .capped = false};
    }

    void add(const Bond& bond) {
        const Vec3d from = to_double(atoms_.spheres[bond.a].centre);
        const Vec3d to = to_double(atoms_.spheres[bond.b].centre);
        if (from == to) return;
        if (!in_halves_ || (color(bond.a) == color(bond.b) && part(bond.a) == part(bond.b))) {
            const bool same = color(bond.a) == color(bond.b);
            add(from, to, same ? color(bond.a) : kStickColor, part(bond.a));
            return;
        }
        const Vec3d middle = (from + to) * 0.5;
        add(from, middle, color(bond.a), part(bond.a));
        add(middle, to, color(bond.b), part(bond.b));
    }
    Glyphs take() { return std::move(sticks_); }

  private:
    Rgb8 color(std::uint32_t atom) const {
        return atoms_.colors.empty() ? kStickColor : atoms_.colors[atom];
    }
    std::uint32_t part(std::uint32_t atom) const {
        return atoms_.parts.empty() ? 0 : atoms_.parts[atom];
    }
    void add(Vec3d from, Vec3d to, Rgb8 color, std::uint32_t part) {
        sticks_.placements.push_back(placement_between(from, to, radius_));
        sticks_.colors.push_back(color);
        if (!atoms_.parts.empty()) sticks_.parts.push_back(part);
    }

    const Spheres& atoms_;
    double radius_;
    bool in_halves_;
    Glyphs sticks_;
};

}  // namespace

double stick_radius(const DataSettings& settings) {
    const bool alone = settings.representation == Representation::sticks;
    return settings.stick_radius.value_or(alone ? kStickAlone : kStickWithBalls);
}

std::optional<Object> make_sticks(const Molecule& molecule, const Object& atoms,
                                  const DataSettings& settings) {
    const auto& spheres = std::get<Spheres>(atoms.shape);
    StickBuilder builder(spheres, stick_radius(settings),
                         settings.representation == Representation::sticks);
    for (const Bond& bond :
         molecule.has_bond_table ? molecule.bonds : bonds_by_distance(molecule)) {
        builder.add(bond);
    }
    Glyphs sticks = builder.take();
    if (sticks.placements.empty()) return std::nullopt;
    Object object;
    object.name = atoms.name + " bonds";
    object.kind = atoms.kind;
    object.frame = atoms.frame;
    object.shape = std::move(sticks);
    object.material = atoms.material;
    object.part_names = atoms.part_names;
    object.part_wholes = atoms.part_wholes;
    object.usual_ids = atoms.usual_ids;
    object.continues_previous = true;
    return object;
}

}  // namespace ink

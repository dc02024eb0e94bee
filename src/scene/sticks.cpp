#include "scene/sticks.h"

#include <utility>

namespace ink {

namespace {

constexpr double kStickWithBalls = 0.14;
constexpr double kStickAlone = 0.2;
/// Of sticks between atoms of two colours, where lines would part two halves.
constexpr Rgb8 kStickColor{168, 168, 168};

/// One end of a stick.
struct End {
    Vec3d place;  ///< in the frame of the atoms
    Rgb8 color;
    std::uint32_t part = 0;
};

End stored_end(const Spheres& atoms, std::size_t atom) {
    return {to_double(atoms.spheres[atom].centre),
            atoms.colors.empty() ? kStickColor : atoms.colors[atom],
            atoms.parts.empty() ? 0 : atoms.parts[atom]};
}

/// The same of an atom that copies are counted with.
End end_at(const Spheres& atoms, std::size_t atom) {
    End end = stored_end(atoms, atoms.numbering().source(atom));
    end.place = to_double(atoms.at(atom).centre);
    end.part += atoms.numbering().first_part(atom);
    return end;
}

/// A stick a bond, in the colour and part of its ends. Where these differ, sticks alone are two
/// halves.
class StickBuilder {
  public:
    explicit StickBuilder(const DataSettings& settings)
        : radius_(stick_radius(settings)),
          in_halves_(settings.representation == Representation::sticks) {
        sticks_.shape = {.kind = GlyphKind::frustum, .capped = false};
    }

    void add(const End& a, const End& b) {
        if (a.place == b.place) return;
        const bool same_color = a.color == b.color;
        if (!in_halves_ || (same_color && a.part == b.part)) {
            add(a.place, b.place, same_color ? a.color : kStickColor, a.part);
            return;
        }
        const Vec3d middle = (a.place + b.place) * 0.5;
        add(a.place, middle, a.color, a.part);
        add(middle, b.place, b.color, b.part);
        if (same_color) return;
        sticks_.other_half.resize(sticks_.placements.size());
        sticks_.other_half.end()[-2] = 1;
        sticks_.other_half.end()[-1] = -1;
    }

    /// The sticks as one thing with `atoms`.
    std::optional<Object> finish(const Object& atoms) && {
        if (sticks_.placements.empty()) return std::nullopt;
        if (!sticks_.other_half.empty()) sticks_.other_half.resize(sticks_.placements.size());
        if (!has_parts(atoms.shape)) sticks_.parts.clear();
        sticks_.parts_a_copy = numbering(atoms.shape).parts_a_copy;
        Object object;
        object.name = atoms.name + " bonds";
        object.kind = atoms.kind;
        object.frame = atoms.frame;
        object.shape = std::move(sticks_);
        object.material = atoms.material;
        object.part_names = atoms.part_names;
        object.part_wholes = atoms.part_wholes;
        object.usual_ids = atoms.usual_ids;
        object.continues_previous = true;
        return object;
    }

  private:
    void add(Vec3d from, Vec3d to, Rgb8 color, std::uint32_t part) {
        sticks_.placements.push_back(placement_between(from, to, radius_));
        sticks_.colors.push_back(color);
        sticks_.parts.push_back(part);
    }

    double radius_;
    bool in_halves_;
    Glyphs sticks_;
};

}  // namespace

double stick_radius(const DataSettings& settings) {
    const bool alone = settings.representation == Representation::sticks;
    return settings.stick_radius.value_or(alone ? kStickAlone : kStickWithBalls);
}

std::optional<Object> make_sticks(const Object& atoms, std::span<const Bond> bonds,
                                  const DataSettings& settings) {
    const auto& ends = std::get<Spheres>(atoms.shape);
    StickBuilder builder(settings);
    for (const Bond& bond : bonds) builder.add(stored_end(ends, bond.a), stored_end(ends, bond.b));
    auto sticks = std::move(builder).finish(atoms);
    if (sticks) std::get<Glyphs>(sticks->shape).copies = ends.copies;
    return sticks;
}

std::optional<Object> make_sticks(std::span<const Object> atoms, std::span<const CopyBond> bonds,
                                  const DataSettings& settings) {
    const auto end = [&](const CopyBond::End& of) {
        return end_at(std::get<Spheres>(atoms[of.unit].shape), of.atom);
    };
    StickBuilder builder(settings);
    for (const CopyBond& bond : bonds) builder.add(end(bond.a), end(bond.b));
    return std::move(builder).finish(atoms.front());
}

}  // namespace ink

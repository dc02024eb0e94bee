#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "scene/scene.h"

namespace ink {

/// How a ray leaves a surface.
enum class Bend : std::uint8_t {
    none,       ///< it ends there
    mirrored,   ///< reflected, on the side that it came from
    straight,   ///< through, unbent
    refracted,  ///< through, into or out of a solid
    inside      ///< totally reflected within a solid
};

/// The solids that a ray is inside of, the innermost last.
class Media {
  public:
    struct Solid {
        std::uint32_t object, primitive;
        float ior;
        bool is(std::uint32_t other_object, std::uint32_t other_primitive) const {
            return object == other_object && primitive == other_primitive;
        }
    };
    bool inside(std::uint32_t object, std::uint32_t primitive) const;
    double ior() const { return count_ == 0 ? 1.0 : solids_[count_ - 1].ior; }
    /// One solid too many is left out: rays go through it unbent.
    Media entered(const Solid& solid) const;
    Media left(std::uint32_t object, std::uint32_t primitive) const;

  private:
    static constexpr std::size_t kMost = 4;
    std::array<Solid, kMost> solids_{};
    std::size_t count_ = 0;
};

/// A ray that meets a surface.
struct Incidence {
    Vec3d origin, dir;    ///< `dir` of unit length; scene frame
    double t = 0.0;       ///< of the hit along it
    Vec3d facet, normal;  ///< geometric and shading normal: unit, facing the ray's origin
    std::uint32_t object = 0, primitive = 0;
    Media media;
};

/// A way on from there.
struct Branch {
    Bend bend = Bend::none;
    double share = 0.0;  ///< of the light that comes back along it
    Vec3d origin, dir;   ///< clear of the surface that it leaves; `dir` of unit length
    Media media;
};

/// What happens at a specular surface. The shares of `own`, `main` and `side` add up to 1.
struct Scattering {
    double own = 1.0;  ///< share of the surface's own colour
    Branch main;       ///< what lines follow: of material with both, the way through
    Branch side;       ///< seen but not followed by lines: the shine of glass
};

/// Geometric optics of the scene's materials, in double precision.
class Optics {
  public:
    explicit Optics(const Scene& scene);

    /// Whether any surface is specular.
    bool any() const { return any_; }
    bool is_specular(std::uint32_t object) const { return surfaces_[object].specular; }
    Scattering scatter(const Incidence& incidence) const;

  private:
    struct Surface {
        bool specular = false;
        bool thin = false;       ///< has no inside: light is not bent
        bool one_solid = false;  ///< all of its primitives together
    };
    Incidence refined(const Incidence& incidence) const;
    Branch reflected(const Incidence& at, double share) const;
    Branch transmitted(const Incidence& at, double share) const;

    const Scene& scene_;
    std::vector<Surface> surfaces_;
    bool any_ = false;
};

/// Share of unpolarised light that a smooth border between two media reflects (Fresnel): `cosine`
/// of the angle of incidence, `eta` the index of refraction on this side over that beyond.
double fresnel(double cosine, double eta);

}  // namespace ink

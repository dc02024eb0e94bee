#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "accel/projection.h"
#include "base/vec.h"
#include "scene/scene.h"
#include "shading/lighting.h"

namespace ink {

/// Where the two halves of sticks, in two colours, meet: a plane across the stick. Pixels that it
/// cuts have a share of both colours, as those along lines have; no line tells where.
class StickBorders {
  public:
    using SeenAsOne = std::function<bool(std::uint32_t object, std::uint32_t a, std::uint32_t b)>;

    /// A sample stands for a square of `spacing` pixels.
    StickBorders(const Projection& projection, float spacing);

    /// The next object of the scene. Keeps a reference to its shape. `mixes` tells of two halves
    /// whether they are smoothed.
    void add(const Object& object,
             const std::function<bool(std::uint32_t a, std::uint32_t b)>& mixes);
    bool any() const { return any_; }

    /// Mixes into the colours of halves of sticks, by area, that of their other halves.
    void mix(const SurfacePacket& surface, ColorLanes& colors) const;

  private:
    /// The halves of an object's sticks.
    struct Halves {
        const Glyphs* sticks = nullptr;  ///< null: the object has none
        /// From each to the one that goes on from it in another colour: 1, -1; 0: there is none.
        std::vector<std::int8_t> other;
    };
    struct Border;
    Border border_of(const Halves& halves, std::size_t primitive) const;
    float beyond(const Border& border, const SurfacePacket& surface, int lane) const;

    std::vector<Halves> objects_;
    bool any_ = false;
    float spacing_;
    // See Projection.
    Vec3f right_, down_, forward_, start_;
    float start_depth_, origin_step_, slope_step_;
};

}  // namespace ink

#pragma once

#include <cstdint>
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
    /// A sample stands for a square of `spacing` pixels.
    StickBorders(const Projection& projection, float spacing);

    /// The next object of the scene: its glyphs, which must outlive this, or null if it has none in
    /// colours of their own. Where `ids` tell two halves apart, a line runs between them.
    void add(const Glyphs* glyphs, IdLevel ids);
    bool any() const { return any_; }

    /// Mixes into the colours of halves of sticks, by area, that of their other halves.
    void mix(const SurfacePacket& surface, ColorLanes& colors) const;

  private:
    /// An object's sticks.
    struct Sticks {
        const Glyphs* glyphs;  ///< null: no halves of any are smoothed
        bool by_parts;         ///< only of those whose halves are of one part
    };
    struct Border;
    /// The other half of a stored one, if the border between them is smoothed, or else itself.
    static std::size_t other_half(const Sticks& sticks, std::size_t stored);
    static Border border_of(const Glyphs& glyphs, std::size_t primitive, std::size_t other);
    float beyond(const Border& border, const SurfacePacket& surface, int lane) const;

    std::vector<Sticks> objects_;
    bool any_ = false;
    float spacing_;
    // See Projection.
    Vec3f right_, down_, forward_, start_;
    float start_depth_, origin_step_, slope_step_;
};

}  // namespace ink

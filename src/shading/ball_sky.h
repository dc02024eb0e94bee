#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "base/lanes.h"
#include "base/vec.h"
#include "scene/scene.h"
#include "shading/far_sky.h"
#include "shading/lighting.h"
#include "shading/sky_directions.h"

namespace ink {

/// What there is about a ball.
struct Surroundings {
    std::vector<BallPacket> near;  ///< relative to its centre; unused lanes have no radius
    std::size_t near_count = 0;
    /// What is far, of each group of directions, as soon as it has been `seen`.
    std::vector<FarWindow> windows;
    GroupBits seen;
    GroupBits clear, shut;  ///< those where all is free, or nothing
    float window_scale;     ///< texels of the windows a unit of the scene
};

/// The spheres of a scene as what hides the sky from each other.
///
/// Near balls are looked at from each point of the surface, as discs on the sky in closed form,
/// with edges as soft as directions are apart. What begins farther away is looked up in maps, of
/// which each ball has the part that it sees through.
class BallSky {
  public:
    /// Throws Cancelled once `cancel` is true (null: never).
    BallSky(const Scene& scene, const SkyDirections& directions,
            const std::atomic<bool>* cancel = nullptr);

    /// Of balls that are no scene's.
    BallSky(std::vector<Sphere> balls, const SkyDirections& directions,
            const std::atomic<bool>* cancel = nullptr);

    /// What there is about a ball.
    void survey(const Sphere& ball, Surroundings& surroundings) const;
    /// The share of the sky that lies open above a point of the ball, weighted by the cosine to its
    /// normal `n`. `point`, relative to the ball's centre, may lie a little outside.
    float openness(const Sphere& ball, Surroundings& surroundings, Vec3f point, Vec3f n) const;
    /// The nearest sixteen balls that touch one or nearly do, in the first lanes.
    static BallPacket contacts(const Sphere& ball, const Surroundings& surroundings);
    /// The product of what each of the contacts alone would leave open: it has the steep fall of
    /// openness towards them, so that what remains varies slowly.
    static float contact_openness(const BallPacket& contacts, float radius, Vec3f n);
    /// The same at sixteen points at a time.
    static void contact_openness(const BallPacket& contacts, float radius,
                                 const NormalPacket& normals, Lanes<float>& open);

  private:
    void add_packet(const BallPacket& packet, std::size_t count, std::vector<Sphere>& enclosing);
    void build_levels(std::vector<Sphere> enclosing);
    void gather(const Sphere& ball, std::size_t level, std::size_t packet,
                Surroundings& surroundings) const;

    /// Distance from a ball's centre up to which others are near.
    float reach_of(const Sphere& ball) const;

    const SkyDirections& directions_;
    float usual_radius_ = 0.0F;      ///< mean over all balls
    std::vector<BallPacket> balls_;  ///< clusters of the scene's; unused lanes have no radius
    /// Balls about clusters, sixteen a packet, and above them levels of balls about a packet of the
    /// level below each. The last level is a single packet.
    std::vector<std::vector<BallPacket>> levels_;
    FarSky far_;
};

}  // namespace ink

#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>

#include "accel/tracer.h"
#include "base/lanes.h"
#include "camera/camera.h"
#include "shading/lighting.h"

namespace ink {

inline constexpr int kMostAmbientQuality = 5;

/// How far points of surfaces lie open to a sky all around: the share of directions above the
/// surface, weighted by the cosine to its normal, into which no part of the scene is seen. In
/// [0, 1]. Safe to use from many threads.
class AmbientOcclusion {
  public:
    virtual ~AmbientOcclusion() = default;
    virtual void openness(const SurfacePacket& surface, Lanes<float>& open) const = 0;
    /// Whether there is nothing but balls, of which hits and normals tell enough.
    virtual bool needs_normals_only() const = 0;
    /// If so, of a block of points, or a strip.
    virtual void openness(const HitPacket& hits, const NormalPacket& normals, bool is_strip,
                          Lanes<float>& open) const = 0;
};

/// Of balls that are small on the picture: whether each point is computed, or they have nodes, too.
/// These are few and far apart, which is enough for a picture of few points, as a draft is, and
/// spares nearly all of the time while a view turns.
enum class SmallBalls : std::uint8_t { by_point, by_nodes };

/// Openness that is computed where a picture first needs it and kept for the next one. It belongs
/// to surfaces, not to the picture: on spheres and triangles, at the nodes of a grid over each of
/// them, whose spacing is a power of two near three pixels. So a turned or moved camera finds most
/// of it done, and what is found does not depend on the order in which it was asked for.
class AmbientBake {
  public:
    /// `quality` in [1, kMostAmbientQuality]: each step looks into twice as many directions. Scene
    /// and tracer must outlive it. Throws Cancelled once `cancel` is true (null: never).
    AmbientBake(const Scene& scene, const Tracer& tracer, int quality,
                const std::atomic<bool>* cancel = nullptr);
    ~AmbientBake();

    /// As seen by a camera, which decides how fine the grids are. Must not outlive bake or camera.
    std::unique_ptr<AmbientOcclusion> seen_by(const Camera& camera,
                                              SmallBalls small = SmallBalls::by_point) const;

    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

/// The bake of a scene, made when it is first asked for and kept as long as quality does not
/// change. Safe to use from many threads.
class AmbientCache {
  public:
    std::shared_ptr<const AmbientBake> get(const Scene& scene, const Tracer& tracer, int quality,
                                           const std::atomic<bool>* cancel = nullptr);

  private:
    std::mutex mutex_;
    std::shared_ptr<const AmbientBake> bake_;
    int quality_ = 0;
};

}  // namespace ink

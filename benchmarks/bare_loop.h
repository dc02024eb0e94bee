#pragma once

#include <memory>

#include "base/image.h"
#include "scene/scene.h"

namespace ink::bench {

/// The unit in which costs are stated: a loop that traces one primary ray a pixel with
/// rtcIntersect16 (coherent, a packet for each 4 x 4 pixels) and does nothing with the hits.
class BareLoop {
  public:
    /// A pinhole camera: directions corner + x dx + y dy through pixel centres.
    struct Pinhole {
        Vec3f eye, corner, dx, dy;
        Size size;
    };

    explicit BareLoop(const Scene& scene);
    BareLoop(const BareLoop&) = delete;
    BareLoop& operator=(const BareLoop&) = delete;
    ~BareLoop();

    /// Traces the frame on one thread. Returns wall time in milliseconds; `hits` counts what was
    /// hit, so that no work can be left out.
    double run(const Pinhole& camera, std::size_t& hits) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ink::bench

#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "base/lanes.h"
#include "scene/scene.h"

namespace ink {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr std::uint32_t kNoObject = 0xFFFFFFFFU;

/// Sixteen rays. All values must be finite, directions of unit length.
struct RayPacket {
    Lanes<float> origin_x, origin_y, origin_z;  ///< scene frame
    Lanes<float> dir_x, dir_y, dir_z;
    Lanes<std::int32_t> active = Lanes<std::int32_t>::filled(-1);  ///< -1: trace it; 0: leave it
};

/// What sixteen rays hit first. Inactive rays miss.
struct HitPacket {
    Lanes<float> t;  ///< distance along the ray, scene units; infinity on a miss
    Lanes<float> normal_x, normal_y, normal_z;  ///< geometric, outward, of any length
    Lanes<float> u, v;                          ///< triangle: barycentric, of corners 1 and 2
    Lanes<std::uint32_t> primitive;             ///< index within the object
    Lanes<std::uint32_t> object;                ///< index within the scene; kNoObject on a miss

    static HitPacket miss() {
        HitPacket hits{};
        hits.t.fill(kInfinity);
        hits.object.fill(kNoObject);
        return hits;
    }
};

enum class Coherence : std::uint8_t {
    coherent,   ///< the rays of a packet start and go close together
    incoherent  ///< they need not
};

/// Finds the first surface along rays. Safe to call from many threads.
class Tracer {
  public:
    virtual ~Tracer() = default;

    /// Traces `rays[k]` into `hits[k]`; the spans have equal length.
    virtual void intersect(std::span<const RayPacket> rays, std::span<HitPacket> hits,
                           Coherence coherence) const = 0;
};

/// How many rays the kernel is handed at once. `widest` picks what the machine runs natively.
enum class PacketWidth : std::uint8_t { widest = 0, one = 1, eight = 8, sixteen = 16 };

/// Embree's bounding volume hierarchy over the scene, which must outlive the tracer and keep its
/// arrays in place: they are shared, not copied. Throws Error when memory runs out.
std::unique_ptr<Tracer> make_embree_tracer(const Scene& scene,
                                           PacketWidth width = PacketWidth::widest);

/// Tests every ray against every primitive in double precision: the oracle for the other tracers.
std::unique_ptr<Tracer> make_brute_force_tracer(const Scene& scene);

}  // namespace ink

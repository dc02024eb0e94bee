#pragma once

// What the files that know Embree share: embree_*.cpp and no others. Written for version 3.13;
// version 4 differs in the include path and in where intersection flags are passed.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "accel/tracer.h"
#include "scene/copies.h"

namespace ink::embree {

struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryDeleter {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, GeometryDeleter>;

/// Throws what the device has to complain about.
void check(RTCDevice device);

#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
#else
using QueryContext = RTCIntersectContext;
#endif

/// Of surfaces that coincide, the one of the lower object, then of the lower primitive is seen, as
/// in accel/screen_kernels.h. So what lies within kTouching behind the nearest hit still counts.
inline constexpr float kTouching = 5e-7F;

/// How far a ray must be followed, that Embree may come to all that counts beside a hit at `t`. It
/// finds the distance of a box as a product of places and inverse directions, in single precision:
/// the flatter the ray meets a side, the more that errs.
inline float far_enough(float t, Vec3f origin, Vec3f dir) {
    constexpr float kRounding = 5e-7F;
    float steepest = 0.0F;  // what is parallel to a side does not meet it
    for (const auto& [from, along] :
         {std::pair{origin.x, dir.x}, std::pair{origin.y, dir.y}, std::pair{origin.z, dir.z}}) {
        if (along != 0.0F) steepest = std::max(steepest, std::abs(from / along));
    }
    return t + kTouching + kRounding * steepest;
}

/// The nearest hits so far, by ray ID.
struct NearestHits {
    Lanes<float> t;
    Lanes<std::uint64_t> rank;

    /// Whether a hit takes the place of what there is.
    bool take(unsigned ray, float new_t, unsigned object, unsigned primitive) {
        const auto lane = static_cast<int>(ray);
        const std::uint64_t new_rank = static_cast<std::uint64_t>(object) << 32U | primitive;
        const float gap = new_t - t[lane];
        if (!(gap < -kTouching || (gap <= kTouching && new_rank < rank[lane]))) return false;
        t[lane] = new_t;
        rank[lane] = new_rank;
        return true;
    }
};

/// Copies, which are Embree's instances. It tells hits on them in terms of what they are copies of.
struct Instances {
    struct Copy {
        Motion motion;
        std::uint32_t first_primitive = 0;
    };
    unsigned first_id = 0;
    std::vector<Copy> copies;

    std::uint32_t primitive(unsigned instance, unsigned of_original) const {
        if (instance == RTC_INVALID_GEOMETRY_ID) return of_original;
        return copies[instance - first_id].first_primitive + of_original;
    }
    Vec3f normal(unsigned instance, Vec3f of_original) const {
        if (instance == RTC_INVALID_GEOMETRY_ID) return of_original;
        return to_float(copies[instance - first_id].motion.turn(to_double(of_original)));
    }
};

/// What Embree hands back to the functions that it calls on the way.
struct Query : QueryContext {
    SurfaceHits* hits = nullptr;  ///< if every crossing is wanted; of the ray whose ID is the index
    NearestHits* nearest = nullptr;  ///< if coincident surfaces are told apart
    const Instances* instances = nullptr;
};

/// A shape in Embree's terms, not yet committed. It shares the shape's arrays or points to it, so
/// that the shape must outlive it.
GeometryHandle make_geometry(RTCDevice device, const Spheres& shape);
GeometryHandle make_geometry(RTCDevice device, const Mesh& shape);
GeometryHandle make_geometry(RTCDevice device, const Glyphs& shape);
GeometryHandle make_geometry(RTCDevice device, const Hexahedra& shape);

}  // namespace ink::embree

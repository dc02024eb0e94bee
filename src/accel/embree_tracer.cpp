// The only file that knows Embree. Written for version 3.13; version 4 differs in the include path
// and in where intersection flags are passed.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "accel/shape_intersection.h"
#include "accel/tracer.h"
#include "base/error.h"

namespace ink {

namespace {

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

void check(RTCDevice device) {
    switch (rtcGetDeviceError(device)) {
        case RTC_ERROR_NONE: return;
        case RTC_ERROR_OUT_OF_MEMORY:
            throw Error(
                "the scene does not fit into memory; load less of it or use a larger machine");
        case RTC_ERROR_UNSUPPORTED_CPU:
            throw Error("this processor is too old for Embree, which needs SSE2 at least");
        default: throw Error("Embree could not build its hierarchy over the scene");
    }
}

#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
using OccludedArguments = RTCOccludedArguments;
constexpr RTCSceneFlags kFilterWithQuery = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
void init(OccludedArguments& args) { rtcInitOccludedArguments(&args); }
template <class Kernel, class Packet, class Arguments>
void call(const Kernel& kernel, const std::int32_t* active, RTCScene scene, Packet& packet,
          Arguments& args) {
    kernel(active, scene, &packet, &args);
}
#else
using QueryContext = RTCIntersectContext;
using OccludedArguments = RTCIntersectContext;
constexpr RTCSceneFlags kFilterWithQuery = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
void init(OccludedArguments& args) { rtcInitIntersectContext(&args); }
template <class Kernel, class Packet, class Arguments>
void call(const Kernel& kernel, const std::int32_t* active, RTCScene scene, Packet& packet,
          Arguments& args) {
    kernel(active, scene, &args, &packet);
}
#endif

/// Of surfaces that coincide, the one of the lower object, then of the lower primitive is seen, as
/// in accel/screen_kernels.h. So what lies within kTouching behind the nearest hit still counts.
constexpr float kTouching = 5e-7F;

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

/// Embree's filter: writes a crossing down and goes on as if there were none.
void record(const RTCFilterFunctionNArguments* args) {
    const auto& query = *static_cast<Query*>(args->context);
    SurfaceHits& lists = *query.hits;
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        args->valid[i] = 0;
        const unsigned n = args->N;
        const unsigned instance = RTCHitN_instID(args->hit, n, i, 0);
        const Vec3f normal{RTCHitN_Ng_x(args->hit, n, i), RTCHitN_Ng_y(args->hit, n, i),
                           RTCHitN_Ng_z(args->hit, n, i)};
        lists[RTCRayN_id(args->ray, n, i)].push_back(
            {RTCRayN_tfar(args->ray, n, i), query.instances->normal(instance, normal),
             RTCHitN_u(args->hit, n, i), RTCHitN_v(args->hit, n, i),
             query.instances->primitive(instance, RTCHitN_primID(args->hit, n, i)),
             RTCHitN_geomID(args->hit, n, i)});
    }
}

/// Embree's filter: keeps the hit that is to be seen, and looks for others that coincide with it.
void prefer_first(const RTCFilterFunctionNArguments* args) {
    const auto& query = *static_cast<Query*>(args->context);
    NearestHits& nearest = *query.nearest;
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        const unsigned n = args->N;
        float& t = RTCRayN_tfar(args->ray, n, i);
        const std::uint32_t primitive = query.instances->primitive(
            RTCHitN_instID(args->hit, n, i, 0), RTCHitN_primID(args->hit, n, i));
        if (nearest.take(RTCRayN_id(args->ray, n, i), t, RTCHitN_geomID(args->hit, n, i),
                         primitive)) {
            t += kTouching;
        } else {
            args->valid[i] = 0;
        }
    }
}

/// Embree reads 16 bytes at every vertex, so the last of them must not end its page: shared buffers
/// of 12-byte vertices need four bytes behind the end, which a vector's slack does not promise.
GeometryHandle make_triangles(RTCDevice device, const Mesh& mesh) {
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* vertices = static_cast<Vec3f*>(
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Vec3f), mesh.vertices.size()));
    check(device);
    std::ranges::copy(mesh.vertices, vertices);
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, sizeof(Mesh::Triangle),
                               mesh.triangles.size());
    return geometry;
}

GeometryHandle make_spheres(RTCDevice device, const Spheres& spheres) {
    static_assert(sizeof(Sphere) == 16, "Embree reads a sphere as four floats");
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               spheres.spheres.data(), 0, sizeof(Sphere), spheres.spheres.size());
    return geometry;
}

/// Exact surfaces are Embree's user geometry: it asks for the bounds of a primitive, and for its
/// intersection with up to 16 rays at a time. `meet(shape, primitive)` gives what takes a ray and
/// its range and returns a hit.
template <class Shape, class Meet>
struct UserShape {
    static void bounds(const RTCBoundsFunctionArguments* args) {
        const auto& shape = *static_cast<const Shape*>(args->geometryUserPtr);
        const Bounds3f box = Meet::bounds(shape, args->primID);
        // Embree leaves out a primitive whose lower bound lies above its upper one.
        *args->bounds_o = {box.lower.x, box.lower.y, box.lower.z, 0.0F,
                           box.upper.x, box.upper.y, box.upper.z, 0.0F};
    }

    static void intersect(const RTCIntersectFunctionNArguments* args) {
        const auto& shape = *static_cast<const Shape*>(args->geometryUserPtr);
        const Meet meet(shape, args->primID);
        const auto& query = *static_cast<const Query*>(args->context);
        SurfaceHits* const all = query.hits;
        NearestHits* const nearest = query.nearest;
        const unsigned instance = query.instID[0];
        const std::uint32_t primitive = query.instances->primitive(instance, args->primID);
        const unsigned width = args->N;
        RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, width);
        RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, width);
        for (unsigned i = 0; i < width; ++i) {
            if (args->valid[i] == 0) continue;
            const ShapeRay ray{{RTCRayN_org_x(rays, width, i), RTCRayN_org_y(rays, width, i),
                                RTCRayN_org_z(rays, width, i)},
                               {RTCRayN_dir_x(rays, width, i), RTCRayN_dir_y(rays, width, i),
                                RTCRayN_dir_z(rays, width, i)}};
            if (all != nullptr) {
                record_all(ray, meet, *args, (*all)[RTCRayN_id(rays, width, i)]);
                continue;
            }
            float& far = RTCRayN_tfar(rays, width, i);
            const auto hit = meet(ray, RTCRayN_tnear(rays, width, i), far);
            if (!hit) continue;
            const auto t = static_cast<float>(hit->t);
            if (nearest == nullptr) {
                far = t;
            } else if (nearest->take(RTCRayN_id(rays, width, i), t, args->geomID, primitive)) {
                far = t + kTouching;
            } else {
                continue;
            }
            const Vec3f normal = to_float(normalize(hit->normal));
            RTCHitN_Ng_x(hits, width, i) = normal.x;
            RTCHitN_Ng_y(hits, width, i) = normal.y;
            RTCHitN_Ng_z(hits, width, i) = normal.z;
            RTCHitN_u(hits, width, i) = 0.0F;
            RTCHitN_v(hits, width, i) = 0.0F;
            RTCHitN_primID(hits, width, i) = args->primID;
            RTCHitN_geomID(hits, width, i) = args->geomID;
            RTCHitN_instID(hits, width, i, 0) = instance;
        }
    }

    static void record_all(const ShapeRay& ray, const Meet& meet,
                           const RTCIntersectFunctionNArguments& args,
                           std::vector<SurfaceHit>& hits) {
        constexpr double kStep = 1e-9;  // in a scene of size 1
        const auto& query = *static_cast<const Query*>(args.context);
        const unsigned instance = query.instID[0];
        double near = 0.0;
        while (const auto hit = meet(ray, near, double{kInfinity})) {
            const Vec3f normal = to_float(normalize(hit->normal));
            hits.push_back({static_cast<float>(hit->t), query.instances->normal(instance, normal),
                            0.0F, 0.0F, query.instances->primitive(instance, args.primID),
                            args.geomID});
            near = hit->t + kStep * (1.0 + hit->t);
        }
    }

    static void occluded(const RTCOccludedFunctionNArguments* args) {
        const auto& shape = *static_cast<const Shape*>(args->geometryUserPtr);
        const Meet meet(shape, args->primID);
        const unsigned width = args->N;
        for (unsigned i = 0; i < width; ++i) {
            if (args->valid[i] == 0) continue;
            const ShapeRay ray{
                {RTCRayN_org_x(args->ray, width, i), RTCRayN_org_y(args->ray, width, i),
                 RTCRayN_org_z(args->ray, width, i)},
                {RTCRayN_dir_x(args->ray, width, i), RTCRayN_dir_y(args->ray, width, i),
                 RTCRayN_dir_z(args->ray, width, i)}};
            float& far = RTCRayN_tfar(args->ray, width, i);
            if (meet(ray, RTCRayN_tnear(args->ray, width, i), far)) far = -kInfinity;
        }
    }

    static GeometryHandle make(RTCDevice device, const Shape& shape, std::size_t count) {
        GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
        rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(count));
        rtcSetGeometryUserData(geometry.get(), const_cast<Shape*>(&shape));
        rtcSetGeometryBoundsFunction(geometry.get(), bounds, nullptr);
        rtcSetGeometryIntersectFunction(geometry.get(), intersect);
        rtcSetGeometryOccludedFunction(geometry.get(), occluded);
        return geometry;
    }
};

struct MeetGlyph {
    MeetGlyph(const Glyphs& glyphs, unsigned i) : placed(glyphs.shape, glyphs.placements[i]) {}
    auto operator()(const ShapeRay& ray, double near, double far) const {
        return placed.intersect(ray, near, far);
    }
    static Bounds3f bounds(const Glyphs& glyphs, unsigned i) {
        return glyph_bounds(glyphs.shape, glyphs.placements[i]);
    }
    PlacedShape placed;
};

struct MeetHexahedron {
    MeetHexahedron(const Hexahedra& solids, unsigned i) : corners(solids.corners[i]) {}
    auto operator()(const ShapeRay& ray, double near, double far) const {
        return intersect(corners, ray, near, far);
    }
    static Bounds3f bounds(const Hexahedra& solids, unsigned i) {
        return hexahedron_bounds(solids.corners[i]);
    }
    const Hexahedra::Corners& corners;
};

GeometryHandle make_geometry(RTCDevice device, const Spheres& shape) {
    return make_spheres(device, shape);
}
GeometryHandle make_geometry(RTCDevice device, const Mesh& shape) {
    return make_triangles(device, shape);
}
GeometryHandle make_geometry(RTCDevice device, const Glyphs& shape) {
    return UserShape<Glyphs, MeetGlyph>::make(device, shape, shape.placements.size());
}
GeometryHandle make_geometry(RTCDevice device, const Hexahedra& shape) {
    return UserShape<Hexahedra, MeetHexahedron>::make(device, shape, shape.corners.size());
}

PacketWidth widest_native(RTCDevice device) {
    const auto native = [&](RTCDeviceProperty property) {
        return rtcGetDeviceProperty(device, property) != 0;
    };
    if (native(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return PacketWidth::sixteen;
    if (native(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) return PacketWidth::eight;
    return PacketWidth::four;  // wherever Embree runs
}

/// Sets what is alike for all rays and left alone by Embree.
template <int Width, class Rays>
void prepare_rays(Rays& rays) {
    for (int i = 0; i < Width; ++i) {
        rays.tnear[i] = 0.0F;
        rays.time[i] = 0.0F;
        rays.mask[i] = ~0U;
        rays.flags[i] = 0;
    }
}

template <class RayHit, int Width>
void prepare(RayHit& packet) {
    prepare_rays<Width>(packet.ray);
}

/// Copies lanes [first, first + Width) of a packet into Embree's layout of that width.
template <int Width, class Rays>
void load_rays(const RayPacket& rays, int first, Rays& out) {
    const auto copy = [&](auto* to, const auto& from) {
        std::memcpy(to, from.data() + first, sizeof(*to) * Width);
    };
    copy(out.org_x, rays.origin_x);
    copy(out.org_y, rays.origin_y);
    copy(out.org_z, rays.origin_z);
    copy(out.dir_x, rays.dir_x);
    copy(out.dir_y, rays.dir_y);
    copy(out.dir_z, rays.dir_z);
}

/// The same, ready to look for the nearest hit at any distance.
template <class RayHit, int Width>
void load(const RayPacket& rays, int first, RayHit& out) {
    load_rays<Width>(rays, first, out.ray);
    for (int i = 0; i < Width; ++i) {
        out.ray.tfar[i] = kInfinity;
        out.ray.id[i] = static_cast<unsigned>(first + i);
        out.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        out.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
}

/// `t`: of the hits, from lane `first`.
template <class RayHit, int Width>
void store(const RayHit& in, const float* t, int first, const Instances& instances,
           HitPacket& hits) {
    const auto copy = [&](auto& to, const auto* from) {
        std::memcpy(to.data() + first, from, sizeof(*from) * Width);
    };
    copy(hits.t, t);
    copy(hits.normal_x, in.hit.Ng_x);
    copy(hits.normal_y, in.hit.Ng_y);
    copy(hits.normal_z, in.hit.Ng_z);
    copy(hits.u, in.hit.u);
    copy(hits.v, in.hit.v);
    copy(hits.primitive, in.hit.primID);
    copy(hits.object, in.hit.geomID);
    if (instances.copies.empty()) return;
    for (int i = 0; i < Width; ++i) {
        const unsigned instance = in.hit.instID[0][i];
        const Vec3f normal =
            instances.normal(instance, {in.hit.Ng_x[i], in.hit.Ng_y[i], in.hit.Ng_z[i]});
        hits.normal_x[first + i] = normal.x;
        hits.normal_y[first + i] = normal.y;
        hits.normal_z[first + i] = normal.z;
        hits.primitive[first + i] = instances.primitive(instance, in.hit.primID[i]);
    }
}

/// Embree's matrix: the columns of the rotation, then the shift.
std::array<float, 12> to_columns(const Motion& motion) {
    std::array<float, 12> columns{};
    for (std::size_t k = 0; k < 9; ++k) {
        columns[3 * (k % 3) + k / 3] = static_cast<float>(motion.rotation[k]);
    }
    const Vec3f shift = to_float(motion.shift);
    columns[9] = shift.x;
    columns[10] = shift.y;
    columns[11] = shift.z;
    return columns;
}

class EmbreeTracer final : public Tracer {
  public:
    EmbreeTracer(const Scene& scene, PacketWidth width, const ObjectFilter& wanted)
        : device_(rtcNewDevice(nullptr)) {
        check(device_.get());
        width_ = width == PacketWidth::widest ? widest_native(device_.get()) : width;
        scene_.reset(rtcNewScene(device_.get()));
        // Watertight between triangles: bisection homes in on their edges, where a crack would show
        // what lies behind as a jump in depth.
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST | kFilterWithQuery);
        instances_.first_id = static_cast<unsigned>(scene.objects().size());
        for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
            const Object& object = scene.objects()[i];
            if (wanted && !wanted(object)) continue;
            attach(object, i);
            any_flat_ |= !std::holds_alternative<Spheres>(object.shape);
        }
        rtcCommitScene(scene_.get());
        check(device_.get());
    }

    void intersect(std::span<const RayPacket> rays, std::span<HitPacket> hits,
                   Coherence coherence) const override {
        intersect(rays, hits, coherence, nullptr);
    }

    void cross(const RayPacket& rays, SurfaceHits& hits) const override {
        for (auto& list : hits) list.clear();
        HitPacket nearest;  // of which there is none: all are passed over
        intersect({&rays, 1}, {&nearest, 1}, Coherence::coherent, &hits);
    }

    void occluded(std::span<const RayPacket> rays, std::span<const Lanes<float>> reach,
                  std::span<Lanes<std::int32_t>> blocked) const override {
        switch (width_) {
            case PacketWidth::sixteen:
                return block<RTCRay16, 16>(rays, reach, blocked,
                                           [](auto&&... a) { rtcOccluded16(a...); });
            case PacketWidth::eight:
                return block<RTCRay8, 8>(rays, reach, blocked,
                                         [](auto&&... a) { rtcOccluded8(a...); });
            default:
                return block<RTCRay4, 4>(rays, reach, blocked,
                                         [](auto&&... a) { rtcOccluded4(a...); });
        }
    }

  private:
    /// `all`: null, or the crossings of the one packet that is traced.
    void intersect(std::span<const RayPacket> rays, std::span<HitPacket> hits, Coherence coherence,
                   SurfaceHits* all) const {
        switch (width_) {
            case PacketWidth::sixteen:
                return trace<RTCRayHit16, 16>(rays, hits, coherence, all, [](auto&&... arguments) {
                    rtcIntersect16(arguments...);
                });
            case PacketWidth::eight:
                return trace<RTCRayHit8, 8>(rays, hits, coherence, all, [](auto&&... arguments) {
                    rtcIntersect8(arguments...);
                });
            default:
                return trace<RTCRayHit4, 4>(rays, hits, coherence, all, [](auto&&... arguments) {
                    rtcIntersect4(arguments...);
                });
        }
    }

    void attach(const Object& object, std::uint32_t index) {
        const GeometryHandle geometry = std::visit(
            [&](const auto& shape) { return make_geometry(device_.get(), shape); }, object.shape);
        check(device_.get());
        rtcCommitGeometry(geometry.get());
        const CopyNumbering numbers = numbering(object.shape);
        if (!numbers.copies.empty()) return attach_copies(numbers, geometry.get(), index);
        rtcAttachGeometryByID(scene_.get(), geometry.get(), index);
    }

    /// One hierarchy, placed by each motion.
    void attach_copies(const CopyNumbering& numbers, RTCGeometry geometry, std::uint32_t index) {
        SceneHandle original(rtcNewScene(device_.get()));
        rtcSetSceneFlags(original.get(), RTC_SCENE_FLAG_ROBUST | kFilterWithQuery);
        rtcAttachGeometryByID(original.get(), geometry, index);
        rtcCommitScene(original.get());
        for (std::size_t k = 0; k < numbers.copies.size(); ++k) {
            const Motion& motion = numbers.copies[k].motion;
            const GeometryHandle instance(
                rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
            rtcSetGeometryInstancedScene(instance.get(), original.get());
            rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                                    to_columns(motion).data());
            rtcCommitGeometry(instance.get());
            const auto number = static_cast<unsigned>(instances_.copies.size());
            rtcAttachGeometryByID(scene_.get(), instance.get(), instances_.first_id + number);
            instances_.copies.push_back(
                {motion, static_cast<std::uint32_t>(k * numbers.originals)});
        }
        originals_.push_back(std::move(original));
    }

    /// Made of `query`, which must outlive it: the arguments of Embree 4, the context of Embree 3.
    /// `hits`: null unless every crossing is wanted.
#if RTC_VERSION_MAJOR >= 4
    RTCIntersectArguments arguments(Coherence coherence, Query& query, SurfaceHits* hits,
                                    NearestHits* nearest) const {
        rtcInitRayQueryContext(&query);
        RTCIntersectArguments args;
        rtcInitIntersectArguments(&args);
        if (coherence == Coherence::coherent) args.flags = RTC_RAY_QUERY_FLAG_COHERENT;
        args.context = &query;
        query.hits = hits;
        query.nearest = nearest;
        query.instances = &instances_;
        if (hits == nullptr && nearest == nullptr) return args;
        args.filter = hits != nullptr ? record : prefer_first;
        args.flags =
            static_cast<RTCRayQueryFlags>(args.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
        return args;
    }
#else
    QueryContext& arguments(Coherence coherence, Query& query, SurfaceHits* hits,
                            NearestHits* nearest) const {
        rtcInitIntersectContext(&query);
        if (coherence == Coherence::coherent) query.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        query.hits = hits;
        query.nearest = nearest;
        query.instances = &instances_;
        if (hits != nullptr) query.filter = record;
        if (nearest != nullptr) query.filter = prefer_first;
        return query;
    }
#endif

    template <class Rays, int Width, class Kernel>
    void block(std::span<const RayPacket> rays, std::span<const Lanes<float>> reach,
               std::span<Lanes<std::int32_t>> blocked, const Kernel& kernel) const {
        OccludedArguments args;
        init(args);
        alignas(64) Rays packet{};
        prepare_rays<Width>(packet);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            for (int first = 0; first < kLanes; first += Width) {
                load_rays<Width>(rays[k], first, packet);
                std::memcpy(packet.tfar, reach[k].data() + first, sizeof(float) * Width);
                const std::int32_t* active = rays[k].active.data() + first;
                call(kernel, active, scene_.get(), packet, args);
                // Embree marks what is blocked by a distance below zero.
                for (int i = 0; i < Width; ++i) {
                    blocked[k][first + i] = active[i] != 0 && packet.tfar[i] < 0.0F ? -1 : 0;
                }
            }
        }
    }

    template <class RayHit, int Width, class Kernel>
    void trace(std::span<const RayPacket> rays, std::span<HitPacket> hits, Coherence coherence,
               SurfaceHits* all, const Kernel& kernel) const {
        Query query;
        NearestHits nearest;
        const bool told_apart = tells_apart(coherence, all);
        auto&& args = arguments(coherence, query, all, told_apart ? &nearest : nullptr);
        alignas(64) RayHit packet{};  // Embree leaves the hit of a ray that misses as it was
        prepare<RayHit, Width>(packet);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            nearest.t.fill(kInfinity);
            for (int first = 0; first < kLanes; first += Width) {
                load<RayHit, Width>(rays[k], first, packet);
                call(kernel, rays[k].active.data() + first, scene_.get(), packet, args);
                store<RayHit, Width>(packet,
                                     told_apart ? nearest.t.data() + first : packet.ray.tfar, first,
                                     instances_, hits[k]);
            }
        }
    }

    /// Where it matters which of two surfaces is seen, and there may be some that coincide.
    bool tells_apart(Coherence coherence, const SurfaceHits* all) const {
        return any_flat_ && all == nullptr && coherence == Coherence::coherent;
    }

    DeviceHandle device_;
    SceneHandle scene_;
    std::vector<SceneHandle> originals_;  ///< of the instances
    Instances instances_;
    bool any_flat_ = false;  ///< objects other than spheres
    PacketWidth width_ = PacketWidth::four;
};

static_assert(RTC_INVALID_GEOMETRY_ID == kNoObject);

}  // namespace

std::unique_ptr<Tracer> make_embree_tracer(const Scene& scene, PacketWidth width,
                                           const ObjectFilter& wanted) {
    return std::make_unique<EmbreeTracer>(scene, width, wanted);
}

}  // namespace ink

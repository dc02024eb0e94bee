#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "accel/embree_geometry.h"
#include "accel/tracer.h"

namespace ink::embree {

namespace {

#if RTC_VERSION_MAJOR >= 4
using OccludedArguments = RTCOccludedArguments;
constexpr RTCSceneFlags kFilterWithQuery = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
void init(OccludedArguments& args) { rtcInitOccludedArguments(&args); }
template <class Kernel, class Packet, class Arguments>
void call(const Kernel& kernel, const std::int32_t* active, RTCScene scene, Packet& packet,
          Arguments& args) {
    kernel(active, scene, &packet, &args);
}
#else
using OccludedArguments = RTCIntersectContext;
constexpr RTCSceneFlags kFilterWithQuery = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
void init(OccludedArguments& args) { rtcInitIntersectContext(&args); }
template <class Kernel, class Packet, class Arguments>
void call(const Kernel& kernel, const std::int32_t* active, RTCScene scene, Packet& packet,
          Arguments& args) {
    kernel(active, scene, &args, &packet);
}
#endif

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
            t = far_enough(t,
                           {RTCRayN_org_x(args->ray, n, i), RTCRayN_org_y(args->ray, n, i),
                            RTCRayN_org_z(args->ray, n, i)},
                           {RTCRayN_dir_x(args->ray, n, i), RTCRayN_dir_y(args->ray, n, i),
                            RTCRayN_dir_z(args->ray, n, i)});
        } else {
            args->valid[i] = 0;
        }
    }
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
        // Wider ones Embree takes apart, and traces those rays as well that are not active.
        width_ = widest_native(device_.get());
        if (width != PacketWidth::widest) width_ = std::min(width_, width);
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
        const bool told_apart = tells_apart(all);
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
    bool tells_apart(const SurfaceHits* all) const { return any_flat_ && all == nullptr; }

    DeviceHandle device_;
    SceneHandle scene_;
    std::vector<SceneHandle> originals_;  ///< of the instances
    Instances instances_;
    bool any_flat_ = false;  ///< objects other than spheres
    PacketWidth width_ = PacketWidth::four;
};

static_assert(RTC_INVALID_GEOMETRY_ID == kNoObject);

}  // namespace

}  // namespace ink::embree

namespace ink {

std::unique_ptr<Tracer> make_embree_tracer(const Scene& scene, PacketWidth width,
                                           const ObjectFilter& wanted) {
    return std::make_unique<embree::EmbreeTracer>(scene, width, wanted);
}

}  // namespace ink

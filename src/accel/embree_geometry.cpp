#include "accel/embree_geometry.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/shape_intersection.h"
#include "base/error.h"

namespace ink::embree {

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

namespace {

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
                far = far_enough(t, to_float(ray.origin), to_float(ray.dir));
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

}  // namespace

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

}  // namespace ink::embree

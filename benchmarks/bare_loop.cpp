#include "bare_loop.h"

#include <embree3/rtcore.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <variant>

#include "base/error.h"
#include "base/lanes.h"
#include "base/multiversion.h"

namespace ink::bench {

struct BareLoop::Impl {
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);

    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

namespace {

/// Copies are written out: the loop is to be as plain as can be.
RTCGeometry make_geometry(RTCDevice device, const Spheres& shape) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* spheres = static_cast<Sphere*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(Sphere), shape.count()));
    for (std::size_t k = 0; k < shape.count(); ++k) spheres[k] = shape.at(k);
    return geometry;
}

RTCGeometry make_geometry(RTCDevice device, const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Vec3f), mesh.vertices.size()));
    std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, sizeof(Mesh::Triangle),
                               mesh.triangles.size());
    return geometry;
}

template <class Shape>
RTCGeometry make_geometry(RTCDevice /*device*/, const Shape& /*shape*/) {
    throw Error("the bare loop traces spheres and triangles only");
}

INKTRACE_MULTIVERSION
void make_rays(const BareLoop::Pinhole& camera, int x0, int y0, RTCRayHit16& packet) {
    for (int i = 0; i < kLanes; ++i) {
        const float x = static_cast<float>(x0 + i % kBlockSide) + 0.5F;
        const float y = static_cast<float>(y0 + i / kBlockSide) + 0.5F;
        const float dx = camera.corner.x + x * camera.dx.x + y * camera.dy.x;
        const float dy = camera.corner.y + x * camera.dx.y + y * camera.dy.y;
        const float dz = camera.corner.z + x * camera.dx.z + y * camera.dy.z;
        const float scale = 1.0F / std::sqrt(dx * dx + dy * dy + dz * dz);
        packet.ray.org_x[i] = camera.eye.x;
        packet.ray.org_y[i] = camera.eye.y;
        packet.ray.org_z[i] = camera.eye.z;
        packet.ray.dir_x[i] = dx * scale;
        packet.ray.dir_y[i] = dy * scale;
        packet.ray.dir_z[i] = dz * scale;
        packet.ray.tnear[i] = 0.0F;
        packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
        packet.ray.time[i] = 0.0F;
        packet.ray.mask[i] = ~0U;
        packet.ray.flags[i] = 0;
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
}

}  // namespace

BareLoop::BareLoop(const Scene& scene) : impl_(std::make_unique<Impl>()) {
    for (const Object& object : scene.objects()) {
        RTCGeometry geometry = std::visit(
            [&](const auto& shape) { return make_geometry(impl_->device, shape); }, object.shape);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(impl_->scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(impl_->scene);
}

BareLoop::~BareLoop() = default;

double BareLoop::run(const Pinhole& camera, std::size_t& hits) const {
    alignas(64) std::int32_t valid[kLanes];
    std::fill_n(valid, kLanes, -1);
    alignas(64) RTCRayHit16 packet{};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;

    const auto start = std::chrono::steady_clock::now();
    std::size_t count = 0;
    for (int y = 0; y < camera.size.height; y += kBlockSide) {
        for (int x = 0; x < camera.size.width; x += kBlockSide) {
            make_rays(camera, x, y, packet);
            rtcIntersect16(valid, impl_->scene, &context, &packet);
            for (int i = 0; i < kLanes; ++i) {
                count += packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
            }
        }
    }
    hits = count;
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    return time.count();
}

}  // namespace ink::bench

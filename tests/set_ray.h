#pragma once

#include "accel/tracer.h"

namespace ink::test {

inline void set_ray(RayPacket& rays, int lane, Vec3f origin, Vec3f dir) {
    rays.origin_x[lane] = origin.x;
    rays.origin_y[lane] = origin.y;
    rays.origin_z[lane] = origin.z;
    rays.dir_x[lane] = dir.x;
    rays.dir_y[lane] = dir.y;
    rays.dir_z[lane] = dir.z;
}

}  // namespace ink::test

#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "base/vec.h"

namespace ink {

/// Tells surfaces apart: one ball or triangle from another, whatever geometry they belong to.
struct SurfaceKey {
    static constexpr std::uint32_t kNothing = 0xFFFFFFFFU;

    std::uint32_t object = kNothing, primitive = 0;  ///< the object of a miss: kNothing
    friend bool operator==(const SurfaceKey&, const SurfaceKey&) = default;
};

/// Asks which surfaces rays hit: as many out as points in.
using IdentifyFunction =
    std::function<void(std::span<const Vec2f> points, std::span<SurfaceKey> out)>;

}  // namespace ink

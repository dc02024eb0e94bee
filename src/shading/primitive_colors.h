#pragma once

#include <array>
#include <cstdint>

#include "accel/tracer.h"
#include "base/color.h"
#include "shading/lighting.h"

namespace ink {

/// Every 8-bit sRGB value as linear light.
using LinearTable = std::array<float, 256>;
const LinearTable& linear_table();

inline Color decode(Rgb8 color) {
    const LinearTable& table = linear_table();
    return {table[color.r], table[color.g], table[color.b]};
}

/// Of an object each of whose primitives has a colour.
struct PrimitiveColors {
    const Rgb8* colors = nullptr;
    std::uint32_t a_copy = 0;  ///< primitives that share their colours with copies; 0: none do

    Rgb8 of(std::uint32_t primitive) const {
        return colors[a_copy == 0 ? primitive : primitive % a_copy];
    }
};

/// Linear colours of what a packet saw of one object; black where it saw nothing.
void look_up(const PrimitiveColors& colors, const HitPacket& hits, ColorLanes& lanes);

}  // namespace ink

#pragma once

#include <cstdint>
#include <span>

#include "scene/scene.h"

namespace ink {

/// What it takes to make objects ready for rays.
struct Cost {
    double stored_bytes = 0.0;   ///< of the objects, which are there
    double build_bytes = 0.0;    ///< that building takes beside them, at most
    double build_seconds = 0.0;  ///< with all threads
    /// What ambient light takes beside that, where there is any.
    double ambient_bytes = 0.0;
    double ambient_seconds = 0.0;

    std::uint64_t bytes() const {
        return static_cast<std::uint64_t>(stored_bytes + build_bytes + ambient_bytes);
    }
};
Cost cost_of(std::span<const Object> objects);

/// Throws Error where there is not as much memory: memory is granted before it is there, and a
/// scene that is too large would get the program killed on the way.
void check_memory(const Cost& cost);

}  // namespace ink

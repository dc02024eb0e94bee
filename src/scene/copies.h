#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "scene/motion.h"

namespace ink {

/// One of the places where all primitives of a shape are drawn.
struct Copy {
    Motion motion;             ///< in the frame of the shape
    std::uint32_t number = 0;  ///< among all copies of an assembly, from 0; names its parts
};

/// Primitives that are stored once and drawn once for each of `copies`. They are numbered copy by
/// copy.
struct CopyNumbering {
    std::span<const Copy> copies;    ///< empty: once, as they are
    std::size_t originals = 0;       ///< that are stored
    std::uint32_t parts_a_copy = 0;  ///< parts of copy number k are k times this on; 0: shared

    std::size_t count() const { return originals * std::max<std::size_t>(copies.size(), 1); }
    /// The stored primitive that a primitive is a copy of.
    std::size_t source(std::size_t primitive) const {
        return copies.empty() ? primitive : narrow(primitive) % narrow(originals);
    }
    /// Which of `copies` a primitive belongs to, of which there must be some.
    const Copy& copy(std::size_t primitive) const {
        return copies[narrow(primitive) / narrow(originals)];
    }
    /// Where the parts of its copy begin.
    std::uint32_t first_part(std::size_t primitive) const {
        return copies.empty() || parts_a_copy == 0 ? 0 : copy(primitive).number * parts_a_copy;
    }

  private:
    /// Primitives are numbered in 32 bits, which divide in a third of the time.
    static std::uint32_t narrow(std::size_t number) { return static_cast<std::uint32_t>(number); }
};

}  // namespace ink

#pragma once

#include "base/color.h"

namespace ink {

/// How a surface answers light.
struct Material {
    Rgb8 color{204, 204, 204};  ///< diffuse, where primitives bring no colour of their own
};

}  // namespace ink

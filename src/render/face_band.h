#pragma once

namespace ink {

/// How lines between faces are drawn in a block of pixels.
struct FaceBand {
    float half;  ///< of their width, pixels
    float opacity;
};

}  // namespace ink

#pragma once

#include "base/lanes.h"

namespace ink {

/// How lines between faces are drawn in sixteen blocks of pixels side by side.
struct RowBands {
    Lanes<float> half;  ///< of their width, pixels, a block
    float opacity;
};

}  // namespace ink

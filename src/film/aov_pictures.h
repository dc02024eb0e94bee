#pragma once

#include <string>
#include <vector>

#include "base/image.h"

namespace ink {

struct AovPicture {
    std::string name;  ///< "depth"
    DisplayImage image;
};

/// AOV planes as pictures to look at (Choudhury and Parker 2009, figure 5): IDs in hashed colours,
/// normals and positions with x, y, z as red, green, blue, depths from white (near) to dark (far),
/// line strength as grey. Colour channels are left out.
std::vector<AovPicture> aov_pictures(const ChannelImage& channels);

}  // namespace ink

#pragma once

#include "render/settings.h"

namespace ink {

/// The settings of the same picture at `factor` times the size (at least one pixel): lengths in
/// pixels grow with it, and so do the pixels of a point or millimetre.
Settings scaled(const Settings& settings, double factor);

}  // namespace ink

#pragma once

#include "camera/camera.h"

namespace ink {

/// Share of the half of the picture on one side that the scene may fill: what a legend has not
/// taken there, less the margin.
double fit_beside(double taken, double margin);

/// The view of a camera with all that it chose written out: eye, look-at, up and the height of an
/// orthographic view. Other scenes, such as further frames, are then seen from the same place.
ViewSettings explicit_view(const Camera& camera, const Scene& scene, const ViewSettings& settings);

/// The view of a camera that goes round the scene: the one that the settings ask for, its eye
/// turned by `turn_deg` about the picture's vertical through the middle of the scene, as far away
/// as the scene needs from every side, and as far aside as it needs to stay beside a legend. Throws
/// UsageError as Camera does.
ViewSettings turntable_view(const Scene& scene, const ViewSettings& settings, Size size,
                            double turn_deg);

}  // namespace ink

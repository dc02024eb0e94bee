#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace inktrace {

/// A line of a picture, from one junction to the next or round to its own start.
struct Polyline {
    std::string type;  ///< "silhouette", "intersection", "self-occlusion", "crease", ...
    /// What is on its left and on its right, going along the points (y points down): numbers that
    /// are equal for the same geometry, 0 for the background, and names such as "1crn A C 17".
    std::uint32_t left = 0, right = 0;
    std::string left_name, right_name;
    int level = 0;              ///< by way of how many mirrors or transparent surfaces it is seen
    bool left_in_front = true;  ///< which of them is nearer to the viewer
    bool hidden = false;        ///< on surfaces behind others
    bool closed = false;        ///< runs on from the last point to the first
    double strength = 1.0;      ///< mean, [0, 1]; below 1 for creases of small angle and ridges
    /// Pixels: x right, y down, from the upper left corner of the picture. Lines go on a little
    /// beyond its edges. Polylines that meet share the point exactly.
    std::vector<std::array<float, 2>> points;
    std::vector<float> depth;      ///< of the nearer side at each point, as the AOV Z
    std::vector<float> strengths;  ///< at each point; all 1 but for creases and ridges
};

}  // namespace inktrace

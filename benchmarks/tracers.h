#pragma once

#include <functional>
#include <string>
#include <vector>

namespace ink::bench {

/// The same frame on one thread with camera rays traced by what the screen shows, and by Embree.
struct TracerRow {
    std::string scene, what;
    double screen_ms, embree_ms;  ///< medians
    double ratio;                 ///< median over rounds of screen / Embree
    double threads_ratio;         ///< by the screen on one thread / on two
};

/// Measures scenes of all kinds, from near and from afar, and files: molecules also as balls and
/// sticks and as sticks, particles also as boxes. Calls `done` after each row. Throws InputError.
void measure_tracers(const std::vector<std::string>& files, int side, int rounds,
                     const std::function<void(const TracerRow&)>& done);

}  // namespace ink::bench

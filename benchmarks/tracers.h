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

struct TracerPlan {
    int side, rounds;
    bool built_in;                  ///< measure scenes of all kinds, from near and from afar
    std::vector<std::string> only;  ///< of these the ones with these names; empty: all
};

/// Measures files (molecules also as balls and sticks and as sticks, particles also as boxes), then
/// built-in scenes. Calls `done` after each row. Throws InputError.
void measure_tracers(const std::vector<std::string>& files, const TracerPlan& plan,
                     const std::function<void(const TracerRow&)>& done);

}  // namespace ink::bench

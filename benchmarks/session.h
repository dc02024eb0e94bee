#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace ink::bench {

/// What the interactive viewer does with one file.
struct SessionRow {
    std::string what;
    double plain_ms = 0.0;    ///< median, a frame without lines, one ray a pixel
    double turning_ms = 0.0;  ///< median, a frame with lines while the camera turns
    double rays_share = 1.0;  ///< of a pixel's side, that such frames take rays for
    /// From an event to the first picture that shows it, ms: median, 95 %, 99 %, longest.
    std::array<double, 4> latency_ms{};
    /// The same in frames, each in those that were drawn meanwhile: a scene that turns its broad
    /// side takes longer.
    std::array<double, 4> latency_frames{};
    int latency_pictures =
        0;                    ///< most pictures from an event to the first that shows it, with that
    double rests_ms = 0.0;    ///< from the last event to the picture in full
    double refined_ms = 0.0;  ///< the picture in full
    bool exact = false;       ///< and equals what `render` gives, byte for byte
    /// From a move during refinement until the painter was free: median, of 99 %, longest.
    double gives_way_ms = 0.0, gives_way_99_ms = 0.0, gives_way_most_ms = 0.0;
    int moves = 0;  ///< that these were measured with
};

/// Turns the camera of a session on a square picture, as a hand would, for `rounds` times 20 frames
/// and then moves it while pictures are refined. `flags` are settings, with their values.
SessionRow measure_session(const std::filesystem::path& file, int side, int rounds,
                           const std::vector<std::pair<std::string, std::string>>& flags);

void print_heading_of_sessions();
void print(const SessionRow& row);

}  // namespace ink::bench

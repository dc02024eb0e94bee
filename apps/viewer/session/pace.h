#pragma once

#include <array>
#include <cstddef>

namespace inktrace::viewer {

/// Chooses how many rays the pictures of a moving camera take, as a share of those along a pixel's
/// side, so that lines cost no more than a little of what the frame costs without them, and a frame
/// no more than is bearable. Other programs make single frames slow but never fast, so what counts
/// is the fastest of the last few.
class Pace {
  public:
    double scale() const;
    /// Learns what a frame takes without lines, with one ray a pixel.
    void plain_took(double ms);
    /// Learns from a frame drawn with a share of the rays.
    void frame_took(double scale, double ms);
    /// Learns what a picture in full takes, where nothing else is known yet.
    void full_took(double ms);
    /// Another scene: what frames took tells nothing any more.
    void forget();

  private:
    static constexpr double kLongest = 40.0;  ///< ms: 25 frames a second
    static constexpr std::size_t kSteps = 5;
    static constexpr std::size_t kFrames = 6;  ///< the last few, a tenth of a second

    double fastest_ms() const;
    void go_to(std::size_t step);
    double expected_ms(std::size_t step) const;
    void choose();
    std::size_t cheapest_step() const;

    double target_ms_ = kLongest;
    std::size_t step_ = 0;                    ///< index into the scales
    std::array<double, kSteps> took_ms_{};    ///< a frame, of late; 0 where that is not known
    std::array<double, kFrames> frame_ms_{};  ///< the last ones of this step, in a ring
    std::size_t frames_ = 0;                  ///< of this step
};

}  // namespace inktrace::viewer

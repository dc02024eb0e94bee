#pragma once

#include <array>

namespace inktrace::viewer {

/// Chooses how many rays the pictures of a moving camera take, as a share of those along a pixel's
/// side, so that lines cost no more than a little of what the frame costs without them, and a frame
/// no more than is bearable.
class Pace {
  public:
    double scale() const;
    /// Learns what a frame of another scene takes without lines, with one ray a pixel.
    void plain_took(double ms);
    /// Learns from a frame drawn with a share of the rays.
    void frame_took(double scale, double ms);
    /// Learns what a picture in full takes, where nothing else is known yet.
    void full_took(double ms);
    double target_ms() const { return target_ms_; }

  private:
    static constexpr double kLongest = 40.0;  ///< ms: 25 frames a second
    static constexpr int kSteps = 5;

    double expected_ms(int step) const;

    double target_ms_ = kLongest;
    int step_ = 0;                          ///< index into the scales
    std::array<double, kSteps> took_ms_{};  ///< a frame, of late; 0 where that is not known
};

}  // namespace inktrace::viewer

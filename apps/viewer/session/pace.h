#pragma once

namespace inktrace::viewer {

/// Chooses how large the pictures of a moving camera are drawn, as a share of the window's side, so
/// that a frame takes no longer than it may. Lines keep their width: it shrinks with the picture,
/// which the window then enlarges.
class Pace {
  public:
    explicit Pace(double target_ms = 45.0) : target_ms_(target_ms) {}

    double scale() const;
    /// Learns from a frame drawn at a scale.
    void frame_took(double scale, double ms);
    /// Learns what a picture in full takes, where nothing else is known yet.
    void full_took(double ms);

  private:
    double target_ms_;
    int step_ = 0;  ///< index into the scales
    bool known_ = false;
};

}  // namespace inktrace::viewer

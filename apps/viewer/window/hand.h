#pragma once

#include <chrono>
#include <optional>

#include "window/interface.h"

namespace inktrace::viewer {

/// The pointer over the picture: what it drags, turns and picks.
class Hand {
  public:
    explicit Hand(Interface& interface) : interface_(interface) {}

    /// `picture` is the size of the picture, which lies at the window's upper left corner.
    void take(const Input& input, ink::Size picture);
    /// When to look up what the pointer rests on.
    std::optional<Clock::time_point> next_look() const { return look_at_; }
    /// Looks it up, if it is time; whether there is something else now.
    bool look();

  private:
    enum class Drag { none, turn, pan, roll };
    void press(const Input& input, ink::Size picture);
    void release(const Input& input);
    void move(const Input& input, ink::Size picture);
    void scroll(const Input& input, ink::Size picture);

    Interface& interface_;
    Drag drag_ = Drag::none;
    bool moved_ = false;  ///< far enough to be no click
    double start_x_ = 0, start_y_ = 0, last_x_ = 0, last_y_ = 0;
    std::optional<Clock::time_point> look_at_;
    Clock::time_point last_click_{};
    std::optional<ink::Vec3d> zoom_point_;  ///< while the wheel turns without a move
};

}  // namespace inktrace::viewer

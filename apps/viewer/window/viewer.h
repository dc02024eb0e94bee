#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "window/hand.h"
#include "window/interface.h"

namespace inktrace::viewer {

/// The window over a session: hands on what a user does, and shows what comes of it. It sleeps in
/// between.
class Viewer {
  public:
    /// Throws Error where there is no display, or where the files or flags make no sense.
    Viewer(const std::vector<std::filesystem::path>& files,
           const std::vector<std::pair<std::string, std::string>>& flags);

    /// Until the window is closed.
    void run();

  private:
    void take_input();
    void draw_frames(int count);
    bool shows_other_picture() const;
    void draw_other_picture();
    void draw();
    void draw_picture(ink::Size picture);
    std::optional<Clock::time_point> next_moment() const;
    ink::Size picture_size() const;
    void title();

    Window window_;
    Session session_;
    Interface interface_;
    Hand hand_;
    int frames_to_draw_ = 0;                       ///< at least, of the whole window
    std::optional<Clock::time_point> next_frame_;  ///< when to draw all of it again
    ink::Size frame_size_;                         ///< of the window, in the last frame
    std::string title_;
};

}  // namespace inktrace::viewer

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "inktrace/inktrace.h"

namespace inktrace::cli {

/// One picture of an animation.
struct Shot {
    int frame = 0;          ///< of the files
    double turn_deg = 0.0;  ///< of a turntable
    std::string file;
};

/// Whether the name of a picture stands for several: "out_####.png".
bool is_numbered(std::string_view output);

/// The name with its last run of # replaced by a number of at least as many digits; as it is where
/// it has none.
std::string numbered(std::string_view output, int number);

/// The frames that `--frame` asks for, of files that have `frames`. Throws Error (input) where
/// there are fewer.
struct FrameRange {
    int first = 0;
    int last = 0;
};
FrameRange frame_range(const Settings& settings, int frames);

/// A full turn in `views` pictures, or else a picture a frame. Pictures are numbered by their
/// frame, or from 0 on.
std::vector<Shot> plan_shots(std::string_view output, FrameRange frames, int views);

}  // namespace inktrace::cli

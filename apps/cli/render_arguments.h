#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "inktrace/inktrace.h"

namespace inktrace::cli {

struct RenderArguments {
    std::vector<std::string> inputs;
    std::string scene;  ///< a scene file, drawn before the inputs
    std::string output;
    std::string lines_file;
    std::string stats_file;
    int repeat = 1;
    bool quiet = false;
    int turntable = 0;                ///< pictures of a full turn; 0: no turntable
    bool resume = false;              ///< leave pictures of an animation that are there
    double pictures_a_second = 25.0;  ///< of a film
    Settings settings;
};

struct Loaded {
    Scene scene;
    int frames = 0;                         ///< that every input has
    std::optional<double> chosen_radius{};  ///< of particles of the last input that give none
};

/// Reads the inputs, by these settings, and says what it was warned of.
Loaded load(const RenderArguments& arguments, const Settings& settings);

/// Says what a large scene will take, before it does.
void announce_cost(const Scene& scene, const std::string& output);

double ms_since(std::chrono::steady_clock::time_point start);

}  // namespace inktrace::cli

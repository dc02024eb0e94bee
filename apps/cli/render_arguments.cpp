#include "render_arguments.h"

#include <fmt/format.h>

#include <algorithm>

#include "messages.h"

namespace inktrace::cli {

Loaded load(const RenderArguments& arguments, const Settings& settings) {
    Loaded loaded;
    for (const std::string& input : arguments.inputs) {
        const FileInfo info = loaded.scene.load(input, settings);
        loaded.chosen_radius = info.chosen_radius;
        const bool first = loaded.frames == 0;
        loaded.frames = first ? info.frames : std::min(loaded.frames, info.frames);
        for (const std::string& warning : info.warnings) {
            say(fmt::format("{}: warning: {}\n", input, warning));
        }
    }
    return loaded;
}

void announce_cost(const Scene& scene, const std::string& output) {
    constexpr std::size_t kLarge = 1'000'000;
    const std::size_t primitives = scene.primitive_count();
    if (primitives < kLarge) return;
    const SceneCost cost = scene.cost();
    const double seconds = std::max(cost.build_seconds, 1.0);
    const std::string with_light =
        cost.ambient_seconds > seconds
            ? fmt::format(", {:.0f} s with ambient light", seconds + cost.ambient_seconds)
            : std::string();
    say(fmt::format(
        "{}: {} primitives; takes up to {:.1f} GB of memory, and about {:.0f} s before "
        "the first pixels{}\n",
        output, primitives, static_cast<double>(cost.bytes) * 1e-9, seconds, with_light));
}

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

}  // namespace inktrace::cli

#include "bench_tables.h"

#include <fmt/format.h>

#include <algorithm>

namespace inktrace::cli {

namespace {

/// The best of at least three frames, or of as many as half a second holds; a slow one counts once.
BenchCell measure(const Renderer& renderer, const Settings& settings) {
    constexpr double kEnoughMs = 500.0;
    BenchCell cell;
    double best = 0.0;
    double total = 0.0;
    for (int frame = 0; frame == 0 || (total < kEnoughMs && frame < 50); ++frame) {
        const RenderStats stats = renderer.render(settings).stats();
        best = frame == 0 ? stats.render_ms : std::min(best, stats.render_ms);
        total += stats.render_ms;
        cell.rays = stats.rays;
    }
    cell.frames_per_second = 1000.0 / best;
    return cell;
}

}  // namespace

std::vector<BenchRow> measure_table(const Renderer& renderer, const Settings& base, int threads) {
    std::vector<BenchRow> rows;
    for (const std::string name : kBenchRows) {
        BenchRow row{name, {}};
        for (int rings = 0; rings <= 3; ++rings) {
            if (rings == 0 && name != kBenchRows[0]) continue;
            Settings settings = base;
            settings.set("method", "stencil").set("metric", "linear").set("line-width", "3px");
            settings.set("threads", std::to_string(threads));
            settings.set("aa", "none").set("shade", "lambert");
            if (rings == 0) settings.set("compose", "shaded");
            if (rings > 0) settings.set("quality", std::to_string(rings));
            // As many samples as a stencil has rays, itself counted (the paper's footnote 3).
            const int samples = (2 * rings + 1) * (2 * rings + 1);
            if (name == kBenchRows[1]) settings.set("aa", "stencil");
            if (name == kBenchRows[2]) settings.set("aa", fmt::format("multisample:{}", samples));
            row.cells[static_cast<std::size_t>(rings)] = measure(renderer, settings);
        }
        rows.push_back(row);
    }
    return rows;
}

std::string short_number(double value) {
    return value < 100.0 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

}  // namespace inktrace::cli

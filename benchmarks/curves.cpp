// Error against time, and time against size: the curves of docs/method.md.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "accel/tracer.h"
#include "io/reader.h"
#include "render/render.h"
#include "scenes.h"

namespace {

using namespace ink;
using namespace ink::bench;
using Json = nlohmann::ordered_json;

void set(Settings& settings, std::string_view name, std::string_view value) {
    find_setting(name).set(settings, value);
}

struct Measured {
    Film film;
    double ms;  ///< median
};

Measured measure(const Scene& scene, const Tracer& tracer, const Settings& settings, int rounds,
                 const PixelFormats& formats) {
    std::vector<double> times;
    RenderStats stats;
    Film film = render(scene, tracer, settings, formats, {}, &stats);
    for (int round = 0; round < rounds; ++round) {
        render(scene, tracer, settings, formats, {}, &stats);
        times.push_back(stats.render_ms);
    }
    std::ranges::sort(times);
    return {std::move(film), times.empty() ? stats.render_ms : times[times.size() / 2]};
}

/// Linear red, green and blue, one after the other.
std::vector<float> colors(const Film& film) {
    std::vector<float> all;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& plane = std::get<std::vector<float>>(film.channels().channels[k].values);
        all.insert(all.end(), plane.begin(), plane.end());
    }
    return all;
}

double rmse(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double difference = static_cast<double>(a[k]) - static_cast<double>(b[k]);
        sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

/// What can be asked for, from fast to good.
struct Way {
    std::string name;
    std::string method;
    std::vector<std::pair<std::string, std::string>> settings;
};

std::vector<Way> ways() {
    std::vector<Way> list;
    for (int rings = 1; rings <= 3; ++rings) {
        const int samples = (2 * rings + 1) * (2 * rings + 1);
        for (const std::string& aa : {std::string("none"), std::string("stencil"),
                                      fmt::format("multisample:{}", samples)}) {
            list.push_back(
                {fmt::format("stencil N={} {}", rings, aa),
                 "stencil",
                 {{"method", "stencil"}, {"quality", std::to_string(rings)}, {"aa", aa}}});
        }
    }
    for (int q = 1; q <= 3; ++q) {
        list.push_back({fmt::format("edges q={}", q), "edges", {{"lattice", std::to_string(q)}}});
    }
    return list;
}

Settings frontier_settings(int side) {
    Settings settings;
    settings.size = {side, side};
    settings.threads = 1;
    set(settings, "lines", "silhouette,intersection");
    set(settings, "line-width", "6px");
    set(settings, "line-density", "1");
    set(settings, "line-blend", "linear");
    return settings;
}

constexpr PixelFormats kLinear{false, true};

Json compare(const Scene& scene, const Tracer& tracer, const Settings& base,
             const std::vector<float>& reference, int rounds, std::string_view profile) {
    Json rows = Json::array();
    for (const Way& way : ways()) {
        Settings settings = base;
        for (const auto& [name, value] : way.settings) set(settings, name, value);
        const Measured measured = measure(scene, tracer, settings, rounds, kLinear);
        const double error = rmse(colors(measured.film), reference);
        fmt::print("  {:<28}{:>10.2f} ms   RMSE {:.5f}\n", way.name, measured.ms, error);
        std::fflush(stdout);
        rows.push_back({{"profile", profile},
                        {"way", way.name},
                        {"method", way.method},
                        {"ms", measured.ms},
                        {"rmse", error}});
    }
    return rows;
}

/// Against stencils of 16 rings, 64 samples a pixel: shading and lines of the paper's profile.
Json soft_frontier(const NamedScene& named, int side, int rounds) {
    const Scene scene(named.objects);
    const auto tracer = make_tracer(scene);
    Settings settings = frontier_settings(side);
    set(settings, "metric", "linear");
    Settings converged = settings;
    set(converged, "method", "stencil");
    set(converged, "quality", "16");
    set(converged, "aa", "multisample:64");
    fmt::print("{}, {} x {}, linear profile\n", named.name, side, side);
    const Measured reference = measure(scene, *tracer, converged, 0, kLinear);
    return compare(scene, *tracer, settings, colors(reference.film), rounds, "linear");
}

/// Against the exact area of each pixel under the outline of one sphere, seen in parallel
/// projection: solid lines alone.
Json solid_frontier(int side, int rounds) {
    Spheres shape;
    shape.spheres.push_back({{0, 0, 0}, 1.0F});
    Object object;
    object.kind = ObjectKind::particles;
    object.shape = std::move(shape);
    const Scene scene({object});
    const auto tracer = make_tracer(scene);
    Settings settings = frontier_settings(side);
    set(settings, "metric", "solid");
    set(settings, "compose", "lines");
    set(settings, "eye", "0,0,10");
    set(settings, "look-at", "0,0,0");
    set(settings, "orthographic", "2.5");
    const double middle = side * 0.5;
    const double radius = side / 2.5;
    constexpr int kGrid = 64;
    std::vector<float> reference;
    for (int k = 0; k < side * side; ++k) {
        int inside = 0;
        const double x = k % side - middle;
        const double y = k / side - middle;
        const bool near = std::abs(std::hypot(x + 0.5, y + 0.5) - radius) < 4.0;
        for (int n = 0; near && n < kGrid * kGrid; ++n) {
            const double px = x + (n % kGrid + 0.5) / kGrid;
            const double py = y + (n / kGrid + 0.5) / kGrid;
            inside += std::abs(std::hypot(px, py) - radius) < 3.0 ? 1 : 0;
        }
        reference.push_back(1.0F - static_cast<float>(inside) / (kGrid * kGrid));
    }
    std::vector<float> all;
    for (int channel = 0; channel < 3; ++channel) {
        all.insert(all.end(), reference.begin(), reference.end());
    }
    fmt::print("one sphere, {} x {}, solid lines\n", side, side);
    return compare(scene, *tracer, settings, all, rounds, "solid");
}

Json growth_row(const Scene& scene, const Tracer& tracer, std::string_view along, double at,
                int side, double width, int rounds) {
    Settings settings;
    settings.size = {side, side};
    settings.threads = 1;
    settings.line_width.value = width;
    const Measured measured = measure(scene, tracer, settings, rounds, {});
    fmt::print("  {:<10}{:>12} {:>10.1f} ms\n", along, at, measured.ms);
    std::fflush(stdout);
    return {{"along", along}, {"at", at}, {"ms", measured.ms}};
}

Json growth(std::size_t most_spheres, int rounds) {
    Json rows = Json::array();
    for (std::size_t count = 1000; count <= most_spheres; count *= 10) {
        const NamedScene named = random_spheres(count);
        const Scene scene(named.objects);
        const auto tracer = make_tracer(scene);
        rows.push_back(
            growth_row(scene, *tracer, "spheres", static_cast<double>(count), 1024, 2.0, rounds));
        if (count != 100'000) continue;
        for (int side = 256; side <= 4096; side *= 2) {
            rows.push_back(growth_row(scene, *tracer, "side", side, side, 2.0, rounds));
        }
        for (const double width : {1.0, 2.0, 5.0, 10.0, 20.0}) {
            rows.push_back(growth_row(scene, *tracer, "width", width, 1024, width, rounds));
        }
    }
    return rows;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures error against time, and time against size. plot_curves.py draws them.");
    std::string file;
    std::string json_file;
    int side = 384;
    int rounds = 5;
    std::size_t most_spheres = 10'000'000;
    bool errors = true;
    app.add_option("FILE", file, "Scene for the paper's profile [acetaminophen]");
    app.add_option("--json", json_file, "Write the results as JSON");
    app.add_option("--side", side, "Pixels of the square picture's side, for errors [384]");
    app.add_option("--rounds", rounds, "Rounds to take the median of [5]");
    app.add_option("--spheres", most_spheres, "Most spheres, for growth; 0: no growth [10000000]");
    app.add_flag("!--no-frontier", errors, "No errors");
    CLI11_PARSE(app, argc, argv);
    if (file.empty()) file = INKTRACE_SAMPLES "/acetaminophen.xyz";
    try {
        Json json;
        json["frontier"] = Json::array();
        if (errors) {
            json["frontier"] = soft_frontier({file, read_file(file).objects}, side, rounds);
            for (const Json& row : solid_frontier(side, rounds)) json["frontier"].push_back(row);
        }
        json["growth"] = growth(most_spheres, rounds);
        if (!json_file.empty()) std::ofstream(json_file) << json.dump(1) << '\n';
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}

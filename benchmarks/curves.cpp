// Error against time, and time against size: the curves of docs/method.md.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
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
    double ms;          ///< median
    RenderStats stats;  ///< of the fastest
};

Measured measure(const Scene& scene, const Tracer& tracer, const Settings& settings, int rounds,
                 const PixelFormats& formats) {
    std::vector<RenderStats> frames(static_cast<std::size_t>(rounds) + 1);
    Film film = render(scene, tracer, settings, formats, {}, frames.data());
    for (RenderStats& stats : frames) {
        if (&stats != frames.data()) render(scene, tracer, settings, formats, {}, &stats);
    }
    if (rounds > 0) frames.erase(frames.begin());  // the first one warms caches up
    std::ranges::sort(frames, {}, &RenderStats::render_ms);
    return {std::move(film), frames[frames.size() / 2].render_ms, frames[0]};
}

/// Linear red, green and blue, one after the other.
std::vector<float> colors(const Film& film) {
    std::vector<float> all;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& plane = std::get<Plane<float>>(film.channels().channels[k].values);
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
    set(settings, "ambient", "0");
    return settings;
}

constexpr PixelFormats kLinear{false, true};

/// What to measure, and how.
struct Options {
    int side = 384;
    int rounds = 5;
    std::string ways;       ///< only those whose name has this in it
    std::string reference;  ///< file that keeps the reference of the paper's profile
};

Json compare(const Scene& scene, const Tracer& tracer, const Settings& base,
             const std::vector<float>& reference, const Options& options,
             std::string_view profile) {
    Json rows = Json::array();
    for (const Way& way : ways()) {
        if (way.name.find(options.ways) == std::string::npos) continue;
        Settings settings = base;
        for (const auto& [name, value] : way.settings) set(settings, name, value);
        const Measured measured = measure(scene, tracer, settings, options.rounds, kLinear);
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

/// Stencils of 16 rings, 64 samples a pixel. That takes minutes, so a file may keep it.
std::vector<float> converged(const Scene& scene, const Tracer& tracer, Settings settings,
                             const std::string& file) {
    set(settings, "method", "stencil");
    set(settings, "quality", "16");
    set(settings, "aa", "multisample:64");
    settings.threads = 0;
    std::vector<float> values(3 * static_cast<std::size_t>(settings.size.width) *
                              static_cast<std::size_t>(settings.size.height));
    const auto bytes = static_cast<std::streamsize>(values.size() * sizeof(float));
    if (std::ifstream kept(file, std::ios::binary);
        kept.read(reinterpret_cast<char*>(values.data()), bytes)) {
        return values;
    }
    values = colors(render(scene, tracer, settings, kLinear));
    if (!file.empty()) {
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(values.data()), bytes);
    }
    return values;
}

/// Shading and lines of the paper's profile.
Json soft_frontier(const NamedScene& named, const Options& options) {
    const Scene scene(named.objects);
    const auto tracer = make_tracer(scene);
    Settings settings = frontier_settings(options.side);
    set(settings, "metric", "linear");
    fmt::print("{}, {} x {}, linear profile\n", named.name, options.side, options.side);
    const std::vector<float> reference = converged(scene, *tracer, settings, options.reference);
    return compare(scene, *tracer, settings, reference, options, "linear");
}

/// Against the exact area of each pixel under the outline of one sphere, seen in parallel
/// projection: solid lines alone.
Json solid_frontier(const Options& options) {
    const int side = options.side;
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
    return compare(scene, *tracer, settings, all, options, "solid");
}

/// Of the fastest frame, which other programs disturbed least.
Json growth_row(const Scene& scene, const Tracer& tracer, std::string_view along, double at,
                int side, double width, int rounds) {
    Settings settings;
    settings.size = {side, side};
    settings.threads = 1;
    settings.line_width.value = width;
    set(settings, "ambient", "0");
    const RenderStats stats = measure(scene, tracer, settings, rounds, {}).stats;
    const double ms = stats.render_ms;
    settings.compose = Compose::shaded;
    set(settings, "aa", "none");
    const double plain = measure(scene, tracer, settings, rounds, {}).stats.render_ms;
    fmt::print(
        "  {:<8}{:>9} {:>7.1f} ms, without lines {:>6.1f}; {:>5.2f} million crossings; "
        "trace {:.0f} detect {:.0f} locate {:.0f} connect {:.0f} ink {:.0f} blend {:.0f}\n",
        along, at, ms, plain, static_cast<double>(stats.crossings) * 1e-6, stats.trace_ms,
        stats.detect_ms, stats.locate_ms, stats.connect_ms, stats.ink_ms, stats.blend_ms);
    std::fflush(stdout);
    return {{"along", along},
            {"at", at},
            {"ms", ms},
            {"plain_ms", plain},
            {"crossings", stats.crossings},
            {"trace_ms", stats.trace_ms},
            {"detect_ms", stats.detect_ms},
            {"locate_ms", stats.locate_ms},
            {"connect_ms", stats.connect_ms},
            {"ink_ms", stats.ink_ms},
            {"blend_ms", stats.blend_ms}};
}

/// Along the number of spheres, from `least` on; along pixels and width for 100,000 of them.
Json growth(std::size_t least, std::size_t most, int rounds) {
    Json rows = Json::array();
    for (std::size_t count = least; count <= most; count *= 10) {
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

/// Rows that were measured now, and those of `before` that tell of something else.
Json merged(const Json& before, Json now, std::initializer_list<const char*> keys) {
    Json rows = Json::array();
    for (const Json& row : before) {
        const bool again = std::ranges::any_of(now, [&](const Json& other) {
            return std::ranges::all_of(keys, [&](const char* k) { return other[k] == row[k]; });
        });
        if (!again) rows.push_back(row);
    }
    for (Json& row : now) rows.push_back(std::move(row));
    return rows;
}

void write_json(const std::string& file, Json frontier, Json growth) {
    Json before;
    if (std::ifstream in(file); in) before = Json::parse(in, nullptr, false);
    const auto old = [&](const char* name) {
        return before.is_object() && before.contains(name) ? before[name] : Json::array();
    };
    Json json;
    json["frontier"] = merged(old("frontier"), std::move(frontier), {"profile", "way"});
    json["growth"] = merged(old("growth"), std::move(growth), {"along", "at"});
    std::ofstream(file) << json.dump(1) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures error against time, and time against size. plot_curves.py draws them.");
    std::string file;
    std::string json_file;
    Options options;
    std::size_t least_spheres = 1000;
    std::size_t most_spheres = 10'000'000;
    bool errors = true;
    app.add_option("FILE", file, "Scene for the paper's profile [acetaminophen]");
    app.add_option("--json", json_file, "Add the results to this file");
    app.add_option("--side", options.side, "Pixels of the square picture's side, for errors [384]");
    app.add_option("--rounds", options.rounds, "Rounds to take the median of [5]");
    app.add_option("--ways", options.ways, "For errors: only ways with this in their names");
    app.add_option("--reference", options.reference, "File to keep the converged picture in");
    app.add_option("--from-spheres", least_spheres, "Least spheres, for growth [1000]");
    app.add_option("--spheres", most_spheres, "Most spheres, for growth; 0: no growth [10000000]");
    app.add_flag("!--no-frontier", errors, "No errors");
    CLI11_PARSE(app, argc, argv);
    if (file.empty()) file = INKTRACE_SAMPLES "/acetaminophen.xyz";
    try {
        Json frontier = Json::array();
        if (errors) {
            frontier = soft_frontier({file, read_file(file).objects}, options);
            for (const Json& row : solid_frontier(options)) frontier.push_back(row);
        }
        Json rows = growth(least_spheres, most_spheres, options.rounds);
        if (!json_file.empty()) write_json(json_file, std::move(frontier), std::move(rows));
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}

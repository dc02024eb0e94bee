// What a frame costs, in units of a loop that only traces one primary ray a pixel.

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "accel/cost.h"
#include "accel/tracer.h"
#include "bare_loop.h"
#include "camera/camera.h"
#include "io/reader.h"
#include "readers.h"
#include "render/draft.h"
#include "render/render.h"
#include "scenes.h"
#include "session.h"
#include "tracers.h"

namespace {

using namespace ink;
using namespace ink::bench;

double median(std::vector<double> values) {
    std::ranges::nth_element(values,
                             values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

BareLoop::Pinhole pinhole(const Scene& scene, const Camera& camera, const Settings& settings) {
    const auto half =
        static_cast<float>(std::tan(settings.view.fov_deg * 3.14159265358979 / 360.0));
    const float pixel = 2.0F * half / static_cast<float>(settings.size.height);
    const Vec3f dx = camera.right() * pixel;
    const Vec3f dy = camera.up() * -pixel;
    return {scene.frame().from_world(camera.world_eye()),
            -camera.back() - dx * (0.5F * static_cast<float>(settings.size.width)) -
                dy * (0.5F * static_cast<float>(settings.size.height)),
            dx, dy, settings.size};
}

struct Row {
    std::string what;
    double median_ms;
    double in_r;  ///< median over rounds of time / R of the same round
    RenderStats fastest;
    double speedup;          ///< on several threads: the same of that on one thread / time; else 0
    double fastest_speedup;  ///< likewise, of the fastest frames: what the program allows
};

struct Result {
    std::string scene;
    double r_ms;
    double r_speedup;  ///< what the machine gives: of loops at once, one a thread
    std::vector<Row> rows;
    std::size_t primitives;
    double build_ms;       ///< of the tracer, with all threads
    double bytes_of_each;  ///< primitive, of the scene with its tracer
};

struct Variant {
    std::string name;
    Settings settings;
    double share = 1.0;  ///< of a ray along a pixel's side; below 1 it is a draft

    /// Whether it is `other` on more threads.
    bool repeats(const Variant& other) const {
        return name.starts_with(other.name + ", ") && name.ends_with(" threads");
    }
};

/// What is measured of a scene.
struct Plan {
    int side = 1024;
    int rounds = 7;
    int threads = 2;
    bool stencils = true;
    std::vector<std::string> only;  ///< rows of these names; empty: all
};

std::vector<Variant> variants(const Plan& plan) {
    std::vector<Variant> list;
    const auto add = [&](std::string name, const Settings& settings, double share = 1.0) {
        if (!plan.only.empty() && std::ranges::find(plan.only, name) == plan.only.end()) return;
        list.push_back({std::move(name), settings, share});
    };
    Settings plain;
    plain.size = {plan.side, plan.side};
    plain.threads = 1;
    plain.lines = {};
    plain.shading.ambient = 0.0F;  // look plain
    add("no lines", plain);
    Settings threaded = plain;
    threaded.threads = plan.threads;
    add(fmt::format("no lines, {} threads", plan.threads), threaded);
    for (const double width : {2.0, 8.0}) {
        Settings lines = plain;
        lines.lines = LineTypes::usual();
        lines.line_width.value = width;
        add(fmt::format("edges, {} px", width), lines);
        threaded = lines;
        threaded.threads = plan.threads;
        add(fmt::format("edges, {} px, {} threads", width, plan.threads), threaded);
        lines.lines.add(LineType::mesh);
        add(fmt::format("edges, {} px, mesh lines too", width), lines);
        lines.lines = LineTypes::all();
        add(fmt::format("edges, {} px, all types", width), lines);
    }
    Settings draft = plain;
    draft.lines = LineTypes::all();
    add("draft, all types", draft, 0.25);
    draft.threads = plan.threads;
    add(fmt::format("draft, all types, {} threads", plan.threads), draft, 0.25);
    Settings soft = plain;
    soft.lines = LineTypes::usual();
    soft.line_width.value = 2.0;
    soft.shading.ambient = 1.0F;
    add("edges, 2 px, look soft", soft);
    for (int rings = 1; plan.stencils && rings <= 3; ++rings) {
        Settings lines = plain;
        lines.lines = LineTypes::usual();
        lines.line_width.value = 2.0;
        lines.method = Method::stencil;
        lines.rings = rings;
        add(fmt::format("stencil, N = {}", rings), lines);
    }
    return list;
}

/// Of this process, that it has now.
double resident_bytes() {
    std::ifstream in("/proc/self/statm");
    double total = 0.0;
    double resident = 0.0;
    in >> total >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

struct Built {
    double ms;
    double bytes;  ///< a primitive, of the scene and its tracer
};

/// The faster of two. Bytes are those that the tracer was seen to take, and the scene's own.
Built build_time(const Scene& scene) {
    Built built{1e30, 0.0};
    for (int k = 0; k < 2; ++k) {
        malloc_trim(0);
        const double before = resident_bytes();
        const auto start = std::chrono::steady_clock::now();
        const auto tracer = make_tracer(scene);
        const std::chrono::duration<double, std::milli> time =
            std::chrono::steady_clock::now() - start;
        built.ms = std::min(built.ms, time.count());
        malloc_trim(0);
        built.bytes = resident_bytes() - before + cost_of(scene.objects()).stored_bytes;
    }
    built.bytes /= static_cast<double>(scene.primitive_count());
    return built;
}

/// The faster of two: a cold start is not what the loop costs.
double bare_ms(const BareLoop& bare, const BareLoop::Pinhole& rays) {
    std::size_t hits = 0;
    return std::min(bare.run(rays, hits), bare.run(rays, hits));
}

/// How many times as fast `threads` loops at once are as one after the other. Work that nothing
/// shares: where this is below `threads`, processors share what they work with.
double bare_speedup(const BareLoop& bare, const BareLoop::Pinhole& rays, int threads,
                    double alone_ms) {
    double best = 1e30;
    for (int k = 0; k < 2; ++k) {
        const auto start = std::chrono::steady_clock::now();
        {
            std::vector<std::jthread> loops;
            loops.reserve(static_cast<std::size_t>(threads));
            for (int i = 0; i < threads; ++i) {
                loops.emplace_back([&] {
                    std::size_t hits = 0;
                    bare.run(rays, hits);
                });
            }
        }
        const std::chrono::duration<double, std::milli> time =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count());
    }
    return threads * alone_ms / best;
}

/// Rounds of R and every variant in turn, so that a machine that slows down slows all alike.
Result measure(const NamedScene& named, const Plan& plan) {
    const Scene scene(named.objects);
    const Built built = build_time(scene);
    const auto tracer = make_tracer(scene);
    const BareLoop bare(scene);
    const std::vector<Variant> list = variants(plan);
    Settings whole;
    whole.size = {plan.side, plan.side};
    const Camera camera(scene, whole.view, whole.size);
    const BareLoop::Pinhole rays = pinhole(scene, camera, whole);

    std::vector<double> r;
    std::vector<double> speedups;
    std::vector<std::vector<double>> times(list.size());
    std::vector<std::vector<double>> ratios(list.size());
    std::vector<RenderStats> fastest(list.size());
    for (int round = 0; round <= plan.rounds; ++round) {
        const double loop = bare_ms(bare, rays);
        if (round > 0) {
            r.push_back(loop);
            speedups.push_back(bare_speedup(bare, rays, plan.threads, loop));
        }
        for (std::size_t k = 0; k < list.size(); ++k) {
            RenderStats best;
            best.render_ms = 1e30;
            const int tries = list[k].settings.method == Method::edges ? 2 : 1;
            for (int i = 0; i < tries; ++i) {
                RenderStats stats;
                if (list[k].share < 1.0) {
                    render_draft(scene, *tracer, list[k].settings, list[k].share, {}, &stats);
                } else {
                    render(scene, *tracer, list[k].settings, {}, {}, &stats);
                }
                if (stats.render_ms < best.render_ms) best = stats;
            }
            if (round == 0) continue;  // warms caches and the clock
            times[k].push_back(best.render_ms);
            ratios[k].push_back(best.render_ms / loop);
            if (round == 1 || best.render_ms < fastest[k].render_ms) fastest[k] = best;
        }
    }
    Result result{named.name, median(r),  median(speedups), {}, scene.primitive_count(),
                  built.ms,   built.bytes};
    for (std::size_t k = 0; k < list.size(); ++k) {
        Row row{list[k].name, median(times[k]), median(ratios[k]), fastest[k], 0.0, 0.0};
        const auto alone = std::ranges::find_if(
            list, [&](const Variant& other) { return list[k].repeats(other); });
        if (alone != list.end()) {
            const auto one = static_cast<std::size_t>(alone - list.begin());
            const auto& alone_ms = times[one];
            std::vector<double> gains;
            for (std::size_t i = 0; i < alone_ms.size(); ++i) {
                gains.push_back(alone_ms[i] / times[k][i]);
            }
            row.speedup = median(gains);
            row.fastest_speedup = fastest[one].render_ms / fastest[k].render_ms;
        }
        result.rows.push_back(std::move(row));
    }
    return result;
}

/// FILE or, for a biological assembly of it, FILE@ASSEMBLY.
NamedScene read_scene(const std::string& name) {
    const std::size_t at = name.rfind('@');
    ReadOptions options;
    if (at != std::string::npos) options.data.assembly = name.substr(at + 1);
    return {name, read_file(name.substr(0, at), options).objects};
}

/// Where the time of a frame goes.
std::vector<std::pair<const char*, double>> phases(const RenderStats& stats) {
    const double found = stats.detect_ms + stats.locate_ms + stats.connect_ms + stats.ridges_ms;
    const double drawn = stats.ink_ms + stats.blend_ms;
    return {{"trace", stats.trace_ms},
            {"shade", stats.shade_ms - stats.film_ms},
            {"film", stats.film_ms},
            {"detect", stats.detect_ms},
            {"locate", stats.locate_ms},
            {"connect", stats.connect_ms},
            {"ridges", stats.ridges_ms},
            {"ink", stats.ink_ms},
            {"blend", stats.blend_ms},
            {"other lines", stats.lines_ms - found - drawn},
            {"rest", stats.render_ms - stats.trace_ms - stats.shade_ms - stats.lines_ms}};
}

void print_phases(const RenderStats& stats) {
    fmt::print("    {:.2f} ms:", stats.render_ms);
    for (const auto& [name, ms] : phases(stats)) {
        if (ms >= 0.005) fmt::print("  {} {:.2f}", name, ms);
    }
    fmt::print("; {} rays, {} crossings\n", stats.rays, stats.crossings);
}

void print(const Result& result, bool with_phases) {
    fmt::print("{}\n  {:<28}{:>9.2f} ms {:>8.0f} bytes a primitive, {} primitives\n", result.scene,
               "build", result.build_ms, result.bytes_of_each, result.primitives);
    fmt::print("  {:<28}{:>9.2f} ms              {:.2f} x as fast, one a thread\n",
               "R (bare rtcIntersect16 loop)", result.r_ms, result.r_speedup);
    for (const Row& row : result.rows) {
        fmt::print("  {:<28}{:>9.2f} ms {:>8.3f} R", row.what, row.median_ms, row.in_r);
        if (row.speedup > 0.0) {
            fmt::print("   {:.2f} x as fast, the fastest frames {:.2f} x", row.speedup,
                       row.fastest_speedup);
        }
        fmt::print("\n");
        if (with_phases) print_phases(row.fastest);
    }
    fmt::print("\n");
    std::fflush(stdout);
}

nlohmann::ordered_json to_json(const Result& result) {
    nlohmann::ordered_json json{
        {"scene", result.scene},       {"primitives", result.primitives},
        {"build_ms", result.build_ms}, {"bytes_a_primitive", result.bytes_of_each},
        {"r_ms", result.r_ms},         {"r_speedup", result.r_speedup}};
    for (const Row& row : result.rows) {
        nlohmann::ordered_json own{{"what", row.what}, {"ms", row.median_ms}, {"r", row.in_r}};
        if (row.speedup > 0.0) {
            own["speedup"] = row.speedup;
            own["fastest_speedup"] = row.fastest_speedup;
        }
        for (const auto& [name, ms] : phases(row.fastest)) own["phases_ms"][name] = ms;
        json["rows"].push_back(own);
    }
    return json;
}

int run_sessions(const std::vector<std::string>& files, int side, int rounds,
                 const std::vector<std::string>& flags) {
    std::vector<std::pair<std::string, std::string>> settings;
    for (const std::string& flag : flags) {
        const std::size_t equals = std::min(flag.find('='), flag.size());
        settings.emplace_back(flag.substr(0, equals),
                              flag.substr(std::min(equals + 1, flag.size())));
    }
    try {
        print_heading_of_sessions();
        for (const std::string& file : files) {
            print(measure_session(file, side, rounds, settings));
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}

int compare_tracers(const std::vector<std::string>& files, const TracerPlan& plan) {
    fmt::print("{:<58}{:<13}{:>11}{:>11}{:>9}{:>11}\n", "scene", "frame", "screen ms", "Embree ms",
               "ratio", "2 threads");
    try {
        measure_tracers(files, plan, [](const TracerRow& row) {
            fmt::print("{:<58}{:<13}{:>11.2f}{:>11.2f}{:>9.2f}{:>9.2f} x\n", row.scene, row.what,
                       row.screen_ms, row.embree_ms, row.ratio, row.threads_ratio);
            std::fflush(stdout);
        });
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Measures whole frames in units of R, the time of a bare tracing loop.");
    std::vector<std::string> files;
    std::string json_file;
    Plan plan;
    bool built_in = true;
    bool with_phases = false;
    double readers_mb = 0.0;
    app.add_option("FILE", files,
                   "Scenes to measure beside the built-in ones; FILE@1: its assembly 1");
    app.add_option("--json", json_file, "Write the results as JSON");
    app.add_option("--side", plan.side, "Pixels of the square picture's side [1024]");
    app.add_option("--rounds", plan.rounds, "Rounds to take the median of [7]");
    app.add_option("--threads", plan.threads, "Threads to compare with one [2]");
    app.add_option("--only", plan.only,
                   "Only rows of these names, as 'edges, 2 px'; of --readers, as vtp; of "
                   "--tracers, as million");
    app.add_flag("--phases", with_phases, "Where the time of the fastest frame of each row goes");
    app.add_flag("!--no-stencils", plan.stencils, "Only frames of method edges");
    app.add_flag("!--no-built-in", built_in, "Only the files");
    app.add_option("--readers", readers_mb,
                   "Measure reading files of this many megabytes instead, one of each format")
        ->check(CLI::Range(1.0, 4000.0));
    bool sessions = false;
    std::vector<std::string> flags;
    app.add_flag("--session", sessions, "Measure the viewer with the files instead");
    app.add_option("--set", flags, "With --session: a setting, NAME=VALUE");
    bool tracers = false;
    app.add_flag("--tracers", tracers,
                 "Measure instead the same frames with and without Embree for camera rays");
    CLI11_PARSE(app, argc, argv);
    if (tracers) {
        return compare_tracers(files, {plan.side, plan.rounds, built_in, plan.only});
    }
    if (readers_mb > 0.0) {
        for (const ReaderRow& row : measure_readers(readers_mb, plan.only)) {
            fmt::print("{:<10}{:>8.1f} MB{:>9.0f} MB/s\n", row.format, row.megabytes,
                       row.megabytes_per_second);
            std::fflush(stdout);
        }
        return 0;
    }
    if (sessions) return run_sessions(files, plan.side, plan.rounds, flags);

    std::vector<NamedScene> scenes;
    try {
        for (const std::string& file : files) scenes.push_back(read_scene(file));
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    if (built_in) {
        scenes.push_back(bumpy_sphere(6));
        scenes.push_back(random_spheres(1'000'000));
    }

    auto json = nlohmann::ordered_json::array();
    for (const NamedScene& scene : scenes) {
        const Result result = measure(scene, plan);
        print(result, with_phases);
        json.push_back(to_json(result));
    }
    if (!json_file.empty()) std::ofstream(json_file) << json.dump(2) << '\n';
    return 0;
}

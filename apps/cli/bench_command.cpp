#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "commands.h"
#include "inktrace/inktrace.h"
#include "messages.h"
#include "scenes_dir.h"

namespace inktrace::cli {

namespace {

/// A cell of the tables; columns are no lines, N = 1, 2, 3.
struct Cell {
    double frames_per_second = 0.0;
    std::uint64_t rays = 0;
};
struct Row {
    std::string name;
    std::array<std::optional<Cell>, 4> cells;
};

constexpr std::array<const char*, 3> kRows{"No anti-aliasing", "Stencil AA", "True multisampling"};

/// Frames a second in the paper: Table 1 (one thread, 2.8 GHz Core 2 Duo) and Table 2 (eight
/// threads, two 3 GHz quad-core Xeons); 0: not applicable.
using PaperTable = std::array<std::array<double, 4>, 3>;
constexpr PaperTable kTable1{{{24.3, 3.1, 1.9, 1.0}, {0, 2.1, 0.9, 0.4}, {0, 0.4, 0.1, 0.02}}};
constexpr PaperTable kTable2{{{147.0, 30.1, 14.3, 7.8}, {0, 16.7, 6.8, 3.5}, {0, 3.5, 0.6, 0.2}}};

struct BenchArguments {
    std::string input = scenes_dir() + "/figure1.json";
    std::string json;
    std::string size = "512x512";
    int threads = 0;
};

/// The best of at least three frames, or of as many as half a second holds; a slow one counts once.
Cell measure(const Renderer& renderer, const Settings& settings) {
    constexpr double kEnoughMs = 500.0;
    Cell cell;
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

std::vector<Row> measure_table(const Renderer& renderer, const Settings& base, int threads) {
    std::vector<Row> rows;
    for (const std::string name : kRows) {
        Row row{name, {}};
        for (int rings = 0; rings <= 3; ++rings) {
            if (rings == 0 && name != kRows[0]) continue;
            Settings settings = base;
            settings.set("method", "stencil").set("metric", "linear").set("line-width", "3px");
            settings.set("threads", std::to_string(threads));
            settings.set("aa", "none");
            if (rings == 0) settings.set("compose", "shaded");
            if (rings > 0) settings.set("quality", std::to_string(rings));
            // As many samples as a stencil has rays, itself counted (the paper's footnote 3).
            const int samples = (2 * rings + 1) * (2 * rings + 1);
            if (name == kRows[1]) settings.set("aa", "stencil");
            if (name == kRows[2]) settings.set("aa", fmt::format("multisample:{}", samples));
            row.cells[static_cast<std::size_t>(rings)] = measure(renderer, settings);
        }
        rows.push_back(row);
    }
    return rows;
}

std::string short_number(double value) {
    return value < 100.0 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

void print(const std::string& title, const std::vector<Row>& rows, const PaperTable& paper) {
    fmt::print("{}\n  frames a second, their share of \"no lines\", and the paper's\n\n", title);
    fmt::print("  {:<20}", "");
    for (const char* column : {"No lines", "N = 1", "N = 2", "N = 3"}) fmt::print("{:>26}", column);
    fmt::print("\n");
    const double plain = rows[0].cells[0]->frames_per_second;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        fmt::print("  {:<20}", rows[r].name);
        for (std::size_t c = 0; c < 4; ++c) {
            const auto& cell = rows[r].cells[c];
            if (!cell) {
                fmt::print("{:>26}", "N/A");
                continue;
            }
            const double fps = cell->frames_per_second;
            fmt::print("{:>26}", fmt::format("{}  1/{}  ({:g})", short_number(fps),
                                             short_number(plain / fps), paper[r][c]));
        }
        fmt::print("\n");
    }
    fmt::print("\n");
}

nlohmann::ordered_json to_json(int threads, const std::vector<Row>& rows, const PaperTable& paper) {
    auto list = nlohmann::ordered_json::array();
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t c = 0; c < 4; ++c) {
            const auto& cell = rows[r].cells[c];
            if (!cell) continue;
            list.push_back({{"anti_aliasing", rows[r].name},
                            {"rings", c},
                            {"frames_per_second", cell->frames_per_second},
                            {"rays", cell->rays},
                            {"paper_frames_per_second", paper[r][c]}});
        }
    }
    return {{"threads", threads}, {"cells", list}};
}

void run(const BenchArguments& arguments) {
    Settings settings;
    for (const auto& [name, value] : scene_file_settings(arguments.input)) {
        settings.set(name, value);
    }
    settings.set("size", arguments.size);
    Scene scene;
    scene.load(arguments.input, settings);
    const Renderer renderer(std::move(scene));
    const int all = arguments.threads > 0
                        ? arguments.threads
                        : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));

    const std::vector<Row> single = measure_table(renderer, settings, 1);
    print("Table 1: one thread", single, kTable1);
    const std::vector<Row> several = measure_table(renderer, settings, all);
    print(fmt::format("Table 2: {} threads (the paper's: eight)", all), several, kTable2);
    if (arguments.json.empty()) return;
    const nlohmann::ordered_json json{
        {"input", arguments.input},
        {"size", arguments.size},
        {"tables", {to_json(1, single, kTable1), to_json(all, several, kTable2)}}};
    std::ofstream out(arguments.json);
    out << json.dump(2) << '\n';
    out.close();
    if (!out) {
        throw Error(Error::Kind::input,
                    fmt::format("{}: cannot be written; check the folder", arguments.json));
    }
}

}  // namespace

void add_bench_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "bench", "Measure the paper's Tables 1 and 2: frame rates of the stencil method");
    const auto arguments = std::make_shared<BenchArguments>();
    command->add_option("INPUT", arguments->input, "Scene to draw instead of acetaminophen");
    command->add_option("--size", arguments->size, "Width and height in pixels [512x512]")
        ->type_name("WxH");
    command->add_option("--threads", arguments->threads, "Threads of Table 2; 0 for all [0]")
        ->type_name("T")
        ->check(CLI::Range(0, 1024).description(""));
    command->add_option("--json", arguments->json, "Write the tables as JSON too")
        ->type_name("FILE");
    command->callback([arguments] { run(*arguments); });
}

}  // namespace inktrace::cli

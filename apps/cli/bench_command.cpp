#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "bench_tables.h"
#include "commands.h"
#include "inktrace/inktrace.h"
#include "messages.h"
#include "scenes_dir.h"

namespace inktrace::cli {

namespace {

struct BenchArguments {
    std::string input = scenes_dir() + "/figure1.json";
    std::string json;
    std::string size = "512x512";
    int threads = 0;
};

void print(const std::string& title, const std::vector<BenchRow>& rows, const PaperTable& paper) {
    fmt::print("{}\n  frames a second, their share of \"no lines\", and the paper's\n\n", title);
    fmt::print("  {:<20}", "");
    for (const char* column : kBenchColumns) fmt::print("{:>26}", column);
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

nlohmann::ordered_json to_json(int threads, const std::vector<BenchRow>& rows,
                               const PaperTable& paper) {
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

    const std::vector<BenchRow> single = measure_table(renderer, settings, 1);
    print("Table 1: one thread", single, kTable1);
    const std::vector<BenchRow> several = measure_table(renderer, settings, all);
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

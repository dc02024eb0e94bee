#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench_tables.h"
#include "commands.h"
#include "gallery_diagrams.h"
#include "gallery_figures.h"
#include "gallery_mesh.h"
#include "gallery_page.h"
#include "inktrace/inktrace.h"
#include "messages.h"
#include "scenes_dir.h"

namespace inktrace::cli {

namespace {

namespace fs = std::filesystem;

struct GalleryArguments {
    std::string output;
    std::string scenes = scenes_dir();
    std::string mesh;
    std::vector<int> figures;  ///< to draw; empty: all
    bool tables = false;
    int threads = 0;
    bool quiet = false;
};

void report(const GalleryArguments& arguments, const std::string& file) {
    if (!arguments.quiet) say(fmt::format("{}\n", file));
}

/// Adds the mesh of Figure 7, turned so that its broad side shows.
void add_mesh(const GalleryArguments& arguments, Scene& scene, Settings& settings) {
    if (arguments.mesh.empty()) return add_knot(scene);
    settings.set("view", "front");
    scene.load(arguments.mesh);
}

void draw(const Panel& panel, const GalleryArguments& arguments) {
    Scene scene;
    Settings settings;
    if (panel.scene == kMesh) {
        add_mesh(arguments, scene, settings);
    } else {
        const fs::path file = fs::path(arguments.scenes) / panel.scene;
        for (const auto& [name, value] : scene_file_settings(file)) settings.set(name, value);
        scene.load(file, settings);
    }
    for (const auto& [name, value] : panel.settings) settings.set(name, value);
    settings.set("threads", std::to_string(arguments.threads));
    const Renderer renderer(std::move(scene));
    renderer.render(settings).save(fs::path(arguments.output) / (panel.name + ".png"));
    report(arguments, panel.name + ".png");
}

void write(const fs::path& file, const std::string& text) {
    std::ofstream out(file);
    out << text;
    out.close();
    if (out) return;
    throw Error(Error::Kind::input,
                fmt::format("{}: cannot be written; check the folder", file.string()));
}

std::vector<GalleryTable> tables(const GalleryArguments& arguments) {
    const int all = arguments.threads > 0
                        ? arguments.threads
                        : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    std::vector<GalleryTable> result{
        {"Table 1: one thread", kTable1, {}},
        {fmt::format("Table 2: {} (the paper's: eight)",
                     arguments.tables ? fmt::format("{} threads", all) : "several threads"),
         kTable2,
         {}}};
    if (!arguments.tables) return result;
    const std::string file = arguments.scenes + "/figure1.json";
    Settings settings;
    for (const auto& [name, value] : scene_file_settings(file)) settings.set(name, value);
    settings.set("size", "512x512");
    Scene scene;
    scene.load(file, settings);
    const Renderer renderer(std::move(scene));
    result[0].rows = measure_table(renderer, settings, 1);
    result[1].rows = measure_table(renderer, settings, all);
    return result;
}

void run(const GalleryArguments& arguments) {
    // Not after half a minute of drawing.
    if (!arguments.mesh.empty() && !fs::exists(arguments.mesh)) {
        throw Error(Error::Kind::input,
                    fmt::format("{}: no such file; check the path", arguments.mesh));
    }
    std::error_code failure;
    fs::create_directories(arguments.output, failure);
    std::vector<Figure> figures = gallery_figures();
    int number = 0;
    std::erase_if(figures, [&](const Figure&) {
        ++number;
        return !arguments.figures.empty() && std::ranges::count(arguments.figures, number) == 0;
    });
    for (const Figure& figure : figures) {
        for (const Panel& panel : figure.panels) {
            if (panel.is_diagram) {
                write(fs::path(arguments.output) / (panel.name + ".svg"),
                      stencil_diagram(panel.name.back()));
                report(arguments, panel.name + ".svg");
            } else if (!panel.scene.empty()) {
                draw(panel, arguments);  // others are AOVs of the one before
            }
        }
    }
    const fs::path page = fs::path(arguments.output) / "index.html";
    write(page, gallery_page(figures, tables(arguments)));
    report(arguments, page.string());
}

}  // namespace

void add_gallery_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("gallery", "Draw the paper's figures and a page of them");
    const auto arguments = std::make_shared<GalleryArguments>();
    command->add_option("-o,--output", arguments->output, "Folder to write into")
        ->type_name("DIR")
        ->required();
    command->add_option("--figures", arguments->figures, "Only these, such as 3,7 [all]")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(1, 10).description(""));
    command->add_flag("--tables", arguments->tables, "Measure the paper's tables as well");
    command->add_option("--scenes", arguments->scenes, "Folder of the scene files")
        ->type_name("DIR");
    command->add_option("--mesh", arguments->mesh, "Mesh of Figure 7; else a knot is made")
        ->type_name("FILE");
    command->add_option("--threads", arguments->threads, "Threads to use; 0 for all [0]")
        ->type_name("T")
        ->check(CLI::Range(0, 1024).description(""));
    command->add_flag("--quiet", arguments->quiet, "Say nothing");
    command->callback([arguments] { run(*arguments); });
}

}  // namespace inktrace::cli

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "animate.h"
#include "commands.h"
#include "inktrace/inktrace.h"
#include "messages.h"
#include "progress_bar.h"
#include "render_arguments.h"
#include "settings_flags.h"

namespace inktrace::cli {

namespace {

/// What `--stats` reports beside the settings.
struct Report {
    double load_ms = 0.0;
    double build_ms = 0.0;
    std::size_t primitives = 0;
    std::vector<RenderStats> renders;
};

std::uint64_t peak_rss_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;  // Linux counts in kB
}

nlohmann::ordered_json to_json(const RenderArguments& arguments, const Picture& picture,
                               const Report& report) {
    nlohmann::ordered_json json{
        {"width", picture.width()},           {"height", picture.height()},
        {"threads", picture.stats().threads}, {"method", arguments.settings.get("method")},
        {"primitives", report.primitives},    {"load_ms", report.load_ms},
        {"build_ms", report.build_ms}};
    const auto list = [&](double RenderStats::*time) {
        auto times = nlohmann::ordered_json::array();
        for (const RenderStats& stats : report.renders) times.push_back(stats.*time);
        return times;
    };
    json["render_ms"] = list(&RenderStats::render_ms);
    json["trace_ms"] = list(&RenderStats::trace_ms);
    json["lines_ms"] = list(&RenderStats::lines_ms);
    json["shade_ms"] = list(&RenderStats::shade_ms);
    json["curves_ms"] = list(&RenderStats::curves_ms);
    json["rays"] = picture.stats().rays;
    json["crossings"] = picture.stats().crossings;
    json["peak_rss_bytes"] = peak_rss_bytes();
    return json;
}

[[noreturn]] void refuse_stats(const std::filesystem::path& file) {
    throw Error(Error::Kind::input, fmt::format("{}: cannot write the statistics; check that the "
                                                "folder exists, may be written and has space",
                                                file.string()));
}

/// Says before the work begins what would go wrong after it.
void check_stats_file(const std::filesystem::path& file) {
    if (file.empty()) return;
    std::error_code missing;
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    const bool exists = std::filesystem::exists(file, missing);
    if (std::filesystem::is_directory(file, missing) ||
        access((exists ? file : folder).c_str(), W_OK) != 0) {
        refuse_stats(file);
    }
}

void write_stats(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
    std::ofstream out(file);
    out << json.dump(2) << '\n';
    out.close();
    if (out) return;
    std::error_code failure;
    if (std::filesystem::is_regular_file(file, failure)) std::filesystem::remove(file, failure);
    refuse_stats(file);
}

/// Says what curves cannot show of the settings.
void warn_about_curves(const RenderArguments& arguments) {
    const Settings& settings = arguments.settings;
    const std::string metric = settings.get("metric");
    if (!metric.empty() && metric != "solid") {
        say(
            fmt::format("{}: warning: curves have no soft profile: lines are solid, without "
                        "--metric {}\n",
                        arguments.output, metric));
    }
    if (settings.get("halo") != Settings().get("halo")) {
        say(
            fmt::format("{}: warning: curves have no halos: lines go on to the ones in front, "
                        "without --halo {}\n",
                        arguments.output, settings.get("halo")));
    }
}

void run(const RenderArguments& arguments) {
    if (is_animation(arguments)) return run_animation(arguments);
    RenderOptions options = options_for_output(arguments.output);
    if (!arguments.lines_file.empty()) {
        check_output(arguments.lines_file);
        options.curves = true;
    }
    validate(arguments.settings, options);
    if (!options.inked && !arguments.quiet) warn_about_curves(arguments);
    check_stats_file(arguments.stats_file);
    const auto start = std::chrono::steady_clock::now();
    Report report;
    Scene scene = load(arguments, arguments.settings).scene;
    if (!arguments.quiet) announce_cost(scene, arguments.output);
    report.load_ms = ms_since(start);
    report.primitives = scene.primitive_count();

    const Renderer renderer(std::move(scene));
    report.build_ms = renderer.build_ms();

    std::optional<Picture> picture;
    for (int k = 0; k < arguments.repeat; ++k) {
        ProgressBar bar(!arguments.quiet);
        options.progress = [&](double share, double megapixels) { bar.update(share, megapixels); };
        picture.reset();
        picture.emplace(renderer.render(arguments.settings, options));
        report.renders.push_back(picture->stats());
    }
    picture->save(arguments.output);
    if (!arguments.lines_file.empty()) picture->save_lines(arguments.lines_file);
    if (!arguments.stats_file.empty()) {
        write_stats(arguments.stats_file, to_json(arguments, *picture, report));
    }
    if (!arguments.quiet) {
        say(fmt::format("{}: {} x {} pixels, {} primitive{}, {:.2f} s\n", arguments.output,
                        picture->width(), picture->height(), report.primitives,
                        report.primitives == 1 ? "" : "s", ms_since(start) / 1000));
    }
}

/// "1crn.png" in the working folder for "molecules/1crn.pdb.gz". Throws Error (usage) where there
/// is such a file: it may be no picture of ours.
std::string default_output(const std::filesystem::path& input) {
    std::filesystem::path name =
        input.has_filename() ? input.filename() : input.parent_path().filename();
    if (name.extension() == ".gz") name.replace_extension();
    name.replace_extension(".png");
    std::error_code failure;
    if (std::filesystem::exists(name, failure)) {
        throw Error(Error::Kind::usage,
                    fmt::format("{} exists; say with -o where the picture goes", name.string()));
    }
    return name.string();
}

/// Settings of scene files, and over them the flags that were given.
void take_scene_settings(const CLI::App& command, RenderArguments& arguments) {
    Settings settings;
    bool any = false;
    for (const std::string& input : arguments.inputs) {
        for (const auto& [name, value] : scene_file_settings(input)) {
            settings.set(name, value);
            any = true;
        }
    }
    if (!any) return;
    for (const SettingInfo& info : all_settings()) {
        const CLI::Option* flag = command.get_option_no_throw("--" + info.name);
        if (flag == nullptr || flag->count() == 0) continue;
        for (const std::string& value : flag->results()) settings.set(info.name, value);
    }
    arguments.settings = settings;
}

}  // namespace

void add_render_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("render", "Draw files as one picture");
    const auto arguments = std::make_shared<RenderArguments>();
    command->add_option("INPUT", arguments->inputs, "Files to draw together");
    command
        ->add_option("--scene", arguments->scene,
                     "Scene file to draw: objects and settings as JSON; flags go before it")
        ->type_name("FILE")
        ->group("Input");
    command
        ->add_option("-o,--output", arguments->output,
                     "Picture to write: .png, .jpg, .tiff, .exr; as curves: .svg, .svgz, .pdf; "
                     "### in its name is the number of a frame; .mp4: a film of frames, by ffmpeg; "
                     "by default the input's name with .png, here")
        ->type_name("FILE")
        ->group("Picture");
    add_setting_flags(*command, arguments->settings);
    command
        ->add_option("--lines-json", arguments->lines_file,
                     "Write the lines as polylines with their types, names and depths, too")
        ->type_name("FILE")
        ->group("Curves");
    command->add_option("--repeat", arguments->repeat, "Render this many times, to measure [1]")
        ->type_name("K")
        ->check(CLI::Range(1, 1000000).description(""))
        ->group("Run");
    command
        ->add_option("--turntable", arguments->turntable,
                     "Pictures of a full turn round the scene, for -o out_###.png or out.mp4")
        ->type_name("K")
        ->check(CLI::Range(1, 100000).description(""))
        ->group("Picture");
    command->add_option("--fps", arguments->pictures_a_second, "Pictures a second of a film [25]")
        ->type_name("R")
        ->check(CLI::Range(0.1, 1000.0).description(""))
        ->group("Picture");
    command
        ->add_flag("--resume", arguments->resume,
                   "Leave those pictures of an animation that are there already")
        ->group("Run");
    command->add_option("--stats", arguments->stats_file, "Write times and counts as JSON")
        ->type_name("FILE")
        ->group("Run");
    command->add_flag("--quiet", arguments->quiet, "No progress bar and no closing line")
        ->group("Run");
    command->footer(
        "Example: inktrace render 1crn.pdb -o crambin.png --line-width 0.5pt --dpi 300");
    command->callback([command, arguments] {
        if (!arguments->scene.empty()) {
            arguments->inputs.insert(arguments->inputs.begin(), arguments->scene);
        }
        if (arguments->inputs.empty()) throw CLI::RequiredError("INPUT");
        if (arguments->output.empty())
            arguments->output = default_output(arguments->inputs.front());
        take_scene_settings(*command, *arguments);
        run(*arguments);
    });
}

}  // namespace inktrace::cli

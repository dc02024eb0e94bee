#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "inktrace/inktrace.h"
#include "program.h"
#include "session/keep_memory.h"
#include "window/viewer.h"

namespace {

using namespace inktrace;

int fail(const std::string& problem, int status) {
    std::fputs(fmt::format("inktrace view: {}\n", problem).c_str(), stderr);
    return status;
}

/// Flags as names and values, in the order of the table.
std::vector<std::pair<std::string, std::string>> given(const CLI::App& app) {
    std::vector<std::pair<std::string, std::string>> flags;
    for (const SettingInfo& info : all_settings()) {
        const CLI::Option* flag = app.get_option_no_throw("--" + info.name);
        if (flag == nullptr || flag->count() == 0) continue;
        for (const std::string& value : flag->results()) flags.emplace_back(info.name, value);
    }
    return flags;
}

void add_flags(CLI::App& app) {
    for (const SettingInfo& info : all_settings()) {
        if (info.name == "size") continue;  // the window's
        using Policy = CLI::MultiOptionPolicy;
        app.add_option("--" + info.name, info.help)
            ->type_name(info.value)
            ->group(info.topic)
            ->expected(1)
            ->allow_extra_args(false)
            ->multi_option_policy(info.repeatable ? Policy::TakeAll : Policy::TakeLast);
    }
}

int run(int argc, char** argv) {
    CLI::App app("Show files in a window: turn them, change the settings, write pictures",
                 "inktrace view");
    std::vector<std::string> files;
    app.add_option("INPUT", files, "Files to draw together");
    add_flags(app);
    app.set_version_flag("--version", std::string("inktrace ") + inktrace::version());
    app.footer("Press ? in the window for the keys. Example: inktrace view 1crn.pdb");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        return fail(std::string(error.what()) + "\nSee 'inktrace view --help'.", kBadUsage);
    }
    viewer::keep_memory();
    try {
        const auto flags = given(app);
        Settings settings;  // what makes no sense is said before a window opens
        for (const auto& [name, value] : flags) settings.set(name, value);
        viewer::Viewer({files.begin(), files.end()}, flags).run();
    } catch (const Error& error) {
        return fail(error.what(), exit_status(error));
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    watch_signals();
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        return fail(error.what(), kBadInput);
    }
}

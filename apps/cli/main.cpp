#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <string>

#include "commands.h"
#include "inktrace/inktrace.h"

namespace {

// Exit status: 0 done, 1 bad input or failed run, 2 bad usage.
constexpr int kBadInput = 1;
constexpr int kBadUsage = 2;

/// Ends the program as the signal would have, less half-written files.
extern "C" void end_cleanly(int signal) {
    inktrace::remove_unfinished_files();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

std::string formats() {
    std::string text = "Reads (all also as .gz where the format is text):";
    for (const auto& [name, extensions] : inktrace::input_formats()) {
        text += fmt::format("\n  {:<8}{}", name, extensions);
    }
    return text;
}

int report_usage(const CLI::App& app, const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    std::string message = error.what();
    if (const auto* extras = dynamic_cast<const CLI::ExtrasError*>(&error)) {
        (void)extras;
        const std::size_t dashes = message.find("--");
        if (dashes != std::string::npos) {
            const std::string name = message.substr(dashes + 2);
            try {
                (void)inktrace::Settings().get(name.substr(0, name.find_first_of(" =")));
            } catch (const inktrace::Error& unknown) {
                message = unknown.what();
            }
        }
    }
    fmt::print(stderr, "inktrace: {}\nSee 'inktrace --help' and 'inktrace render --help'.\n", message);
    return kBadUsage;
}

int run(int argc, char** argv) {
    CLI::App app("Inktrace draws molecules, particles and meshes with feature lines of exact width.",
                 "inktrace");
    app.set_version_flag("--version", std::string("inktrace ") + inktrace::version());
    app.require_subcommand(1);
    app.footer(formats);
    inktrace::cli::add_render_command(app);
    inktrace::cli::add_info_command(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return report_usage(app, error);
    } catch (const inktrace::Error& error) {
        fmt::print(stderr, "inktrace: {}\n", error.what());
        return error.kind() == inktrace::Error::Kind::usage ? kBadUsage : kBadInput;
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, end_cleanly);
    // A full disk quota or a closed pipe then fails the write, which says so and cleans up.
    for (const int signal : {SIGXFSZ, SIGPIPE}) std::signal(signal, SIG_IGN);
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "inktrace: {}\n", error.what());
        return kBadInput;
    }
}

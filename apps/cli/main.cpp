#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/text.h"
#include "commands.h"
#include "inktrace/inktrace.h"
#include "messages.h"
#include "program.h"

namespace {

std::string formats() {
    std::string text =
        "'inktrace FILE...' is short for 'inktrace render FILE...'.\n\n"
        "Reads (all of them also compressed, as .gz):";
    for (const auto& [name, extensions] : inktrace::input_formats()) {
        text += fmt::format("\n  {:<15}{}", name, extensions);
    }
    return text;
}

/// What is wrong with the first argument that nothing wanted, and what may have been meant.
std::string unknown_argument(const CLI::App& app) {
    const auto commands = app.get_subcommands();
    const CLI::App& asked = commands.empty() ? app : *commands.front();
    std::string word = app.remaining(true).front();
    word.resize(std::min(word.find('='), word.size()));

    const bool is_flag = word.starts_with('-');
    std::vector<std::string_view> known;
    if (is_flag) {
        for (const CLI::Option* option : asked.get_options()) {
            known.insert(known.end(), option->get_lnames().begin(), option->get_lnames().end());
        }
    } else {
        for (const CLI::App* command : asked.get_subcommands({})) {
            known.push_back(command->get_name());
        }
    }
    std::string text =
        fmt::format("there is no {} '{}'", is_flag ? "flag" : "command or file", word);
    const std::string_view dashes = is_flag ? "--" : "";
    if (!word.starts_with(dashes)) return text;  // one letter resembles everything
    const std::string_view name = std::string_view(word).substr(dashes.size());
    if (is_flag && name == "o") return text + "; did you mean -o?";
    const std::string_view guess = ink::closest(name, known);
    if (!guess.empty()) text += fmt::format("; did you mean {}{}?", dashes, guess);
    return text;
}

int report_usage(std::string_view problem) {
    inktrace::cli::say(fmt::format(
        "inktrace: {}\nSee 'inktrace --help' and 'inktrace render --help'.\n", problem));
    return inktrace::kBadUsage;
}

/// What was typed; `inktrace FILE...` is short for `inktrace render FILE...`, and `help` means
/// `--help`.
std::vector<std::string> arguments(const CLI::App& app, int argc, char** argv) {
    std::vector<std::string> words(argv + 1, argv + argc);
    if (words.empty()) return words;
    if (words.front() == "help") words.front() = "--help";
    const std::string& first = words.front();
    std::error_code failure;
    const bool is_command =
        std::ranges::any_of(app.get_subcommands({}),
                            [&](const CLI::App* command) { return command->get_name() == first; });
    if (!is_command && std::filesystem::exists(first, failure)) {
        words.insert(words.begin(), "render");
    }
    return words;
}

int run(int argc, char** argv) {
    CLI::App app(
        "Inktrace draws molecules, particles and meshes with feature lines of exact width.",
        "inktrace");
    app.set_version_flag("--version", std::string("inktrace ") + inktrace::version());
    app.footer(formats);
    inktrace::cli::add_render_command(app);
    inktrace::cli::add_info_command(app);
    inktrace::cli::add_view_command(app);
    inktrace::cli::add_gallery_command(app);
    inktrace::cli::add_bench_command(app);
    try {
        std::vector<std::string> words = arguments(app, argc, argv);
        std::ranges::reverse(words);  // as CLI11 takes them
        app.parse(std::move(words));
        if (app.get_subcommands().empty())
            return report_usage("a file to draw or a command is missing");
    } catch (const CLI::ExtrasError&) {
        return report_usage(unknown_argument(app));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
        return report_usage(error.what());
    } catch (const inktrace::Error& error) {
        inktrace::cli::say(fmt::format("inktrace: {}\n", error.what()));
        return exit_status(error);
    }
    if (std::fflush(stdout) != 0) {
        inktrace::cli::say("inktrace: standard output cannot be written; check the disk\n");
        return inktrace::kBadInput;
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    inktrace::watch_signals();
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        inktrace::cli::say(fmt::format("inktrace: {}\n", error.what()));
        return inktrace::kBadInput;
    }
}

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "commands.h"
#include "inktrace/inktrace.h"

namespace inktrace::cli {

namespace {

/// Becomes the program with the window, which lies beside this one.
[[noreturn]] void start_viewer(const std::vector<std::string>& arguments) {
    std::error_code failure;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failure);
    const std::filesystem::path program = self.parent_path() / "inktrace-view";
    std::string name = "inktrace view";
    std::vector<std::string> copies = arguments;
    std::vector<char*> words{name.data()};
    for (std::string& word : copies) words.push_back(word.data());
    words.push_back(nullptr);
    execv(program.c_str(), words.data());
    throw Error(Error::Kind::input,
                fmt::format("{}: cannot be started ({}); it is built with inktrace and has to lie "
                            "beside it",
                            program.string(), std::strerror(errno)));
}

}  // namespace

void add_view_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("view", "Show files in a window, to turn and tune them");
    command->prefix_command();  // the other program reads the rest
    command->set_help_flag();
    command->callback([command] { start_viewer(command->remaining()); });
}

}  // namespace inktrace::cli

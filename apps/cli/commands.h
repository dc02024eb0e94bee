#pragma once

#include <CLI/CLI.hpp>

namespace inktrace::cli {

/// Adds `inktrace render` to the program. It runs when the arguments are parsed.
void add_render_command(CLI::App& app);

/// Adds `inktrace info`.
void add_info_command(CLI::App& app);

/// Adds `inktrace gallery`.
void add_gallery_command(CLI::App& app);

/// Adds `inktrace bench`.
void add_bench_command(CLI::App& app);

/// Adds `inktrace view`, which starts another program: the window's libraries are slow to load.
void add_view_command(CLI::App& app);

}  // namespace inktrace::cli

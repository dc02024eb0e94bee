#pragma once

#include <CLI/CLI.hpp>

#include "inktrace/settings.h"

namespace inktrace::cli {

/// Adds a flag for every setting, in groups by topic; given ones go into `settings`.
void add_setting_flags(CLI::App& command, Settings& settings);

}  // namespace inktrace::cli

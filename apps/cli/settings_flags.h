#pragma once

#include <CLI/CLI.hpp>

#include "inktrace/settings.h"

namespace inktrace::cli {

/// Adds a flag for every setting of one topic, or of all, in groups; given ones go into `settings`.
void add_setting_flags(CLI::App& command, Settings& settings, std::string_view topic = {});

}  // namespace inktrace::cli

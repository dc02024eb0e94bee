#pragma once

#include <cstdio>
#include <string>

namespace inktrace::cli {

/// Writes to standard error. Where nobody can read it, that must not end a run.
inline void say(const std::string& text) { std::fputs(text.c_str(), stderr); }

}  // namespace inktrace::cli

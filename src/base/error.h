#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace ink {

/// Anything the user can put right. The message says what is wrong and what to do.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file that cannot be read or makes no sense: "water.xyz:3: unknown element 'Xx'; ...".
struct InputError : Error {
    InputError(const std::filesystem::path& file, std::string_view problem);
    /// `line` counts from 1.
    InputError(const std::filesystem::path& file, std::size_t line, std::string_view problem);
};

/// A file that cannot be written.
struct OutputError : Error {
    OutputError(const std::filesystem::path& file, std::string_view problem);
};

/// A setting whose value is out of range or unreadable.
struct UsageError : Error {
    using Error::Error;
};

/// The user asked to stop.
struct Cancelled : Error {
    Cancelled() : Error("cancelled") {}
};

}  // namespace ink

#include "base/error.h"

#include <fmt/format.h>

namespace ink {

InputError::InputError(const std::filesystem::path& file, std::string_view problem)
    : Error(fmt::format("{}: {}", file.string(), problem)) {}

InputError::InputError(const std::filesystem::path& file, std::size_t line,
                       std::string_view problem)
    : Error(fmt::format("{}:{}: {}", file.string(), line, problem)) {}

OutputError::OutputError(const std::filesystem::path& file, std::string_view problem)
    : Error(fmt::format("{}: {}", file.string(), problem)) {}

}  // namespace ink

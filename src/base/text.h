#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ink {

/// Text without the blanks at its ends.
std::string_view trim(std::string_view text);

/// The pieces between separators, trimmed; "a,,b" has an empty one in the middle.
std::vector<std::string_view> split(std::string_view text, char separator);

/// ASCII letters in lower case.
std::string to_lower(std::string_view text);

/// The whole text as a number; nothing when any of it is not one, or it does not fit. Blanks at
/// the ends and a leading plus are allowed. The locale does not matter.
std::optional<double> parse_double(std::string_view text);
std::optional<std::int64_t> parse_int(std::string_view text);
std::optional<std::uint32_t> parse_hex_number(std::string_view digits);

/// The candidate that is closest to `word` by edit distance, for "did you mean"; empty when none
/// is close.
std::string_view closest(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace ink

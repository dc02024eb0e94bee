#pragma once

#include <string>
#include <string_view>

namespace ink {

/// Text for XML 1.0, between tags or in a quoted attribute: what has a meaning there is escaped,
/// and what may not be there at all (control characters, bytes that are no UTF-8, surrogates,
/// non-characters) becomes U+FFFD, the replacement character.
std::string xml_text(std::string_view text);

/// The same text with U+FFFD for what is no UTF-8 and for control characters.
std::string valid_utf8(std::string_view text);

/// A name for a CSS class: letters, digits, '-' and '_' stay, each run of anything else becomes
/// '-'.
std::string class_name(std::string_view prefix, std::string_view text);

}  // namespace ink

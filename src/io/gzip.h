#pragma once

#include <string>
#include <string_view>

namespace ink {

/// Text as a gzip file holds it, without a name or a time in it: the same text gives the same
/// bytes.
std::string gzipped(std::string_view text);

}  // namespace ink

#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace ink {

/// Text beyond this is refused: a few megabytes of gzip can unpack to more than any memory holds.
inline constexpr std::size_t kLargestText = std::size_t{4} << 30;

/// The whole file, unpacked where its first bytes say gzip (whatever its name). Throws InputError
/// where it cannot be read, is damaged, or would be larger than `limit`.
std::string read_text(const std::filesystem::path& file, std::size_t limit = kLargestText);

/// Memory is granted before it is there: what is too large would get the program killed on the way.
/// Throws InputError where this many bytes of a file, and what is made of them, do not fit.
void check_memory(const std::filesystem::path& file, std::size_t bytes);

/// Walks over the lines of a text, which must outlive it.
class LineCursor {
  public:
    explicit LineCursor(std::string_view text) : rest_(text) {}

    /// Steps to the next line; false at the end of the text.
    bool next() {
        if (rest_.empty()) return false;
        ++number_;
        const std::size_t end = rest_.find('\n');
        line_ = rest_.substr(0, end);
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
        if (line_.ends_with('\r')) line_.remove_suffix(1);
        return true;
    }

    std::string_view line() const { return line_; }  ///< without its line ending
    std::size_t number() const { return number_; }   ///< from 1; 0 before the first `next`
    std::string_view rest() const { return rest_; }  ///< what follows the line

  private:
    std::string_view rest_;
    std::string_view line_;
    std::size_t number_ = 0;
};

/// The next word of a line, cut off its front; empty at the end.
inline std::string_view take_word(std::string_view& line) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    std::size_t begin = 0;
    while (begin < line.size() && is_blank(line[begin])) ++begin;
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end])) ++end;
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

/// `text`, or its beginning, for a message: a damaged file can have lines of any length and bytes
/// of any value.
std::string excerpt(std::string_view text);

}  // namespace ink

#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

// C++17: see CMakeLists.txt.
namespace ink {

/// What a CIF file says, as it goes by. The views stay valid as long as the text. Values are as
/// they are written, with their quotes; lines count from 1.
class CifVisitor {
  public:
    CifVisitor() = default;
    CifVisitor(const CifVisitor&) = delete;
    CifVisitor& operator=(const CifVisitor&) = delete;
    virtual ~CifVisitor() = default;

    virtual void begin_block() = 0;
    virtual void add_item(std::string_view tag, std::string_view value, std::size_t line) = 0;
    virtual void begin_loop() = 0;
    virtual void add_tag(std::string_view tag) = 0;
    virtual void add_value(std::string_view value, std::size_t line) = 0;
    virtual void end_loop() = 0;
};

struct CifSyntaxError : std::runtime_error {
    CifSyntaxError(const std::string& problem, std::size_t at)
        : std::runtime_error(problem), line(at) {}
    std::size_t line;
};

/// Walks over a whole CIF text by gemmi's grammar. Throws CifSyntaxError, and what `visitor`
/// throws.
void walk_cif(std::string_view text, CifVisitor& visitor);

}  // namespace ink

#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

// C++17: see CMakeLists.txt.
namespace ink {

/// The loops of a CIF file as they go by. The views stay valid as long as the text.
class CifLoops {
  public:
    CifLoops() = default;
    CifLoops(const CifLoops&) = delete;
    CifLoops& operator=(const CifLoops&) = delete;
    virtual ~CifLoops() = default;

    virtual void begin_loop() = 0;
    virtual void add_tag(std::string_view tag) = 0;
    /// `value` as it is written, with its quotes; `line` counts from 1.
    virtual void add_value(std::string_view value, std::size_t line) = 0;
    virtual void end_loop() = 0;
};

struct CifSyntaxError : std::runtime_error {
    CifSyntaxError(const std::string& problem, std::size_t at)
        : std::runtime_error(problem), line(at) {}
    std::size_t line;
};

/// Walks over a whole CIF text by gemmi's grammar. Throws CifSyntaxError, and what `loops` throws.
void walk_cif(std::string_view text, CifLoops& loops);

}  // namespace ink

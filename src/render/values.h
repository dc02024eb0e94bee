#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/color.h"

namespace ink {

/// A length on the picture, in the unit that it was given in.
struct Length {
    enum class Unit : std::uint8_t { px, pt, mm, percent };  ///< percent of the picture's height
    double value = 0.0;
    Unit unit = Unit::px;

    double pixels(double dpi, int picture_height) const;
    friend bool operator==(const Length&, const Length&) = default;
};

// Readers of settings' values. They throw UsageError without the setting's name; the table of
// settings adds it.

double read_number(std::string_view text, double least, double most);
int read_int(std::string_view text, int least, int most);
Rgb8 read_color(std::string_view text);
Length read_length(std::string_view text, bool zero_allowed = false);

/// In the form that read_length reads.
std::string print(const Length& length);

}  // namespace ink

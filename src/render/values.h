#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/color.h"
#include "base/vec.h"

namespace ink {

/// A length on the picture, in the unit that it was given in.
struct Length {
    enum class Unit : std::uint8_t { px, pt, mm, percent };  ///< percent of the picture's height
    double value = 0.0;
    Unit unit = Unit::px;

    double pixels(double dpi, int picture_height) const;
    friend bool operator==(const Length&, const Length&) = default;
};

/// What a value may be, for user interfaces; `Setting::set` has the last word.
struct ValueForm {
    enum class Kind : std::uint8_t { text, word, list, whole, number, length, color };
    Kind kind = Kind::text;
    std::vector<std::string_view> words = {};  ///< of text: some that are allowed
    double least = 0.0;
    double most = 0.0;  ///< that is usual; more may be allowed
};

/// Forms of a few kinds.
ValueForm whole(double least, double most);
ValueForm number(double least, double most);
ValueForm length_px(double least, double most);
ValueForm color();
ValueForm any_text(std::vector<std::string_view> some_words);

// Readers of settings' values. They throw UsageError without the setting's name; the table of
// settings adds it.

double read_number(std::string_view text, double least, double most);
int read_int(std::string_view text, int least, int most);
Rgb8 read_color(std::string_view text);
Length read_length(std::string_view text, bool zero_allowed = false);

Vec3d read_vector(std::string_view text);

/// "key=value".
struct Property {
    std::string_view key;
    std::string value;
};
/// Reads "key=value,...". A value may have commas of its own: what has no '=' goes on with the
/// value before it.
std::vector<Property> read_properties(std::string_view text);

/// In the form that read_length reads.
std::string print(const Length& length);

}  // namespace ink

#include "vector/path_data.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <iterator>

namespace ink {

namespace {

/// In hundredths of a pixel.
struct Place {
    std::int64_t x, y;

    static Place of(Vec2f point) {
        const auto hundredths = [](float value) -> std::int64_t {
            return std::llround(value * 100.0F);
        };
        return {hundredths(point.x), hundredths(point.y)};
    }
};

/// The shortest way to write it. A sign parts it from the number before, else a blank does.
void append_number(std::string& text, std::int64_t hundredths) {
    const bool after_number = text.back() >= '0' && text.back() <= '9';
    if (hundredths < 0) {
        text += '-';
        hundredths = -hundredths;
    } else if (after_number) {
        text += ' ';
    }
    const std::int64_t whole = hundredths / 100;
    const auto rest = static_cast<int>(hundredths % 100);
    if (whole != 0 || rest == 0) fmt::format_to(std::back_inserter(text), "{}", whole);
    if (rest == 0) return;
    text += '.';
    text += static_cast<char>('0' + rest / 10);
    if (rest % 10 != 0) text += static_cast<char>('0' + rest % 10);
}

}  // namespace

void append_path_data(std::string& text, const Curve& curve, bool closed) {
    Place at = Place::of(curve.start);
    text += 'M';
    append_number(text, at.x);
    append_number(text, at.y);
    char command = 'M';
    const auto draw = [&](char how, std::initializer_list<Vec2f> points) {
        // One that is repeated need not be said again.
        if (how != command) text += how;
        command = how;
        Place next{};
        for (const Vec2f point : points) {
            next = Place::of(point);
            append_number(text, next.x - at.x);
            append_number(text, next.y - at.y);
        }
        at = next;
    };
    for (const CurvePiece& piece : curve.pieces) {
        if (piece.straight) {
            draw('l', {piece.end});
        } else {
            draw('c', {piece.control1, piece.control2, piece.end});
        }
    }
    if (closed) text += 'Z';
}

}  // namespace ink

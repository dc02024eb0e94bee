#include "vector/xml_text.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace ink {

namespace {

/// One character of UTF-8 and how many bytes it takes; no bytes: there is none at the front.
struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 0;
};

Character first_character(std::string_view text) {
    const auto byte = [&](std::size_t k) -> std::uint32_t {
        return static_cast<unsigned char>(text[k]);
    };
    if (byte(0) < 0x80) return {byte(0), 1};
    constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
    const std::size_t count = byte(0) >= 0xF8   ? 0
                              : byte(0) >= 0xF0 ? 4
                              : byte(0) >= 0xE0 ? 3
                              : byte(0) >= 0xC0 ? 2
                                                : 0;
    if (count == 0 || text.size() < count) return {};
    std::uint32_t code = byte(0) & (0x7FU >> count);
    for (std::size_t k = 1; k < count; ++k) {
        if ((byte(k) & 0xC0U) != 0x80U) return {};
        code = code << 6U | (byte(k) & 0x3FU);
    }
    return code < kLeast[count] ? Character{} : Character{code, count};
}

/// The production Char of XML 1.0, without the non-characters and the C1 controls that it allows.
bool allowed(std::uint32_t code) {
    if (code == '\t' || code == '\n' || code == '\r') return true;
    if (code < 0x20 || (code >= 0x7F && code < 0xA0)) return false;
    if (code >= 0xD800 && code <= 0xDFFF) return false;
    if (code >= 0xFDD0 && code <= 0xFDEF) return false;
    return code <= 0x10FFFF && (code & 0xFFFEU) != 0xFFFEU;
}

}  // namespace

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// Calls `add` with each character, or its replacement, and its code.
template <class Add>
void for_characters(std::string_view text, const Add& add) {
    while (!text.empty()) {
        const Character character = first_character(text);
        const bool good = character.bytes > 0 && allowed(character.code);
        add(good ? text.substr(0, character.bytes) : kReplacement, good ? character.code : 0xFFFD);
        text.remove_prefix(character.bytes > 0 ? character.bytes : 1);
    }
}

}  // namespace

std::string xml_text(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for_characters(text, [&](std::string_view character, std::uint32_t code) {
        switch (code) {
            case '&': out += "&amp;"; break;
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '"': out += "&quot;"; break;
            case '\'': out += "&#39;"; break;
            // As references, or reading an attribute turns them into blanks.
            case '\t': out += "&#9;"; break;
            case '\n': out += "&#10;"; break;
            case '\r': out += "&#13;"; break;
            default: out += character;
        }
    });
    return out;
}

std::string valid_utf8(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for_characters(text, [&](std::string_view character, std::uint32_t) { out += character; });
    return out;
}

std::string class_name(std::string_view prefix, std::string_view text) {
    std::string name(prefix);
    bool gap = false;
    for (const char c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == '_' || c == '-';
        if (plain && gap) name += '-';
        if (plain) name += c;
        gap = !plain;
    }
    return name;
}

}  // namespace ink

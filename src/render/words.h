#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "render/values.h"

namespace ink {

/// Empty text stands for what is chosen automatically.
template <class Read>
auto read_optional(std::string_view text, const Read& read) -> std::optional<decltype(read(text))> {
    if (text.empty()) return std::nullopt;
    return read(text);
}

/// A closed list of words and what they stand for.
template <class T>
struct Words {
    std::vector<std::pair<std::string_view, T>> entries;

    std::optional<T> find(std::string_view text) const {
        for (const auto& [word, value] : entries) {
            if (word == text) return value;
        }
        return std::nullopt;
    }
    std::string all_words() const {
        std::vector<std::string_view> words;
        for (const auto& entry : entries) words.push_back(entry.first);
        return fmt::format("{}", fmt::join(words, ", "));
    }

    T read(std::string_view text) const {
        if (const auto value = find(text)) return *value;
        throw UsageError(fmt::format("'{}' is not one of {}", text, all_words()));
    }
    std::string print(T value) const {
        for (const auto& [word, entry] : entries) {
            if (entry == value) return std::string(word);
        }
        return {};
    }
    /// A comma-separated list; "none" is the empty one, "all" every word.
    std::vector<T> read_list(std::string_view text) const {
        std::vector<T> list;
        if (text == "none") return list;
        if (text == "all") {
            for (const auto& entry : entries) list.push_back(entry.second);
            return list;
        }
        for (const std::string_view word : split(text, ',')) {
            const auto value = find(word);
            if (!value) {
                throw UsageError(
                    fmt::format("'{}' is not one of {}; several go with commas, all "
                                "and none stand alone",
                                word, all_words()));
            }
            if (std::ranges::find(list, *value) == list.end()) list.push_back(*value);
        }
        return list;
    }
    std::string print_list(const std::vector<T>& list) const {
        if (list.empty()) return "none";
        std::vector<std::string> words;
        words.reserve(list.size());
        for (const T value : list) words.push_back(print(value));
        return fmt::format("{}", fmt::join(words, ","));
    }
};

template <class T>
ValueForm words_of(ValueForm::Kind kind, const Words<T>& words) {
    ValueForm form{kind};
    for (const auto& entry : words.entries) form.words.push_back(entry.first);
    return form;
}
template <class T>
ValueForm one_of(const Words<T>& words) {
    return words_of(ValueForm::Kind::word, words);
}
template <class T>
ValueForm some_of(const Words<T>& words) {
    return words_of(ValueForm::Kind::list, words);
}

}  // namespace ink

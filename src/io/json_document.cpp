#include "io/json_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/reader.h"

namespace ink {

JsonValue::JsonValue() = default;
JsonValue::JsonValue(const JsonValue& other) = default;
JsonValue::JsonValue(JsonValue&& other) noexcept = default;
JsonValue& JsonValue::operator=(const JsonValue& other) = default;
JsonValue& JsonValue::operator=(JsonValue&& other) noexcept = default;
JsonValue::~JsonValue() = default;

namespace {

constexpr std::size_t kLargestScene = std::size_t{1} << 30;
constexpr std::size_t kDeepest = 32;

/// Walks over a text and leaves behind how far it has come, so that events of the parser can be
/// told their line.
class WatchedIterator {
  public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    WatchedIterator() = default;
    WatchedIterator(const char* at, const char** reached) : at_(at), reached_(reached) {}
    reference operator*() const { return *at_; }
    WatchedIterator& operator++() {
        *reached_ = ++at_;
        return *this;
    }
    WatchedIterator operator++(int) {
        WatchedIterator before = *this;
        ++*this;
        return before;
    }
    bool operator==(const WatchedIterator& other) const { return at_ == other.at_; }

  private:
    const char* at_ = nullptr;
    const char** reached_ = nullptr;
};

/// Builds the values from the parser's events.
class Builder {
  public:
    Builder(const std::filesystem::path& file, std::string_view text)
        : reached(text.data()), file_(file), counted_(text.data()) {}

    bool null() { return add({}); }
    bool boolean(bool value) {
        JsonValue v = make(JsonValue::Kind::boolean);
        v.boolean = value;
        return add(std::move(v));
    }
    bool number_integer(std::int64_t value) { return add_number(static_cast<double>(value)); }
    bool number_unsigned(std::uint64_t value) { return add_number(static_cast<double>(value)); }
    bool number_float(double value, const std::string& /*text*/) { return add_number(value); }
    bool string(std::string& value) {
        JsonValue v = make(JsonValue::Kind::text);
        v.text = std::move(value);
        return add(std::move(v));
    }
    bool binary(std::vector<std::uint8_t>& /*value*/) { return false; }
    bool start_object(std::size_t /*size*/) { return open(JsonValue::Kind::object); }
    bool start_array(std::size_t /*size*/) { return open(JsonValue::Kind::list); }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool key(std::string& name) {
        for (const auto& [other, value] : open_.back()->members) {
            if (other == name) {
                throw InputError(file_, line(),
                                 fmt::format("the key \"{}\" stands twice in one "
                                             "object; remove one of them",
                                             name));
            }
        }
        key_ = std::move(name);
        return true;
    }
    bool parse_error(std::size_t /*position*/, const std::string& token,
                     const nlohmann::json::exception& /*error*/) {
        throw InputError(file_, line(),
                         fmt::format("is not JSON here, at '{}'; look for a comma, a quote or a "
                                     "bracket that is missing or too many",
                                     excerpt(token)));
    }

    JsonValue take() { return std::move(root_); }

    const char* reached;

  private:
    /// The line of the last character read that is not blank: the parser reads one ahead of a
    /// number.
    std::size_t line() {
        const char* end = reached;
        while (end > counted_ &&
               (end[-1] == '\n' || end[-1] == '\r' || end[-1] == ' ' || end[-1] == '\t')) {
            --end;
        }
        line_ += static_cast<std::size_t>(std::count(counted_, end, '\n'));
        counted_ = end;
        return line_;
    }
    static JsonValue make(JsonValue::Kind kind) {
        JsonValue value;
        value.kind = kind;
        return value;
    }
    bool add_number(double value) {
        JsonValue v = make(JsonValue::Kind::number);
        v.number = value;
        return add(std::move(v));
    }
    JsonValue& place(JsonValue value) {
        value.line = line();
        if (open_.empty()) return root_ = std::move(value);
        JsonValue& parent = *open_.back();
        if (parent.kind == JsonValue::Kind::list)
            return parent.items.emplace_back(std::move(value));
        return parent.members.emplace_back(std::move(key_), std::move(value)).second;
    }
    bool add(JsonValue value) {
        place(std::move(value));
        return true;
    }
    bool open(JsonValue::Kind kind) {
        if (open_.size() == kDeepest) {
            throw InputError(file_, line(),
                             fmt::format("has more than {} brackets in one another", kDeepest));
        }
        // A parent's vector does not grow while its child is open, so the address holds.
        open_.push_back(&place(make(kind)));
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    const std::filesystem::path& file_;
    const char* counted_;
    std::size_t line_ = 1;
    JsonValue root_;
    std::vector<JsonValue*> open_;
    std::string key_;
};

std::string_view name_of(JsonValue::Kind kind) {
    switch (kind) {
        case JsonValue::Kind::null: return "null";
        case JsonValue::Kind::boolean: return "true or false";
        case JsonValue::Kind::number: return "a number";
        case JsonValue::Kind::text: return "a text";
        case JsonValue::Kind::list: return "a list";
        case JsonValue::Kind::object: return "an object";
    }
    return {};
}

}  // namespace

JsonValue read_json(const std::filesystem::path& file) {
    const std::string text = read_text(file, kLargestScene);
    Builder builder(file, text);
    const char** reached = &builder.reached;
    nlohmann::json::sax_parse(WatchedIterator(text.data(), reached),
                              WatchedIterator(text.data() + text.size(), reached), &builder);
    return builder.take();
}

void JsonNode::fail(std::string_view problem) const {
    throw InputError(*file_, value_->line,
                     path_.empty() ? std::string(problem) : fmt::format("{}: {}", path_, problem));
}

bool JsonNode::boolean() const {
    if (value_->kind != JsonValue::Kind::boolean) {
        fail(fmt::format("is {}; expected true or false", name_of(value_->kind)));
    }
    return value_->boolean;
}

double JsonNode::number(double least, double most) const {
    if (value_->kind != JsonValue::Kind::number) {
        fail(fmt::format("is {}; expected a number", name_of(value_->kind)));
    }
    if (!(value_->number >= least && value_->number <= most)) {
        fail(fmt::format("is {}; expected a number from {} to {}", value_->number, least, most));
    }
    return value_->number;
}

double JsonNode::positive() const {
    const double value = number(-kLargestCoordinate, kLargestCoordinate);
    if (!(value > 0.0)) fail(fmt::format("is {}; expected a number above 0", value));
    return value;
}

std::string JsonNode::text() const {
    if (value_->kind != JsonValue::Kind::text || value_->text.empty()) {
        fail(fmt::format("is {}; expected a text in quotes",
                         value_->kind == JsonValue::Kind::text ? "empty" : name_of(value_->kind)));
    }
    return value_->text;
}

Vec3d JsonNode::vector() const {
    const auto parts = items(3);
    const auto part = [&](std::size_t k) {
        return parts[k].number(-kLargestCoordinate, kLargestCoordinate);
    };
    return {part(0), part(1), part(2)};
}

Vec3d JsonNode::positive_vector() const {
    const auto parts = items(3);
    return {parts[0].positive(), parts[1].positive(), parts[2].positive()};
}

std::string JsonNode::as_words() const {
    switch (value_->kind) {
        case JsonValue::Kind::boolean: return value_->boolean ? "true" : "false";
        case JsonValue::Kind::number: return fmt::format("{}", value_->number);
        case JsonValue::Kind::text: return value_->text;
        case JsonValue::Kind::list: {
            std::string words;
            for (const JsonNode& item : items()) {
                if (!words.empty()) words += ',';
                words += item.as_words();
            }
            return words;
        }
        default:
            fail(fmt::format("is {}; expected a text, a number or a list", name_of(value_->kind)));
    }
}

std::vector<JsonNode> JsonNode::items() const {
    if (!is_list()) fail(fmt::format("is {}; expected a list", name_of(value_->kind)));
    std::vector<JsonNode> nodes;
    nodes.reserve(value_->items.size());
    for (std::size_t k = 0; k < value_->items.size(); ++k) {
        nodes.emplace_back(*file_, value_->items[k], fmt::format("{}[{}]", path_, k));
    }
    return nodes;
}

std::vector<JsonNode> JsonNode::items(std::size_t count) const {
    if (!is_list()) {
        fail(fmt::format("is {}; expected a list of {}", name_of(value_->kind), count));
    }
    if (value_->items.size() != count) {
        fail(fmt::format("has {} entries; expected {}", value_->items.size(), count));
    }
    return items();
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
    if (!is_object()) fail(fmt::format("is {}; expected an object", name_of(value_->kind)));
    std::vector<std::pair<std::string, JsonNode>> nodes;
    for (const auto& [key, value] : value_->members) nodes.emplace_back(key, child(key, value));
    return nodes;
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
    if (!is_object()) fail(fmt::format("is {}; expected an object", name_of(value_->kind)));
    for (const auto& [name, value] : value_->members) {
        if (name == key) return child(name, value);
    }
    return std::nullopt;
}

JsonNode JsonNode::at(std::string_view key) const {
    if (const auto found = find(key)) return *found;
    fail(fmt::format("the key \"{}\" is missing", key));
}

void JsonNode::allow_only(const std::vector<std::string_view>& keys) const {
    for (const auto& [key, node] : members()) {
        if (std::ranges::find(keys, key) != keys.end()) continue;
        const std::string_view guess = closest(key, keys);
        node.fail(guess.empty()
                      ? "there is no such key here"
                      : fmt::format("there is no such key here; did you mean \"{}\"?", guess));
    }
}

JsonNode JsonNode::child(const std::string& key, const JsonValue& value) const {
    return {*file_, value, path_.empty() ? key : path_ + "." + key};
}

}  // namespace ink

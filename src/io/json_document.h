#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace ink {

/// A JSON value that knows its line, for messages.
struct JsonValue {
    // Where they are defined, `members` is complete; clang insists.
    JsonValue();
    JsonValue(const JsonValue& other);
    JsonValue(JsonValue&& other) noexcept;
    JsonValue& operator=(const JsonValue& other);
    JsonValue& operator=(JsonValue&& other) noexcept;
    ~JsonValue();

    enum class Kind { null, boolean, number, text, list, object };
    Kind kind = Kind::null;
    std::size_t line = 1;
    bool boolean = false;
    double number = 0.0;
    std::string text;
    std::vector<JsonValue> items;                            ///< of a list
    std::vector<std::pair<std::string, JsonValue>> members;  ///< of an object, in order
};

/// A JSON file. Throws InputError, with line, for what is not JSON, for a key that stands twice in
/// one object and for more than 32 levels.
JsonValue read_json(const std::filesystem::path& file);

/// One value of a JSON file and the way to it ("objects[2].radius"). Every reader of a value throws
/// InputError, with line and path, where the value is not of its kind or out of its range. The file
/// and the value must outlive it.
class JsonNode {
  public:
    JsonNode(const std::filesystem::path& file, const JsonValue& value, std::string path = {})
        : file_(&file), value_(&value), path_(std::move(path)) {}

    [[noreturn]] void fail(std::string_view problem) const;
    const std::filesystem::path& file() const { return *file_; }
    const std::string& path() const { return path_; }
    std::size_t line() const { return value_->line; }
    bool is_list() const { return value_->kind == JsonValue::Kind::list; }
    bool is_object() const { return value_->kind == JsonValue::Kind::object; }

    bool boolean() const;
    double number(double least, double most) const;
    double positive() const;   ///< > 0
    std::string text() const;  ///< not empty
    Vec3d vector() const;      ///< [x, y, z]
    Vec3d positive_vector() const;
    /// Scalars as the command line would have them: 2 is "2", true "true", [0, 1, 2] "0,1,2".
    std::string as_words() const;

    std::vector<JsonNode> items() const;
    std::vector<JsonNode> items(std::size_t count) const;  ///< exactly so many
    /// Members of an object, each with its key.
    std::vector<std::pair<std::string, JsonNode>> members() const;
    /// The member of that key, which must be there.
    JsonNode at(std::string_view key) const;
    std::optional<JsonNode> find(std::string_view key) const;
    /// Fails at a key that is not among these, with the closest one that is.
    void allow_only(const std::vector<std::string_view>& keys) const;

  private:
    JsonNode child(const std::string& key, const JsonValue& value) const;

    const std::filesystem::path* file_;
    const JsonValue* value_;
    std::string path_;
};

}  // namespace ink

#include "session/command_line.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/text.h"
#include "inktrace/error.h"

namespace inktrace::viewer {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

bool is_scene(const fs::path& file) {
    const std::string name = ink::to_lower(file.filename().string());
    return name.ends_with(".json") || name.ends_with(".json.gz");
}

bool is_of_run(const SettingInfo& info) { return info.topic == "Run"; }

/// File names in a scene are relative to it; these become so that they can be found from anywhere.
void make_absolute(Json& object, const fs::path& scene) {
    if (!object.is_object() || object.value("type", "") != "input") return;
    const fs::path file = object.value("file", "");
    if (file.is_relative()) object["file"] = fs::absolute(scene.parent_path() / file).string();
}

void add_scene(const fs::path& file, Json& document) {
    std::ifstream in(file);
    Json scene = Json::parse(in, nullptr, false);
    if (scene.is_discarded() || !scene.is_object()) {
        throw Error(Error::Kind::input,
                    fmt::format("{}: its objects cannot be copied into another scene; it has to be "
                                "plain JSON",
                                file.string()));
    }
    for (Json& object : scene["objects"]) {
        make_absolute(object, file);
        document["objects"].push_back(object);
    }
    if (scene.contains("materials")) document["materials"].update(scene["materials"]);
}

}  // namespace

std::string shell_quoted(std::string_view word) {
    constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./:,=+%@";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) {
        return std::string(word);
    }
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string command_line(const std::vector<fs::path>& files, const fs::path& output,
                         const Settings& settings, const Settings& base) {
    std::string line = "inktrace render";
    for (const fs::path& file : files) {
        // A name that starts with a dash would be a flag.
        const std::string name = file.string();
        line += " " + shell_quoted(name.starts_with('-') ? "./" + name : name);
    }
    line += " -o " + shell_quoted(output.string());
    for (const SettingInfo& info : all_settings()) {
        if (is_of_run(info)) continue;
        const std::string value = settings.get(info.name);
        if (value == base.get(info.name)) continue;
        // What the base has of a list goes first: an empty value clears it.
        const bool clears = info.repeatable && !base.get(info.name).empty();
        if (clears || value.empty()) line += " --" + info.name + " ''";
        // With =, since a value may begin with a dash.
        if (!value.empty()) line += " --" + info.name + "=" + shell_quoted(value);
    }
    return line;
}

void save_scene(const fs::path& output, const std::vector<fs::path>& files,
                const Settings& settings) {
    Json document{{"inktrace", 1}, {"settings", Json::object()}, {"objects", Json::array()}};
    for (const auto& [name, value] : settings.changed()) {
        if (name != "threads" && name != "tile") document["settings"][name] = value;
    }
    for (const fs::path& file : files) {
        if (is_scene(file)) {
            add_scene(file, document);
        } else {
            document["objects"].push_back(
                {{"type", "input"}, {"file", fs::absolute(file).string()}});
        }
    }
    const fs::path draft = output.string() + ".part";
    std::ofstream out(draft);
    out << document.dump(2) << '\n';
    out.close();
    std::error_code failure;
    if (out) fs::rename(draft, output, failure);
    if (!out || failure) {
        std::error_code ignored;
        fs::remove(draft, ignored);
        throw Error(Error::Kind::input,
                    fmt::format("{}: cannot be written; check that the folder exists, may be "
                                "written and has space",
                                output.string()));
    }
}

}  // namespace inktrace::viewer

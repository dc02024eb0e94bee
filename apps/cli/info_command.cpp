#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "inktrace/inktrace.h"
#include "settings_flags.h"

namespace inktrace::cli {

namespace {

struct InfoArguments {
    std::vector<std::string> inputs;
    bool json = false;
    Settings settings;
};

bool has_numbers(const FieldInfo& field) { return field.least <= field.most; }

nlohmann::ordered_json to_json(const FileInfo& info) {
    nlohmann::ordered_json counts = nlohmann::ordered_json::object();
    for (const auto& [what, count] : info.counts) counts[what] = count;
    nlohmann::ordered_json names = nlohmann::ordered_json::object();
    for (const auto& [what, all] : info.names) names[what] = all;
    auto fields = nlohmann::ordered_json::array();
    for (const FieldInfo& field : info.fields) {
        nlohmann::ordered_json entry{{"name", field.name}, {"components", field.components}};
        // Of words there is neither.
        entry["least"] = has_numbers(field) ? nlohmann::ordered_json(field.least) : nullptr;
        entry["most"] = has_numbers(field) ? nlohmann::ordered_json(field.most) : nullptr;
        if (!field.words.empty()) entry["words"] = field.words;
        fields.push_back(std::move(entry));
    }
    return {{"file", info.path.string()},
            {"format", info.format},
            {"kind", info.kind},
            {"frames", info.frames},
            {"counts", counts},
            {"names", names},
            {"lower", info.lower},
            {"upper", info.upper},
            {"length_unit", info.length_unit},
            {"memory_bytes", info.memory_bytes},
            {"fields", fields},
            {"warnings", info.warnings}};
}

std::string print_bytes(std::uint64_t bytes) {
    const auto size = static_cast<double>(bytes);
    if (size < 1e6) return fmt::format("{:.0f} kB", std::max(size * 1e-3, 1.0));
    if (size < 1e9) return fmt::format("{:.0f} MB", size * 1e-6);
    return fmt::format("{:.1f} GB", size * 1e-9);
}

/// As many as a line holds.
std::string print_names(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 60;  // characters
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (k > 0 && text.size() + names[k].size() > kMost) {
            return text + fmt::format(" and {} more", names.size() - k);
        }
        text += (k > 0 ? " " : "") + (names[k].empty() ? "''" : names[k]);
    }
    return text;
}

/// "4: A B C D", of chains that are counted and named.
std::string print_count(const FileInfo& info, const std::string& what, std::uint64_t count) {
    const auto named =
        std::ranges::find(info.names, what, &decltype(info.names)::value_type::first);
    const std::string number = std::to_string(count);
    return named == info.names.end() ? number : number + ": " + print_names(named->second);
}

std::string print_values(const FieldInfo& field) {
    if (!field.words.empty()) return "words: " + print_names(field.words);
    if (!has_numbers(field)) return "no numbers";
    return fmt::format("{:.6g} to {:.6g}", field.least, field.most);
}

bool is_counted(const FileInfo& info, const std::string& what) {
    return std::ranges::any_of(info.counts, [&](const auto& count) { return count.first == what; });
}

void print_text(const FileInfo& info) {
    const auto line = [](std::string_view name, const std::string& value) {
        fmt::print("  {:<12}{}\n", name, value);
    };
    fmt::print("{}\n", info.path.string());
    line("format", fmt::format("{} ({})", info.format, info.kind));
    for (const auto& [what, count] : info.counts) line(what, print_count(info, what, count));
    for (const auto& [what, names] : info.names) {
        if (!is_counted(info, what)) line(what, print_names(names));
    }
    if (info.frames > 1) line("frames", std::to_string(info.frames));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        line(axis == 0 ? "bounds" : "",
             fmt::format("{}  {:.6g} to {:.6g}{}{}", "xyz"[axis], info.lower[axis],
                         info.upper[axis], info.length_unit.empty() ? "" : " ", info.length_unit));
    }
    line("memory", print_bytes(info.memory_bytes) + " to draw, beside the picture");
    for (const FieldInfo& field : info.fields) {
        const std::string width =
            field.components == 1 ? std::string() : fmt::format(" ({})", field.components);
        line("field", fmt::format("{}{}  {}", field.name, width, print_values(field)));
    }
    for (const std::string& warning : info.warnings) line("warning", warning);
}

void run(const InfoArguments& arguments) {
    auto list = nlohmann::ordered_json::array();
    for (const std::string& input : arguments.inputs) {
        const FileInfo info = inspect(input, arguments.settings);
        if (arguments.json) {
            list.push_back(to_json(info));
        } else {
            print_text(info);
        }
    }
    // Names of files need not be UTF-8.
    if (arguments.json) {
        fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }
}

}  // namespace

void add_info_command(CLI::App& app) {
    CLI::App* command = app.add_subcommand("info", "Tell what is in files");
    const auto arguments = std::make_shared<InfoArguments>();
    command->add_option("INPUT", arguments->inputs, "Files to look into")->required();
    command->add_flag("--json", arguments->json, "For machines");
    add_setting_flags(*command, arguments->settings, "Input");
    command->callback([arguments] { run(*arguments); });
}

}  // namespace inktrace::cli

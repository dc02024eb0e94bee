#include "window/file_list.h"

#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <system_error>
#include <tuple>

#include "base/text.h"

namespace inktrace::viewer {

namespace {

namespace fs = std::filesystem;

std::string in_lower_case(std::string text) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// Whether a reader would take a file of that name.
bool is_readable(const std::string& name) {
    std::string lower = in_lower_case(name);
    if (lower.ends_with(".gz")) lower.resize(lower.size() - 3);
    if (lower.ends_with(".json")) return true;
    return std::ranges::any_of(input_formats(), [&](const auto& format) {
        const auto extensions = ink::split(format.second, ' ');
        return std::ranges::any_of(extensions, [&](std::string_view extension) {
            return !extension.empty() && lower.ends_with(extension);
        });
    });
}

}  // namespace

void FileList::enter(const fs::path& folder) {
    std::error_code failure;
    folder_ = fs::weakly_canonical(folder, failure);
    if (failure || !fs::is_directory(folder_, failure)) folder_ = fs::current_path(failure);
    entries_.clear();
    for (auto entry = fs::directory_iterator(folder_, failure);
         !failure && entry != fs::directory_iterator(); entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        if (name.starts_with('.')) continue;
        std::error_code unknown;
        // An archive is a folder that is read as a file is.
        const bool is_folder = entry->is_directory(unknown) && !name.ends_with(".uda");
        if (is_folder || is_readable(name)) entries_.push_back({name, is_folder});
    }
    std::ranges::sort(entries_, {}, [](const Entry& entry) {
        return std::tuple{!entry.is_folder, in_lower_case(entry.name), entry.name};
    });
}

bool FileList::draw(Interface& interface, std::string& file) {
    std::optional<fs::path> entered;
    bool chosen = false;
    ImGui::TextDisabled("%s", folder_.c_str());
    ImGui::BeginChild("##files", {0, interface.px(300)}, true);
    if (folder_.has_relative_path() && ImGui::Selectable("../")) entered = folder_.parent_path();
    for (const Entry& entry : entries_) {
        const fs::path path = folder_ / entry.name;
        if (entry.is_folder) {
            if (ImGui::Selectable((entry.name + "/").c_str())) entered = path;
        } else if (ImGui::Selectable(entry.name.c_str(), path == file,
                                     ImGuiSelectableFlags_AllowDoubleClick)) {
            file = path.string();
            chosen = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
        }
    }
    if (entries_.empty()) ImGui::TextDisabled("No file here that can be drawn");
    if (entered) ImGui::SetScrollY(0.0F);
    ImGui::EndChild();
    if (entered) enter(*entered);
    return chosen;
}

}  // namespace inktrace::viewer

#include "window/dialogs.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include "window/file_list.h"
#include "window/setting_row.h"
#include "window/shortcuts.h"

namespace inktrace::viewer {

namespace {

/// A dialog in the middle of the window; false while it is closed. Ends with ImGui::EndPopup.
bool begin_dialog(Interface& interface, const char* title, bool& asked, float width) {
    if (asked) {
        asked = false;
        ImGui::OpenPopup(title);
    }
    const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
    ImGui::SetNextWindowPos(middle, ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowSize({interface.px(width), 0});
    return ImGui::BeginPopupModal(title, nullptr,
                                  ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove);
}

bool wants_out() { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)); }

void label(Interface& interface, const char* text) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(text);
    ImGui::SameLine(interface.px(90));
    ImGui::SetNextItemWidth(-1.0F);
}

void draw_open(Interface& interface) {
    static FileList list;
    const bool opening = interface.open_dialog;
    if (!begin_dialog(interface, "Open", interface.open_dialog, 520)) return;
    std::string& file = interface.drafts["open file"];
    if (opening) {
        file.clear();
        const auto& files = interface.session.files();
        const bool first = list.folder().empty() && !files.empty();
        list.enter(first ? files.front().parent_path() : list.folder());
        ImGui::SetKeyboardFocusHere();
    }
    label(interface, "File");
    const bool entered = ImGui::InputText("##file", &file, ImGuiInputTextFlags_EnterReturnsTrue);
    const bool chosen = list.draw(interface, file);
    ImGui::TextDisabled("Files can also be dropped on the window: several make one picture.");
    bool open = ImGui::Button("Open", {interface.px(90), 0}) || entered || chosen;
    ImGui::SameLine();
    const bool close = ImGui::Button("Close", {interface.px(90), 0}) || wants_out();
    std::error_code failure;
    if (open && !file.ends_with(".uda") && std::filesystem::is_directory(file, failure)) {
        list.enter(file);
        file.clear();
        open = false;
    }
    if (open && !file.empty()) {
        interface.picked.reset();
        interface.attempt([&] { interface.session.open({file}); });
    }
    if (open || close) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

struct ExportChoice {
    std::string file = "picture.png";
    int width = 0, height = 0;  ///< 0: those of the window
    bool keep_shape = true;
    bool scale_lines = true;
};

void export_size(Interface& interface, ExportChoice& choice) {
    const ink::Size now = interface.session.size();
    const double aspect = static_cast<double>(now.width) / now.height;
    constexpr int kMost = 65500;
    label(interface, "Width");
    if (ImGui::InputInt("##width", &choice.width, 100, 1000)) {
        choice.width = std::clamp(choice.width, 1, kMost);
        if (choice.keep_shape) {
            choice.height = std::clamp(static_cast<int>(choice.width / aspect + 0.5), 1, kMost);
        }
    }
    label(interface, "Height");
    if (ImGui::InputInt("##height", &choice.height, 100, 1000)) {
        choice.height = std::clamp(choice.height, 1, kMost);
        if (choice.keep_shape) {
            choice.width = std::clamp(static_cast<int>(choice.height * aspect + 0.5), 1, kMost);
        }
    }
    ImGui::Dummy({});
    ImGui::SameLine(interface.px(90));
    ImGui::Checkbox("Keep the shape of the window", &choice.keep_shape);
    ImGui::Dummy({});
    ImGui::SameLine(interface.px(90));
    ImGui::Checkbox("Lines grow with the picture", &choice.scale_lines);
}

/// Where a file would be written, and whether one is there.
void describe_place(const std::string& file) {
    std::error_code failure;
    const std::filesystem::path folder = std::filesystem::absolute(file, failure).parent_path();
    const bool exists = std::filesystem::exists(file, failure);
    ImGui::TextWrapped("%s %s", exists ? "Replaces the file that is there, in" : "In",
                       folder.c_str());
}

void draw_export(Interface& interface) {
    static ExportChoice choice;
    Session& session = interface.session;
    const bool opening = interface.export_dialog;
    if (!begin_dialog(interface, "Export", interface.export_dialog, 520)) return;
    if (opening) {
        choice.width = session.size().width;
        choice.height = session.size().height;
        ImGui::SetKeyboardFocusHere();
    }
    label(interface, "File");
    const bool entered =
        ImGui::InputText("##file", &choice.file, ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::TextDisabled(
        "%s", ".png .jpg .tiff .exr: pixels   .svg .svgz .pdf: curves   .json: scene file");
    describe_place(choice.file);
    export_size(interface, choice);
    const auto aov = std::ranges::find(all_settings(), "aov", &SettingInfo::name);
    if (aov != all_settings().end()) setting_row(interface, *aov, 90);
    ImGui::Spacing();
    const float width = interface.px(110);
    const ink::Size size{choice.width, choice.height};
    const bool write = ImGui::Button("Write", {width, 0}) || entered;
    ImGui::SameLine();
    if (ImGui::Button("Copy command", {interface.px(130), 0})) {
        const std::string command = session.export_command(choice.file, size, choice.scale_lines);
        interface.window.copy(command);
        session.say("Copied " + command);
    }
    ImGui::SameLine();
    const bool close = ImGui::Button("Close", {width, 0}) || wants_out();
    if (write && !choice.file.empty()) {
        interface.attempt([&] {
            if (choice.file.ends_with(".json")) {
                session.save_scene(choice.file);
            } else if (!session.export_picture(choice.file, size, choice.scale_lines)) {
                session.say("Another picture is being written; wait for it", true);
            }
        });
    }
    if (write || close) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

ImVec4 key_color() { return ImGui::GetStyleColorVec4(ImGuiCol_CheckMark); }

void draw_help(Interface& interface) {
    if (!begin_dialog(interface, "Mouse and keyboard", interface.help, 640)) return;
    const auto row = [&](const char* keys, const char* what) {
        ImGui::TextColored(key_color(), "%s", keys);
        ImGui::SameLine(interface.px(150));
        ImGui::TextUnformatted(what);
    };
    for (const MouseHelp& line : mouse_help()) row(line.keys, line.what);
    ImGui::Separator();
    if (ImGui::BeginTable("##keys", 4, ImGuiTableFlags_SizingFixedFit)) {
        for (const float width : {95.0F, 210.0F, 80.0F, 210.0F}) {
            ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, interface.px(width));
        }
        for (const Shortcut& shortcut : shortcuts()) {
            if (shortcut.what == nullptr) continue;
            ImGui::TableNextColumn();
            ImGui::TextColored(key_color(), "%s", shortcut.shown_as);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(shortcut.what);
        }
        ImGui::EndTable();
    }
    ImGui::Spacing();
    if (ImGui::Button("Close", {interface.px(110), 0}) || wants_out()) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace

void draw_dialogs(Interface& interface) {
    draw_open(interface);
    draw_export(interface);
    draw_help(interface);
}

void copy_command(Interface& interface) {
    const std::string command = interface.session.command_line();
    interface.window.copy(command);
    std::printf("%s\n", command.c_str());
    std::fflush(stdout);
    interface.session.say("Copied " + command);
}

}  // namespace inktrace::viewer

#include "window/panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "session/line_rules.h"
#include "window/setting_row.h"

namespace inktrace::viewer {

namespace {

void buttons(Interface& interface) {
    Session& session = interface.session;
    const float width =
        (ImGui::GetContentRegionAvail().x - 2.0F * ImGui::GetStyle().ItemSpacing.x) / 3.0F;
    const auto button = [&](const char* label, bool enabled, const char* tip) {
        ImGui::BeginDisabled(!enabled);
        const bool pressed = ImGui::Button(label, {width, 0});
        ImGui::EndDisabled();
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
        return pressed;
    };
    if (button("Undo", session.can_undo(), "Ctrl+Z")) session.undo();
    ImGui::SameLine();
    if (button("Redo", session.can_redo(), "Ctrl+Y")) session.redo();
    ImGui::SameLine();
    if (button("Reset", true, "All settings but the view as they were at the start")) {
        session.reset();
    }
    if (button("Open...", true, "Ctrl+O, or drop files on the window")) {
        interface.open_dialog = true;
    }
    ImGui::SameLine();
    if (button("Export...", session.has_scene(), "Ctrl+E: picture, curves, scene")) {
        interface.export_dialog = true;
    }
    ImGui::SameLine();
    if (button("Help", true, "?: mouse and keyboard")) interface.help = true;
}

/// "1 residue", "46 residues".
std::string counted(std::size_t count, const std::string& things) {
    std::string name = things;
    if (count == 1 && name.ends_with("ies")) {
        name.replace(name.size() - 3, 3, "y");
    } else if (count == 1 && name.ends_with("s")) {
        name.pop_back();
    }
    return fmt::format("{} {}", count, name);
}

void describe_files(Interface& interface) {
    for (const FileInfo& info : interface.session.infos()) {
        std::string text = fmt::format("{}: {}", info.path.filename().string(), info.format);
        for (const auto& [name, count] : info.counts) text += ", " + counted(count, name);
        ImGui::TextWrapped("%s", text.c_str());
    }
    if (interface.session.infos().empty()) ImGui::TextDisabled("No file");
}

using Facts = std::vector<std::pair<std::string, std::string>>;

Facts facts_of(const Hit& hit) {
    Facts facts{{hit.kind, fmt::format("{} of {}", hit.primitive + 1, hit.object)}};
    facts.insert(facts.end(), hit.facts.begin(), hit.facts.end());
    facts.emplace_back("position", fmt::format("{:.5g}, {:.5g}, {:.5g}", hit.position[0],
                                               hit.position[1], hit.position[2]));
    return facts;
}

/// Of the facts about what is picked, with their title and buttons; no more than a share of the
/// panel, where they scroll.
float height_of(const Interface& interface, const Facts& facts, float panel) {
    constexpr float kMost = 0.45F;
    const float spacing = ImGui::GetStyle().ItemSpacing.y;
    const float wrap = ImGui::GetContentRegionAvail().x - interface.px(kValuePoints);
    float height = 3 * spacing + ImGui::GetTextLineHeightWithSpacing() + ImGui::GetFrameHeight();
    for (const auto& [name, value] : facts) {
        height += ImGui::CalcTextSize(value.c_str(), nullptr, false, wrap).y + spacing;
    }
    return std::min(height, kMost * panel);
}

/// At the foot of the panel, so that a click moves nothing above it.
void describe_picked(Interface& interface, const Facts& facts, float height) {
    ImGui::BeginChild("##picked", {0, height}, false);
    ImGui::Separator();
    ImGui::TextUnformatted("Picked");
    const float rest = ImGui::GetContentRegionAvail().y - ImGui::GetFrameHeightWithSpacing();
    ImGui::BeginChild("##facts", {0, rest}, false);
    for (const auto& [name, value] : facts) {
        ImGui::TextDisabled("%s", name.c_str());
        ImGui::SameLine(interface.px(kValuePoints));
        ImGui::TextWrapped("%s", value.c_str());
    }
    ImGui::EndChild();
    if (ImGui::Button("Turn about it")) {
        const auto& c = interface.picked->center;
        interface.session.move_camera(interface.session.camera().focused({c[0], c[1], c[2]}));
    }
    ImGui::SameLine();
    if (ImGui::Button("Forget")) interface.picked.reset();
    ImGui::EndChild();
}

/// A type of line: on or off, its width and its colour.
void line_type_row(Interface& interface, const std::string& type, LineRules& rules,
                   std::set<std::string>& on, const ValueForm& types) {
    const Settings& settings = interface.session.settings();
    ImGui::PushID(type.c_str());
    bool drawn = on.contains(type);
    if (ImGui::Checkbox(type.c_str(), &drawn)) {
        if (drawn) {
            on.insert(type);
        } else {
            on.erase(type);
        }
        std::string list;
        for (const std::string& word : types.words) {
            if (on.contains(word)) list += (list.empty() ? "" : ",") + word;
        }
        interface.set("lines", list.empty() ? "none" : list);
    }
    if (drawn) {
        const float reset = ImGui::GetFrameHeight();
        const float color = ImGui::GetFrameHeight();
        ImGui::SameLine(interface.px(kValuePoints));
        std::string width = rules.get(type, "width").value_or(settings.get("line-width"));
        const float slider = ImGui::GetContentRegionAvail().x - reset - color - 2 * interface.px(6);
        if (length_slider("##width", width, 0.25, 20.0, slider)) {
            rules.set(type, "width", width);
            interface.set("line", rules.text());
        }
        ImGui::SameLine();
        std::string line_color = rules.get(type, "color").value_or(settings.get("line-color"));
        if (color_button("##color", line_color)) {
            rules.set(type, "color", line_color);
            interface.set("line", rules.text());
        }
        if (rules.has(type)) {
            ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - reset);
            if (ImGui::Button("x", {reset, 0})) {
                rules.clear(type);
                interface.set("line", rules.text());
            }
            if (ImGui::IsItemHovered()) ImGui::SetTooltip("As all other lines");
        }
    }
    ImGui::PopID();
}

void line_types(Interface& interface) {
    const auto& infos = all_settings();
    const auto info = std::ranges::find(infos, "lines", &SettingInfo::name);
    if (info == infos.end()) return;
    const std::string value = interface.session.settings().get("lines");
    std::set<std::string> on;
    if (value == "all") {
        on.insert(info->form.words.begin(), info->form.words.end());
    } else {
        for (const std::string_view word : ink::split(value, ',')) on.emplace(word);
    }
    LineRules rules(interface.session.settings().get("line"));
    for (const std::string& type : info->form.words) {
        line_type_row(interface, type, rules, on, info->form);
    }
    ImGui::Separator();
}

/// Settings that other parts of the window stand for: its size, the rows of line types, the dialog
/// for files, and the painter, which chooses tiles itself.
bool has_a_place_of_its_own(const std::string& name) {
    return name == "size" || name == "lines" || name == "aov" || name == "tile";
}

/// Whether a setting has a say in the picture, by what its help begins with.
bool counts(const Interface& interface, const SettingInfo& info) {
    const Settings& settings = interface.session.settings();
    const std::string other = settings.get("method") == "edges" ? "stencil" : "edges";
    if (info.help.starts_with("Method " + other + ":")) return false;
    if (info.name == "hidden-layers" && settings.get("hidden") == "none") return false;
    const std::string lines = settings.get("lines");
    const bool ridges = lines == "all" || lines.find("ridge") != std::string::npos;
    return ridges || !info.help.starts_with("Apparent ridges:");
}

/// Where the panel shows a setting: colours with the shading, whatever reads them.
std::string topic_of(const SettingInfo& info) {
    return info.name == "color-by" ? "Shading" : info.topic;
}

void topic(Interface& interface, const std::string& name) {
    const bool open = name == "Lines" || name == "Shading" || name == "Look";
    if (!ImGui::CollapsingHeader(name.c_str(), open ? ImGuiTreeNodeFlags_DefaultOpen : 0)) return;
    if (name == "Lines") line_types(interface);
    for (const SettingInfo& info : all_settings()) {
        if (topic_of(info) != name || has_a_place_of_its_own(info.name)) continue;
        if (counts(interface, info)) setting_row(interface, info);
    }
    ImGui::Spacing();
}

/// Lines first, then as in the help.
std::vector<std::string> topics() {
    std::vector<std::string> names{"Look", "Lines", "Shading"};
    for (const SettingInfo& info : all_settings()) {
        if (std::ranges::find(names, info.topic) == names.end()) names.push_back(info.topic);
    }
    return names;
}

}  // namespace

void draw_panel(Interface& interface, float left, float width, float height) {
    ImGui::SetNextWindowPos({left, 0});
    ImGui::SetNextWindowSize({width, height});
    ImGui::Begin("##panel", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
    buttons(interface);
    ImGui::Spacing();
    describe_files(interface);
    ImGui::Spacing();
    const Facts facts = interface.picked ? facts_of(*interface.picked) : Facts();
    const float foot = interface.picked ? height_of(interface, facts, height) : 0.0F;
    const float gap = interface.picked ? ImGui::GetStyle().ItemSpacing.y : 0.0F;
    const float sections = ImGui::GetContentRegionAvail().y - foot - gap;
    ImGui::BeginChild("##sections", {0, sections}, false,
                      ImGuiWindowFlags_AlwaysVerticalScrollbar |  // widths stay as sections open
                          ImGuiWindowFlags_NoNav);
    static const std::vector<std::string> kTopics = topics();
    for (const std::string& name : kTopics) topic(interface, name);
    ImGui::EndChild();
    if (interface.picked) describe_picked(interface, facts, foot);
    ImGui::End();
}

}  // namespace inktrace::viewer

#include "window/setting_row.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/color.h"
#include "base/text.h"

namespace inktrace::viewer {

namespace {

/// What an empty value stands for, where that is not a choice of the program.
const char* unset_text(const std::string& name) {
    static constexpr std::array<std::pair<std::string_view, const char*>, 10> kTexts{
        {{"select", "all atoms"},
         {"assembly", "as in the file"},
         {"clip", "nothing cut off"},
         {"orthographic", "perspective"},
         {"line", "no rules"},
         {"material", "as in the file"},
         {"light", "the look's"},
         {"color-range", "least to greatest"},
         {"eye", "by view"},
         {"look-at", "by view"}}};
    const auto* const found =
        std::ranges::find(kTexts, name, [](const auto& text) { return std::string(text.first); });
    return found == kTexts.end() ? "auto" : found->second;
}

/// The shortest text of what a slider says.
std::string number_text(float value) { return fmt::format("{:.4g}", value); }

void help_tooltip(const SettingInfo& info) {
    if (!ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 24.0F);
    ImGui::TextUnformatted(info.help.c_str());
    ImGui::TextDisabled("--%s %s", info.name.c_str(), info.value.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void choose_word(Interface& interface, const SettingInfo& info, const std::string& value) {
    if (!ImGui::BeginCombo("##value", value.empty() ? "auto" : value.c_str())) return;
    for (const std::string& word : info.form.words) {
        if (ImGui::Selectable(word.c_str(), word == value)) interface.set(info.name, word);
    }
    ImGui::EndCombo();
}

void choose_list(Interface& interface, const SettingInfo& info, const std::string& value) {
    if (!ImGui::BeginCombo("##value", value.c_str())) return;
    const auto parts = ink::split(value, ',');
    const auto is_on = [&](const std::string& word) {
        return value == "all" || std::ranges::find(parts, word) != parts.end();
    };
    for (const std::string& word : info.form.words) {
        bool on = is_on(word);
        if (!ImGui::Checkbox(word.c_str(), &on)) continue;
        std::string list;
        for (const std::string& other : info.form.words) {
            if (other == word ? on : is_on(other)) list += (list.empty() ? "" : ",") + other;
        }
        interface.set(info.name, list.empty() ? "none" : list);
    }
    ImGui::EndCombo();
}

void slide_number(Interface& interface, const SettingInfo& info, const std::string& value) {
    const auto least = static_cast<float>(info.form.least);
    const auto most = static_cast<float>(info.form.most);
    auto number = static_cast<float>(ink::parse_double(value).value_or(least));
    const bool logarithmic = least > 0.0F && most / least >= 50.0F;
    const ImGuiSliderFlags flags = logarithmic ? ImGuiSliderFlags_Logarithmic : 0;
    const char* const digits = most >= 100.0F ? "%.0f" : most >= 10.0F ? "%.1f" : "%.3g";
    const char* const format = value.empty() ? "auto" : digits;
    if (ImGui::SliderFloat("##value", &number, least, most, format, flags)) {
        interface.set(info.name, number_text(number));
    }
}

void slide_whole(Interface& interface, const SettingInfo& info, const std::string& value) {
    auto number = static_cast<int>(ink::parse_int(value).value_or(0));
    const bool all = info.name == "threads" && number == 0;
    const char* const format = value.empty() ? "auto" : all ? "all" : "%d";
    if (ImGui::SliderInt("##value", &number, static_cast<int>(info.form.least),
                         static_cast<int>(info.form.most), format)) {
        interface.set(info.name, std::to_string(number));
    }
}

void choose_color(Interface& interface, const SettingInfo& info, std::string value) {
    const bool can_be_transparent = info.name == "background";
    const bool transparent = value == "transparent";
    std::string color = transparent ? "white" : value;
    if (color_button("##value", color)) interface.set(info.name, color);
    if (!can_be_transparent) return;
    ImGui::SameLine();
    bool on = transparent;
    if (ImGui::Checkbox("transparent", &on)) interface.set(info.name, on ? "transparent" : "white");
}

/// Words that a text may be: those of the table, and the fields that the files have.
std::vector<std::string> suggestions(const Interface& interface, const SettingInfo& info) {
    std::vector<std::string> words = info.form.words;
    const bool fields =
        info.name == "color-by" || info.name == "radius" || info.name == "glyph-field";
    if (!fields) return words;
    for (const FileInfo& file : interface.session.infos()) {
        for (const FieldInfo& field : file.fields) {
            if (std::ranges::find(words, field.name) == words.end()) words.push_back(field.name);
        }
    }
    return words;
}

void type_text(Interface& interface, const SettingInfo& info, const std::string& value) {
    const std::vector<std::string> words = suggestions(interface, info);
    const float arrow = words.empty() ? 0.0F : ImGui::GetFrameHeight();
    std::string text = value;
    const auto draft = interface.drafts.find(info.name);
    if (draft != interface.drafts.end()) text = draft->second;
    ImGui::SetNextItemWidth(ImGui::CalcItemWidth() - arrow);
    const bool entered = ImGui::InputTextWithHint("##value", unset_text(info.name), &text,
                                                  ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemActive()) {
        interface.drafts[info.name] = text;
    } else {
        interface.drafts.erase(info.name);
    }
    if (entered || (ImGui::IsItemDeactivatedAfterEdit() && text != value)) {
        interface.set(info.name, text);
    }
    if (words.empty()) return;
    ImGui::SameLine(0.0F, 0.0F);
    if (!ImGui::BeginCombo("##words", nullptr,
                           ImGuiComboFlags_NoPreview | ImGuiComboFlags_PopupAlignLeft)) {
        return;
    }
    const bool can_be_auto = Settings().get(info.name).empty();
    if (can_be_auto && ImGui::Selectable(unset_text(info.name), value.empty())) {
        interface.set(info.name, "");
    }
    for (const std::string& word : words) {
        if (ImGui::Selectable(word.c_str(), word == value)) interface.set(info.name, word);
    }
    ImGui::EndCombo();
}

}  // namespace

bool color_button(const char* label, std::string& value) {
    const ink::Rgb8 color = ink::parse_color(value).value_or(ink::Rgb8{});
    std::array<float, 3> rgb{static_cast<float>(color.r) / 255.0F,
                             static_cast<float>(color.g) / 255.0F,
                             static_cast<float>(color.b) / 255.0F};
    if (!ImGui::ColorEdit3(label, rgb.data(),
                           ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel)) {
        return false;
    }
    const auto byte = [](float x) { return static_cast<std::uint8_t>(std::lround(x * 255.0F)); };
    value = ink::to_string(ink::Rgb8{byte(rgb[0]), byte(rgb[1]), byte(rgb[2])});
    return true;
}

bool length_slider(const char* label, std::string& value, double least_px, double most_px,
                   float width) {
    std::size_t digits = value.find_first_not_of("0123456789.+-e");
    if (digits == std::string::npos) digits = value.size();
    const std::string unit = digits < value.size() ? value.substr(digits) : "px";
    // About as many points and millimetres as pixels make at 300 dpi, and of a picture of 1000.
    const double per_px = unit == "pt" ? 0.24 : unit == "mm" ? 0.085 : unit == "%" ? 0.1 : 1.0;
    auto number = static_cast<float>(ink::parse_double(value.substr(0, digits)).value_or(1.0));
    const std::string format = "%.3g " + (unit == "%" ? std::string("%%") : unit);
    ImGui::SetNextItemWidth(width);
    if (!ImGui::SliderFloat(label, &number, static_cast<float>(least_px * per_px),
                            static_cast<float>(most_px * per_px), format.c_str(),
                            ImGuiSliderFlags_Logarithmic)) {
        return false;
    }
    value = number_text(number) + unit;
    return true;
}

void setting_row(Interface& interface, const SettingInfo& info, float value_points) {
    using Kind = ValueForm::Kind;
    const std::string value = interface.session.settings().get(info.name);
    const bool changed = value != interface.session.base_value(info.name);
    ImGui::PushID(info.name.c_str());
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(info.name.c_str());
    help_tooltip(info);
    ImGui::SameLine(interface.px(value_points));
    const float reset = ImGui::GetFrameHeight();
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x - reset - interface.px(4));
    const float left = ImGui::GetCursorPosX();
    switch (info.form.kind) {
        case Kind::word: choose_word(interface, info, value); break;
        case Kind::list: choose_list(interface, info, value); break;
        case Kind::whole: slide_whole(interface, info, value); break;
        case Kind::number: slide_number(interface, info, value); break;
        case Kind::color: choose_color(interface, info, value); break;
        case Kind::text: type_text(interface, info, value); break;
        case Kind::length: {
            std::string length = value;
            if (length_slider("##value", length, info.form.least, info.form.most,
                              ImGui::CalcItemWidth())) {
                interface.set(info.name, length);
            }
            break;
        }
    }
    ImGui::PopItemWidth();
    if (changed) {
        const float right = ImGui::GetWindowContentRegionMax().x - reset;
        ImGui::SameLine(std::max(right, left));
        if (ImGui::Button("x", {reset, 0})) {
            interface.set(info.name, interface.session.base_value(info.name));
        }
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("Back to where it was");
    }
    ImGui::PopID();
}

}  // namespace inktrace::viewer

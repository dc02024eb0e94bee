#include "window/bars.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <string>

namespace inktrace::viewer {

namespace {

constexpr ImGuiWindowFlags kBar = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                  ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                  ImGuiWindowFlags_NoFocusOnAppearing;

void begin_bar(Interface& interface, const char* name, float top, float width) {
    ImGui::SetNextWindowPos({0, top});
    ImGui::SetNextWindowSize({width, interface.px(kBarPoints)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {interface.px(8), interface.px(3)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    ImGui::Begin(name, nullptr, kBar);
    ImGui::AlignTextToFramePadding();
}

void end_bar() {
    ImGui::End();
    ImGui::PopStyleVar(2);
}

/// What is being worked at, or nothing.
std::string activity(const Session& session) {
    if (session.exporting()) {
        return fmt::format("writing {:.0f} %", 100.0 * session.export_progress());
    }
    if (session.looked_through() > 0.0) {
        return fmt::format("reading {:.0f} %", 100.0 * session.looked_through());
    }
    if (session.loading()) return "loading";
    const Painting& painting = session.painting();
    if (painting.picture && !painting.exact && session.refinement() > 0.0) {
        return fmt::format("refining {:.0f} %", 100.0 * session.refinement());
    }
    return {};
}

}  // namespace

void draw_status_bar(Interface& interface, float top, float width) {
    begin_bar(interface, "##status", top, width);
    const Session::Message& message = interface.session.message();
    const std::string doing = activity(interface.session);
    const float room = doing.empty() ? 0.0F : interface.px(110);
    ImGui::BeginChild("##text", {ImGui::GetContentRegionAvail().x - room, 0}, false, kBar);
    ImGui::AlignTextToFramePadding();
    std::string text = message.text;
    if (text.empty() && interface.under_pointer) text = describe(*interface.under_pointer);
    if (message.is_error) ImGui::PushStyleColor(ImGuiCol_Text, {0.72F, 0.08F, 0.08F, 1.0F});
    ImGui::TextUnformatted(text.c_str());
    const bool cut = ImGui::GetItemRectSize().x > ImGui::GetContentRegionAvail().x;
    if (message.is_error) ImGui::PopStyleColor();
    if (cut && ImGui::IsItemHovered()) {
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(ImGui::GetFontSize() * 40.0F);
        ImGui::TextUnformatted(text.c_str());
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
    ImGui::EndChild();
    if (!doing.empty()) {
        ImGui::SameLine();
        ImGui::AlignTextToFramePadding();
        ImGui::TextDisabled("%s", doing.c_str());
    }
    end_bar();
}

void draw_timeline(Interface& interface, float top, float width) {
    Session& session = interface.session;
    begin_bar(interface, "##timeline", top, width);
    if (ImGui::Button(session.playing() ? "Pause" : "Play", {interface.px(56), 0})) {
        session.play(!session.playing());
    }
    ImGui::SameLine();
    if (ImGui::Button("<")) session.set_frame(session.frame() - 1);
    ImGui::SameLine();
    if (ImGui::Button(">")) session.set_frame(session.frame() + 1);
    ImGui::SameLine();
    int frame = session.frame();
    ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - interface.px(130), 20.0F));
    const std::string format = fmt::format("frame %d (0 to {})", session.frames() - 1);
    if (ImGui::SliderInt("##frame", &frame, 0, session.frames() - 1, format.c_str())) {
        session.play(false);
        session.set_frame(frame);
    }
    ImGui::SameLine();
    auto rate = static_cast<float>(session.frames_per_second);
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::SliderFloat("##rate", &rate, 1.0F, 60.0F, "%.0f a second")) {
        session.frames_per_second = static_cast<double>(rate);
    }
    end_bar();
}

void draw_performance(Interface& interface) {
    const Painting& painting = interface.session.painting();
    if (!painting.picture) return;
    const RenderStats& stats = painting.picture->stats();
    ImGui::SetNextWindowPos({interface.px(10), interface.px(10)});
    ImGui::SetNextWindowBgAlpha(0.85F);
    ImGui::Begin("##performance", nullptr,
                 kBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs);
    const auto row = [&](const char* name, const std::string& value) {
        ImGui::TextDisabled("%s", name);
        ImGui::SameLine(interface.px(76));
        ImGui::TextUnformatted(value.c_str());
    };
    row("picture", fmt::format("{} x {}, {}", painting.picture->width(), painting.picture->height(),
                               painting.exact ? "in full" : "moving"));
    if (painting.scale < 1.0) {
        row("", fmt::format("a ray to {0:.2g} x {0:.2g} pixels", 1.0 / painting.scale));
    }
    std::string frame = fmt::format("{:.1f} ms", painting.frame_ms);
    if (!painting.exact) {
        frame += fmt::format(", {:.0f} a second", 1e3 / std::max(painting.frame_ms, 1e-3));
    }
    row("frame", frame);
    row("threads", fmt::format("{}", stats.threads));
    row("latency", fmt::format("{:.1f} ms", painting.latency_ms));
    row("rays",
        fmt::format("{:.2f} M, {:.1f} M/s", static_cast<double>(stats.rays) * 1e-6,
                    static_cast<double>(stats.rays) * 1e-3 / std::max(stats.render_ms, 1e-3)));
    row("trace", fmt::format("{:.1f} ms", stats.trace_ms));
    row("lines", fmt::format("{:.1f} ms", stats.lines_ms));
    row("shade", fmt::format("{:.1f} ms", stats.shade_ms));
    ImGui::End();
}

void draw_welcome(Interface& interface, float width, float height) {
    const auto write = [&](const char* text, float lines_down) {
        const ImVec2 size = ImGui::CalcTextSize(text);
        const float y = 0.5F * (height - size.y) + lines_down * ImGui::GetTextLineHeight();
        ImGui::GetBackgroundDrawList()->AddText({0.5F * (width - size.x), y},
                                                IM_COL32(90, 90, 90, 255), text);
    };
    if (interface.session.loading()) return write("Loading...", 0.0F);
    if (interface.session.has_scene()) return write("Drawing...", 0.0F);
    write("Drop a molecule, particles or a mesh here, or press Ctrl+O", -1.0F);
    write("? shows what mouse and keyboard do", 1.0F);
}

}  // namespace inktrace::viewer

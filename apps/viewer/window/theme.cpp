#include "window/theme.h"

#include <imgui.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace inktrace::viewer {

namespace {

constexpr std::array kFonts{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                            "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                            "/usr/share/fonts/TTF/DejaVuSans.ttf"};

void load_font(float size) {
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    for (const char* const file : kFonts) {
        std::error_code failure;
        if (!std::filesystem::exists(file, failure)) continue;
        if (fonts.AddFontFromFileTTF(file, size) != nullptr) return;
    }
    ImFontConfig config;  // the one that Dear ImGui carries
    config.SizePixels = size;
    fonts.AddFontDefault(&config);
}

}  // namespace

void set_theme(float scale) {
    constexpr float kTextSize = 14.0F;
    load_font(std::round(kTextSize * scale));
    ImGui::StyleColorsLight();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0.0F;
    style.WindowBorderSize = 0.0F;
    style.PopupRounding = 4.0F;
    style.FrameRounding = 3.0F;
    style.GrabRounding = 3.0F;
    style.FramePadding = {6, 3};
    style.ItemSpacing = {6, 5};
    style.WindowPadding = {10, 8};
    style.IndentSpacing = 10.0F;
    style.ScrollbarSize = 12.0F;
    style.GrabMinSize = 8.0F;
    const auto set = [&](ImGuiCol which, float r, float g, float b) {
        style.Colors[which] = {r, g, b, 1.0F};
    };
    set(ImGuiCol_WindowBg, 0.955F, 0.955F, 0.96F);
    set(ImGuiCol_PopupBg, 1.0F, 1.0F, 1.0F);
    set(ImGuiCol_FrameBg, 1.0F, 1.0F, 1.0F);
    set(ImGuiCol_Header, 0.87F, 0.89F, 0.93F);
    set(ImGuiCol_HeaderHovered, 0.80F, 0.85F, 0.93F);
    set(ImGuiCol_HeaderActive, 0.74F, 0.81F, 0.92F);
    set(ImGuiCol_Button, 0.86F, 0.88F, 0.91F);
    set(ImGuiCol_ButtonHovered, 0.76F, 0.83F, 0.93F);
    set(ImGuiCol_ButtonActive, 0.62F, 0.74F, 0.90F);
    style.Colors[ImGuiCol_SliderGrab] = {0.45F, 0.62F, 0.88F, 0.40F};  // over the number
    style.Colors[ImGuiCol_SliderGrabActive] = {0.30F, 0.50F, 0.82F, 0.55F};
    set(ImGuiCol_TextDisabled, 0.42F, 0.43F, 0.46F);
    style.Colors[ImGuiCol_ModalWindowDimBg] = {0.1F, 0.1F, 0.12F, 0.25F};
    set(ImGuiCol_CheckMark, 0.18F, 0.36F, 0.66F);
    style.Colors[ImGuiCol_Border] = {0.0F, 0.0F, 0.0F, 0.20F};
    style.FrameBorderSize = 1.0F;
    style.ScaleAllSizes(scale);
}

}  // namespace inktrace::viewer

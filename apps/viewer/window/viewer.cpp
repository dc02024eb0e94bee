#include "window/viewer.h"

#include <imgui.h>

#include <algorithm>

#include "window/bars.h"
#include "window/dialogs.h"
#include "window/panel.h"
#include "window/shortcuts.h"

namespace inktrace::viewer {

namespace {

constexpr ink::Size kWindow{1280, 960};

/// Of the user interface, after something has happened: Dear ImGui needs a second frame to lay out
/// what the first one opened.
constexpr int kFramesAfterInput = 3;

}  // namespace

Viewer::Viewer(const std::vector<std::filesystem::path>& files,
               const std::vector<std::pair<std::string, std::string>>& flags)
    : window_(kWindow, "Inktrace"),
      session_([] { Window::wake(); }),
      interface_{
          .session = session_, .window = window_, .under_pointer = {}, .picked = {}, .drafts = {}},
      hand_(interface_) {
    session_.resize(picture_size());
    if (!files.empty() || !flags.empty()) session_.open(files, flags);
}

/// What the panel and the bars leave of the window.
ink::Size Viewer::picture_size() const {
    ink::Size size = window_.size();
    if (interface_.panel) size.width -= static_cast<int>(interface_.px(kPanelPoints));
    const int bars = session_.frames() > 1 ? 2 : 1;
    size.height -= bars * static_cast<int>(interface_.px(kBarPoints));
    return {std::max(size.width, 1), std::max(size.height, 1)};
}

std::optional<Clock::time_point> Viewer::next_moment() const {
    if (frames_to_draw_ > 0) return Clock::now();
    auto moment = session_.next_update();
    for (const auto& other : {hand_.next_look(), next_frame_}) {
        if (other && (!moment || *other < *moment)) moment = other;
    }
    return moment;
}

void Viewer::run() {
    while (!window_.closed()) {
        window_.wait(next_moment());
        take_input();
        const bool news = session_.update();
        if (next_frame_ && Clock::now() >= *next_frame_) draw_frames(1);
        if (window_.take_activity()) draw_frames(kFramesAfterInput);
        if (hand_.look()) draw_frames(1);
        title();
        if (!window_.visible()) {
            frames_to_draw_ = 0;
            next_frame_.reset();
        } else if (frames_to_draw_ == 0 && news && shows_other_picture()) {
            draw_other_picture();
        } else {
            if (news) draw_frames(1);
            if (frames_to_draw_ == 0) continue;
            --frames_to_draw_;
            draw();
        }
    }
}

void Viewer::draw_frames(int count) { frames_to_draw_ = std::max(frames_to_draw_, count); }

/// Whether the picture can be exchanged and the rest of the window be left alone for a moment:
/// nothing lies over the picture.
bool Viewer::shows_other_picture() const {
    return session_.painting().picture && !session_.painting().exact && !interface_.performance &&
           session_.settings().get("background") != "transparent" && !window_.interface_is_open() &&
           picture_size() == session_.size() && frame_size_ == window_.size();
}

/// As long as a hand moves, the panel and the bars follow ten times a second: they take a software
/// renderer longer than the picture does.
void Viewer::draw_other_picture() {
    constexpr auto kPause = std::chrono::milliseconds(100);
    if (!next_frame_) next_frame_ = Clock::now() + kPause;
    window_.redraw(*session_.painting().picture, session_.picture_number(), session_.size());
}

void Viewer::take_input() {
    const ink::Size picture = session_.size();
    for (const Input& input : window_.take_input()) {
        if (input.kind == Input::Kind::key) {
            if (!window_.interface_has_keys() &&
                !ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) {
                press(interface_, input.key);
            }
        } else {
            hand_.take(input, picture);
        }
    }
    std::vector<std::filesystem::path> files = window_.take_drops();
    if (!files.empty()) {
        interface_.picked.reset();
        interface_.attempt([&] { session_.open(std::move(files)); });
    }
}

void Viewer::title() {
    std::string title = "Inktrace";
    if (!session_.files().empty()) {
        title = session_.files().front().filename().string();
        if (session_.files().size() > 1) title += " and others";
        title += " - Inktrace";
    }
    if (title == title_) return;
    title_ = title;
    window_.set_title(title);
}

void Viewer::draw_picture(ink::Size picture) {
    const Painting& painting = session_.painting();
    const auto width = static_cast<float>(picture.width);
    const auto height = static_cast<float>(picture.height);
    if (!painting.picture) return draw_welcome(interface_, width, height);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const bool transparent = session_.settings().get("background") == "transparent";
    const float cell = interface_.px(12);
    for (float y = 0; transparent && y < height; y += cell) {
        const bool odd = static_cast<int>(y / cell) % 2 != 0;
        for (float x = odd ? cell : 0; x < width; x += 2 * cell) {
            list.AddRectFilled({x, y}, {std::min(x + cell, width), std::min(y + cell, height)},
                               IM_COL32(225, 225, 225, 255));
        }
    }
    const Picture& pixels = *painting.picture;
    const bool same_size = pixels.width() == picture.width && pixels.height() == picture.height;
    void* const texture = window_.texture(pixels, session_.picture_number(), !same_size);
    // Mixing takes a software renderer long.
    if (!transparent) list.AddCallback(Window::cover, nullptr);
    list.AddImage(texture, {0, 0}, {width, height});
    if (!transparent) list.AddCallback(Window::mix, nullptr);
}

void Viewer::draw() {
    session_.resize(picture_size());
    const ink::Size picture = session_.size();
    const ink::Size whole = frame_size_ = window_.size();
    next_frame_.reset();
    const auto width = static_cast<float>(picture.width);
    window_.set_quiet_area({0, 0, width, static_cast<float>(picture.height)});
    window_.begin_frame();
    draw_picture(picture);
    auto top = static_cast<float>(picture.height);
    if (session_.frames() > 1) {
        draw_timeline(interface_, top, width);
        top += interface_.px(kBarPoints);
    }
    draw_status_bar(interface_, top, width);
    if (interface_.performance) draw_performance(interface_);
    if (interface_.panel) {
        draw_panel(interface_, width, static_cast<float>(whole.width) - width,
                   static_cast<float>(whole.height));
    }
    draw_dialogs(interface_);
    window_.end_frame(picture);
}

}  // namespace inktrace::viewer

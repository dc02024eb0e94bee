#include "window/shortcuts.h"

#include <algorithm>
#include <array>
#include <vector>

#include "window/dialogs.h"

namespace inktrace::viewer {

namespace {

using Action = std::function<void(Interface&)>;

/// A move of the camera, where there is a scene to see.
template <class Move>
Action camera(const Move& move) {
    return [move](Interface& interface) {
        Session& session = interface.session;
        if (session.has_scene()) session.move_camera(move(session.camera(), session.size()));
    };
}

Action turn(double right_deg, double down_deg) {
    return camera(
        [=](const CameraPose& pose, ink::Size) { return pose.turned(right_deg, down_deg); });
}
Action pan(double right, double down) {
    constexpr double kShare = 0.05;  // of the picture's height
    return camera([=](const CameraPose& pose, ink::Size size) {
        return pose.panned(right * kShare * size.height, down * kShare * size.height, size.height);
    });
}
Action zoom(double factor) {
    return camera(
        [=](const CameraPose& pose, ink::Size) { return pose.zoomed(factor, pose.look_at); });
}
Action roll(double degrees) {
    return camera([=](const CameraPose& pose, ink::Size) { return pose.rolled(degrees); });
}
Action view(const char* name) {
    return [name](Interface& interface) { interface.session.standard_view(name); };
}
Action step(int frames) {
    return [frames](Interface& interface) {
        interface.session.play(false);
        interface.session.set_frame(interface.session.frame() + frames);
    };
}

void switch_projection(Interface& interface) {
    Session& session = interface.session;
    if (!session.has_scene()) return;
    const CameraPose pose = session.camera();
    session.move_camera(pose.with_projection(!pose.orthographic()));
}

void next_composition(Interface& interface) {
    const std::string now = interface.session.settings().get("compose");
    interface.set("compose", now == "both" ? "lines" : now == "lines" ? "shaded" : "both");
}

void focus_picked(Interface& interface) {
    if (!interface.session.has_scene()) return;
    if (!interface.picked) return interface.session.frame_all();
    const auto& c = interface.picked->center;
    interface.session.move_camera(interface.session.camera().focused({c[0], c[1], c[2]}));
}

constexpr double kTurn = 10.0;

std::vector<Shortcut> make_shortcuts() {
    return {
        {"Left", "Arrows", "turn", turn(-kTurn, 0)},
        {"Right", "", nullptr, turn(kTurn, 0)},
        {"Up", "", nullptr, turn(0, -kTurn)},
        {"Down", "", nullptr, turn(0, kTurn)},
        {"Shift+Left", "Shift+arrows", "pan", pan(-1, 0)},
        {"Shift+Right", "", nullptr, pan(1, 0)},
        {"Shift+Up", "", nullptr, pan(0, -1)},
        {"Shift+Down", "", nullptr, pan(0, 1)},
        {"+", "+  -", "zoom", zoom(1 / 1.2)},
        {"=", "", nullptr, zoom(1 / 1.2)},
        {"-", "", nullptr, zoom(1.2)},
        {"[", "[  ]", "roll", roll(-kTurn)},
        {"]", "", nullptr, roll(kTurn)},
        {"1", "1", "view from the front", view("front")},
        {"2", "2", "from the back", view("back")},
        {"3", "3", "from the left", view("left")},
        {"4", "4", "from the right", view("right")},
        {"5", "5", "from the top", view("top")},
        {"6", "6", "from the bottom", view("bottom")},
        {"7", "7", "isometric", view("iso")},
        {"0", "0, r", "view as at the start", view("auto")},
        {"r", "", nullptr, view("auto")},
        {"Home", "Home, a", "all of it", [](Interface& i) { i.session.frame_all(); }},
        {"a", "", nullptr, [](Interface& i) { i.session.frame_all(); }},
        {"f", "f", "turn about what is picked, or all", focus_picked},
        {"o", "o", "perspective, orthographic", switch_projection},
        {"l", "l", "lines, shading, both", next_composition},
        {"Space", "Space", "play, pause",
         [](Interface& i) { i.session.play(!i.session.playing()); }},
        {",", ",  .", "frame back, on", step(-1)},
        {".", "", nullptr, step(1)},
        {"Ctrl+Z", "Ctrl+Z", "undo", [](Interface& i) { i.session.undo(); }},
        {"Ctrl+Y", "Ctrl+Y", "redo", [](Interface& i) { i.session.redo(); }},
        {"Ctrl+Shift+Z", "", nullptr, [](Interface& i) { i.session.redo(); }},
        {"Ctrl+O", "Ctrl+O", "open", [](Interface& i) { i.open_dialog = true; }},
        {"Ctrl+E", "Ctrl+E, S", "export",
         [](Interface& i) { i.export_dialog = i.session.has_scene(); }},
        {"Ctrl+S", "", nullptr, [](Interface& i) { i.export_dialog = i.session.has_scene(); }},
        {"Ctrl+C", "Ctrl+C", "copy the command line", copy_command},
        {"F5", "F5", "read the files again", [](Interface& i) { i.session.reload(); }},
        {"Tab", "Tab", "panel", [](Interface& i) { i.panel = !i.panel; }},
        {"p", "p", "performance", [](Interface& i) { i.performance = !i.performance; }},
        {"?", "?, F1", "this help", [](Interface& i) { i.help = true; }},
        {"F1", "", nullptr, [](Interface& i) { i.help = true; }},
        {"Ctrl+Q", "Ctrl+Q", "quit", [](Interface& i) { i.window.close(); }},
    };
}

}  // namespace

std::span<const Shortcut> shortcuts() {
    static const std::vector<Shortcut> kShortcuts = make_shortcuts();
    return kShortcuts;
}

std::span<const MouseHelp> mouse_help() {
    static constexpr std::array kHelp{
        MouseHelp{"left drag", "turn"},
        MouseHelp{"right drag", "pan; also middle drag, or Shift and left drag"},
        MouseHelp{"Ctrl + left drag", "roll"},
        MouseHelp{"wheel", "zoom to the pointer"},
        MouseHelp{"click", "pick: atom, residue, chain, triangle, fields"},
        MouseHelp{"double click", "pick and turn about it"}};
    return kHelp;
}

bool press(Interface& interface, const std::string& key) {
    const auto all = shortcuts();
    const auto found = std::ranges::find_if(all, [&](const Shortcut& s) { return key == s.key; });
    if (found == all.end()) return false;
    interface.attempt([&] { found->action(interface); });
    return true;
}

}  // namespace inktrace::viewer

#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "inktrace/render.h"

struct GLFWwindow;
struct ImDrawCmd;
struct ImDrawList;

namespace inktrace::viewer {

/// What a hand does, in the order in which it does it. Places are pixels of the window.
struct Input {
    enum class Kind { press, release, move, scroll, key };
    Kind kind = Kind::move;
    double x = 0.0, y = 0.0;  ///< of the pointer
    int button = 0;           ///< 0 left, 1 right, 2 middle
    double amount = 0.0;      ///< of scrolling, up is positive
    std::string key{};        ///< "a", "?", "Left", "Ctrl+Z"
    bool shift = false, ctrl = false;
};

/// A window with an OpenGL 2 context, which every X server and software renderer offers, and Dear
/// ImGui in it. There can be one at a time, on the program's main thread.
class Window {
  public:
    /// Throws Error (input) where there is no display to open it on.
    Window(ink::Size size, const std::string& title);
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;
    ~Window();

    bool closed() const;
    void close();
    void set_title(const std::string& title);
    /// False while it is minimised or has no area.
    bool visible() const;
    ink::Size size() const;                 ///< pixels
    float scale() const { return scale_; }  ///< of texts and buttons: 2 on a HiDPI screen

    /// Sleeps until something happens, or until a moment. Any thread may `wake` it.
    void wait(std::optional<std::chrono::steady_clock::time_point> until);
    static void wake();

    std::vector<Input> take_input();
    std::vector<std::filesystem::path> take_drops();
    /// Whether something has happened since the last call that the user interface has to show.
    bool take_activity();
    /// The pointer's moves inside a rectangle are no activity: left, top, right, bottom.
    void set_quiet_area(const std::array<float, 4>& area) { quiet_ = area; }
    /// Whether the user interface wants the pointer, wherever it is, or the keys for itself.
    bool interface_has_pointer() const;
    bool interface_has_keys() const;

    /// Whether a menu, a dialog or a hint may lie over the picture.
    bool interface_is_open() const;

    void begin_frame();
    /// `picture`: size of the picture, at the upper left corner.
    void end_frame(ink::Size picture);
    /// Another picture there, and about it what the last frame showed.
    void redraw(const Picture& picture, std::uint64_t number, ink::Size size);

    /// The picture as a texture of Dear ImGui; it is uploaded when `number` is another one.
    void* texture(const Picture& picture, std::uint64_t number, bool smooth);

    /// Callbacks of Dear ImGui: what is drawn next covers what is there, or is mixed with it, as
    /// usual.
    static void cover(const ImDrawList*, const ImDrawCmd*);
    static void mix(const ImDrawList*, const ImDrawCmd*);

    void copy(const std::string& text);

  private:
    struct Callbacks;
    void start_interface();
    void pass_on(int key, int scancode, int action, int mods);
    void release_late_keys();
    void keep_rest(ink::Size picture);

    struct Release {
        int key, scancode, mods;
    };
    GLFWwindow* window_ = nullptr;
    float scale_ = 1.0F;
    std::vector<Input> input_;
    std::vector<std::filesystem::path> drops_;
    bool activity_ = true;
    double pointer_x_ = 0.0, pointer_y_ = 0.0;  ///< as of the last event
    std::vector<int> pressed_;                  ///< keys, since the last frame
    std::vector<Release> late_releases_;        ///< of such keys
    std::array<float, 4> quiet_{};
    unsigned texture_ = 0;
    ink::Size texture_size_;
    std::uint64_t texture_number_ = 0;
    unsigned rest_ = 0;  ///< texture of the window about the picture, as of the last frame
    ink::Size rest_size_;
};

}  // namespace inktrace::viewer

#include "window/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl2.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <imgui.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>
#include <utility>

#include "inktrace/error.h"
#include "window/theme.h"

namespace inktrace::viewer {

namespace {

std::string last_error;

// ---- A display that goes away ----

using Unlock = void (*)(void* display);

std::atomic<bool> display_is_gone = false;
std::thread::id window_thread;  ///< the one that a lost display is thrown on
Unlock unlock_display = nullptr;

constexpr char kGone[] = "the display is gone";

/// Xlib calls this where the connection has broken, on whichever thread notices, and has locked the
/// display for that thread. The window's thread leaves by an exception; others just go on, and what
/// they ask of the display has no effect.
int on_broken_connection(void* display) {
    const bool first = !display_is_gone.exchange(true);
    unlock_display(display);
    if (std::this_thread::get_id() != window_thread) return 0;
    // While the stack unwinds for the first time, nothing may be thrown again.
    if (first || std::uncaught_exceptions() == 0) throw Error(Error::Kind::input, kGone);
    return 0;
}

/// Instead of ending the program.
void go_on(void* /*display*/, void* /*unused*/) {}

/// For an Xlib from before version 1.7, which ends the program in any case: without running the
/// destructors of what other threads still use.
int end_program(void* /*display*/) {
    std::fprintf(stderr, "inktrace view: %s\n", kGone);
    _exit(1);
}

template <class Function>
Function find_function(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

/// To be called once GLFW is there: where it talks to an X server it has loaded Xlib.
void watch_display() {
    using Handler = int (*)(void* display);
    using Exit = void (*)(void* display, void* data);
    const auto set_handler = find_function<Handler (*)(Handler)>("XSetIOErrorHandler");
    const auto set_exit = find_function<void (*)(void*, Exit, void*)>("XSetIOErrorExitHandler");
    const auto display_of_glfw = find_function<void* (*)()>("glfwGetX11Display");
    unlock_display = find_function<Unlock>("XUnlockDisplay");
    if (set_handler == nullptr) return;
    void* const display = display_of_glfw != nullptr ? display_of_glfw() : nullptr;
    if (set_exit == nullptr || unlock_display == nullptr || display == nullptr) {
        set_handler(end_program);
        return;
    }
    window_thread = std::this_thread::get_id();
    set_handler(on_broken_connection);
    set_exit(display, go_on, nullptr);
}

bool is_set(const char* variable) {
    const char* const value = std::getenv(variable);
    return value != nullptr && value[0] != '\0';
}

[[noreturn]] void refuse() {
    const bool any = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
    throw Error(Error::Kind::input,
                any ? fmt::format("no window can be opened ({}); check the display and its OpenGL, "
                                  "or write a picture with 'inktrace render'",
                                  last_error)
                    : "there is no display to open a window on (DISPLAY and WAYLAND_DISPLAY are "
                      "not set); log in with 'ssh -X', or write a picture with 'inktrace render'");
}

std::string key_name(int key, int scancode) {
    switch (key) {
        case GLFW_KEY_LEFT: return "Left";
        case GLFW_KEY_RIGHT: return "Right";
        case GLFW_KEY_UP: return "Up";
        case GLFW_KEY_DOWN: return "Down";
        case GLFW_KEY_HOME: return "Home";
        case GLFW_KEY_ESCAPE: return "Esc";
        case GLFW_KEY_TAB: return "Tab";
        case GLFW_KEY_F1: return "F1";
        case GLFW_KEY_F5: return "F5";
        case GLFW_KEY_F11: return "F11";
        default: break;
    }
    const char* const name = glfwGetKeyName(key, scancode);
    if (name == nullptr || name[0] == '\0' || name[1] != '\0') return {};
    const int upper = std::toupper(static_cast<unsigned char>(name[0]));
    return std::string(1, static_cast<char>(upper));  // in parentheses: braces make a list
}

}  // namespace

/// What GLFW calls. Dear ImGui passes on what it is told.
struct Window::Callbacks {
    static Window& of(GLFWwindow* window) {
        return *static_cast<Window*>(glfwGetWindowUserPointer(window));
    }
    static Input at_pointer(GLFWwindow* window, Input::Kind kind) {
        Input input{kind};
        // Where it was at this event: by now the pointer may be elsewhere.
        input.x = of(window).pointer_x_;
        input.y = of(window).pointer_y_;
        const auto down = [&](int key) { return glfwGetKey(window, key) == GLFW_PRESS; };
        input.shift = down(GLFW_KEY_LEFT_SHIFT) || down(GLFW_KEY_RIGHT_SHIFT);
        input.ctrl = down(GLFW_KEY_LEFT_CONTROL) || down(GLFW_KEY_RIGHT_CONTROL);
        return input;
    }
    static void add(GLFWwindow* window, Input input) {
        of(window).activity_ = true;
        of(window).input_.push_back(std::move(input));
    }

    static void button(GLFWwindow* window, int button, int action, int mods) {
        ImGui_ImplGlfw_MouseButtonCallback(window, button, action, mods);
        const bool down = action == GLFW_PRESS;
        Input input = at_pointer(window, down ? Input::Kind::press : Input::Kind::release);
        input.button = button;
        add(window, input);
    }
    static void move(GLFWwindow* window, double x, double y) {
        Window& self = of(window);
        self.pointer_x_ = x;
        self.pointer_y_ = y;
        const auto [left, top, right, bottom] = self.quiet_;
        const bool quiet = x >= left && x < right && y >= top && y < bottom;
        self.activity_ |= !quiet;
        self.input_.push_back(at_pointer(window, Input::Kind::move));
    }
    static void scroll(GLFWwindow* window, double x, double y) {
        ImGui_ImplGlfw_ScrollCallback(window, x, y);
        Input input = at_pointer(window, Input::Kind::scroll);
        input.amount = y;
        add(window, input);
    }
    static void key(GLFWwindow* window, int key, int scancode, int action, int mods) {
        of(window).activity_ = true;
        of(window).pass_on(key, scancode, action, mods);
        if (action == GLFW_RELEASE) return;
        const std::string name = key_name(key, scancode);
        const bool ctrl = (mods & (GLFW_MOD_CONTROL | GLFW_MOD_SUPER)) != 0;
        // What types a character comes as a character, whatever the keyboard's layout.
        if (name.empty() || (name.size() == 1 && !ctrl)) return;
        Input input = at_pointer(window, Input::Kind::key);
        const bool shift = (mods & GLFW_MOD_SHIFT) != 0;
        input.key = std::string(ctrl ? "Ctrl+" : "") + (shift ? "Shift+" : "") + name;
        add(window, input);
    }
    static void character(GLFWwindow* window, unsigned code) {
        ImGui_ImplGlfw_CharCallback(window, code);
        if (code >= 128) return;
        Input input = at_pointer(window, Input::Kind::key);
        input.key = code == ' ' ? "Space" : std::string(1, static_cast<char>(code));
        add(window, input);
    }
    static void drop(GLFWwindow* window, int count, const char** names) {
        of(window).activity_ = true;
        of(window).drops_.assign(names, names + count);
    }
    static void refresh(GLFWwindow* window) { of(window).activity_ = true; }
    static void resize(GLFWwindow* window, int /*width*/, int /*height*/) {
        of(window).activity_ = true;
    }
    static void state(GLFWwindow* window, int /*on*/) { of(window).activity_ = true; }
    static void enter(GLFWwindow* window, int entered) {
        ImGui_ImplGlfw_CursorEnterCallback(window, entered);
        state(window, entered);
    }
    static void focus(GLFWwindow* window, int focused) {
        ImGui_ImplGlfw_WindowFocusCallback(window, focused);
        state(window, focused);
    }
};

Window::Window(ink::Size size, const std::string& title) {
    glfwSetErrorCallback([](int /*code*/, const char* text) { last_error = text; });
    if (glfwInit() == GLFW_FALSE) refuse();
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    if (GLFWmonitor* const monitor = glfwGetPrimaryMonitor()) {
        int x = 0;
        int y = 0;
        int width = 0;
        int height = 0;
        glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
        constexpr int kFrame = 40;  // of the window manager
        if (width > kFrame && height > kFrame) {
            size.width = std::min(size.width, width);
            size.height = std::min(size.height, height - kFrame);
        }
    }
    watch_display();  // the display can go while the window is made
    window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        glfwTerminate();
        refuse();
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    glfwSetMouseButtonCallback(window_, Callbacks::button);
    glfwSetCursorPosCallback(window_, Callbacks::move);
    glfwSetScrollCallback(window_, Callbacks::scroll);
    glfwSetKeyCallback(window_, Callbacks::key);
    glfwSetCharCallback(window_, Callbacks::character);
    glfwSetDropCallback(window_, Callbacks::drop);
    glfwSetWindowRefreshCallback(window_, Callbacks::refresh);
    glfwSetFramebufferSizeCallback(window_, Callbacks::resize);
    glfwSetWindowIconifyCallback(window_, Callbacks::state);
    glfwSetCursorEnterCallback(window_, Callbacks::enter);
    glfwSetWindowFocusCallback(window_, Callbacks::focus);
    glfwGetCursorPos(window_, &pointer_x_, &pointer_y_);
    start_interface();
}

void Window::start_interface() {
    float scale = 1.0F;
    glfwGetWindowContentScale(window_, &scale, nullptr);
    scale_ = std::clamp(scale, 0.5F, 8.0F);
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // leaves no file where it was started
    set_theme(scale_);
    ImGui_ImplGlfw_InitForOpenGL(window_, false);  // the callbacks above pass events on
    ImGui_ImplOpenGL2_Init();
}

Window::~Window() {
    if (display_is_gone) return;  // all that would be given back is on it
    window_thread = {};           // from here on nothing may be thrown
    for (const unsigned texture : {texture_, rest_}) {
        if (texture != 0) glDeleteTextures(1, &texture);
    }
    ImGui_ImplOpenGL2_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool Window::closed() const { return glfwWindowShouldClose(window_) != 0; }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

bool Window::visible() const {
    const ink::Size now = size();
    return now.width > 0 && now.height > 0 && glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == 0;
}

ink::Size Window::size() const {
    ink::Size size;
    glfwGetFramebufferSize(window_, &size.width, &size.height);
    return size;
}

void Window::wait(std::optional<std::chrono::steady_clock::time_point> until) {
    if (!until) return glfwWaitEvents();
    const std::chrono::duration<double> left = *until - std::chrono::steady_clock::now();
    if (left.count() > 0.0) {
        glfwWaitEventsTimeout(left.count());
    } else {
        glfwPollEvents();
    }
}

void Window::wake() {
    if (!display_is_gone) glfwPostEmptyEvent();
}

std::vector<Input> Window::take_input() { return std::exchange(input_, {}); }
std::vector<std::filesystem::path> Window::take_drops() { return std::exchange(drops_, {}); }
bool Window::take_activity() { return std::exchange(activity_, false); }
// Not what it said of the pointer's last place: a quick hand is elsewhere by now.
bool Window::interface_has_pointer() const {
    return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId) || ImGui::IsAnyItemActive();
}
bool Window::interface_has_keys() const { return ImGui::GetIO().WantTextInput; }

/// Dear ImGui looks at keys once a frame. One that is pressed and released between two frames is
/// released after the next one, or it would not notice.
void Window::pass_on(int key, int scancode, int action, int mods) {
    if (action == GLFW_PRESS) pressed_.push_back(key);
    if (action == GLFW_RELEASE && std::ranges::find(pressed_, key) != pressed_.end()) {
        late_releases_.push_back({key, scancode, mods});
    } else {
        ImGui_ImplGlfw_KeyCallback(window_, key, scancode, action, mods);
    }
}

void Window::release_late_keys() {
    pressed_.clear();
    for (const auto [key, scancode, mods] : std::exchange(late_releases_, {})) {
        ImGui_ImplGlfw_KeyCallback(window_, key, scancode, GLFW_RELEASE, mods);
        activity_ = true;
    }
}

void Window::begin_frame() {
    ImGui_ImplOpenGL2_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

bool Window::interface_is_open() const {
    // Hints belong to what the pointer is over.
    return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId) || ImGui::IsAnyItemHovered();
}

void Window::end_frame(ink::Size picture) {
    ImGui::Render();
    const ink::Size now = size();
    glViewport(0, 0, now.width, now.height);
    constexpr float kPaper = 1.0F;
    glClearColor(kPaper, kPaper, kPaper, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL2_RenderDrawData(ImGui::GetDrawData());
    keep_rest(picture);
    glfwSwapBuffers(window_);
    release_late_keys();
}

namespace {

constexpr int kClampToEdge = 0x812F;  // OpenGL 1.2, which the header need not know

/// Makes a texture where there is none, and chooses it.
void bind_texture(unsigned& texture, int filter) {
    if (texture == 0) glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, kClampToEdge);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, kClampToEdge);
}

/// A rectangle of the window that shows a part of the chosen texture: left, top, right, bottom, in
/// pixels from the upper left corner and in shares of the texture.
void draw_part(const std::array<int, 4>& place, const std::array<float, 4>& part) {
    const auto [left, top, right, bottom] = place;
    const auto [u0, v0, u1, v1] = part;
    glBegin(GL_QUADS);
    glTexCoord2f(u0, v0);
    glVertex2i(left, top);
    glTexCoord2f(u1, v0);
    glVertex2i(right, top);
    glTexCoord2f(u1, v1);
    glVertex2i(right, bottom);
    glTexCoord2f(u0, v1);
    glVertex2i(left, bottom);
    glEnd();
}

}  // namespace

/// What lies to the right of the picture and below it.
void Window::keep_rest(ink::Size picture) {
    const ink::Size now = size();
    const int right = now.width - picture.width;
    const int below = now.height - picture.height;
    if (right < 0 || below < 0) return;
    bind_texture(rest_, GL_NEAREST);
    if (rest_size_ != now) {
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB, now.width, now.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                     nullptr);
        rest_size_ = now;
    }
    // OpenGL counts rows from below.
    glCopyTexSubImage2D(GL_TEXTURE_2D, 0, picture.width, 0, picture.width, 0, right, now.height);
    glCopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, picture.width, below);
}

void Window::redraw(const Picture& picture, std::uint64_t number, ink::Size size) {
    const ink::Size whole = this->size();
    glViewport(0, 0, whole.width, whole.height);
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    glOrtho(0, whole.width, whole.height, 0, -1, 1);
    glMatrixMode(GL_MODELVIEW);
    glLoadIdentity();
    glDisable(GL_BLEND);
    glEnable(GL_TEXTURE_2D);
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
    const bool smooth = picture.width() != size.width || picture.height() != size.height;
    texture(picture, number, smooth);
    glBindTexture(GL_TEXTURE_2D, texture_);
    draw_part({0, 0, size.width, size.height}, {0, 0, 1, 1});
    glBindTexture(GL_TEXTURE_2D, rest_);
    const float u = static_cast<float>(size.width) / static_cast<float>(whole.width);
    const float v = 1.0F - static_cast<float>(size.height) / static_cast<float>(whole.height);
    draw_part({size.width, 0, whole.width, whole.height}, {u, 1, 1, 0});
    draw_part({0, size.height, size.width, whole.height}, {0, v, u, 0});
    glDisable(GL_TEXTURE_2D);
    glfwSwapBuffers(window_);
}

void* Window::texture(const Picture& picture, std::uint64_t number, bool smooth) {
    bind_texture(texture_, smooth ? GL_LINEAR : GL_NEAREST);
    void* const id = reinterpret_cast<void*>(static_cast<std::uintptr_t>(texture_));
    if (number == texture_number_) return id;
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    const ink::Size size{picture.width(), picture.height()};
    if (size == texture_size_) {
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE,
                        picture.rgba().data());
    } else {
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, size.width, size.height, 0, GL_RGBA,
                     GL_UNSIGNED_BYTE, picture.rgba().data());
    }
    texture_size_ = size;
    texture_number_ = number;
    return id;
}

void Window::cover(const ImDrawList* /*list*/, const ImDrawCmd* /*command*/) {
    glDisable(GL_BLEND);
}
void Window::mix(const ImDrawList* /*list*/, const ImDrawCmd* /*command*/) { glEnable(GL_BLEND); }

void Window::copy(const std::string& text) { glfwSetClipboardString(window_, text.c_str()); }

}  // namespace inktrace::viewer

// What another program on the display does to the viewer, for viewer_test.sh:
//   x_client drop WINDOW FILE...   drags files onto a window and drops them (XDND)
//   x_client close WINDOW          asks a window to close, as its frame's button does
//   x_client dpi NUMBER            tells programs that start later how dense the screen is

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace {

class DropSource {
  public:
    DropSource(Display* display, Window target, std::string uris)
        : display_(display), target_(target), uris_(std::move(uris)) {
        own_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 8, 8, 0, 0, 0);
        XSetSelectionOwner(display_, atom("XdndSelection"), own_, CurrentTime);
    }

    /// False if the other side refuses, or stops to answer.
    bool drop() {
        constexpr long kVersion = 5;
        const auto list = static_cast<long>(atom("text/uri-list"));
        send("XdndEnter", {kVersion << 24, list, 0, 0});
        constexpr long kPlace = 60L << 16 | 60L;  // x, y on the screen
        send("XdndPosition", {0, kPlace, CurrentTime, static_cast<long>(atom("XdndActionCopy"))});
        if ((answer("XdndStatus") & 1) == 0) return false;
        send("XdndDrop", {0, CurrentTime, 0, 0});
        return answer("XdndFinished") != 0;  // GLFW answers with more than the one bit
    }

  private:
    Atom atom(const char* name) { return XInternAtom(display_, name, False); }

    void send(const char* type, const std::array<long, 4>& values) {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = target_;
        event.xclient.message_type = atom(type);
        event.xclient.format = 32;
        event.xclient.data.l[0] = static_cast<long>(own_);
        for (std::size_t k = 0; k < values.size(); ++k) event.xclient.data.l[k + 1] = values[k];
        XSendEvent(display_, target_, False, NoEventMask, &event);
    }

    /// Waits for a message and returns its flags; hands out the names when asked for them.
    long answer(const char* type) {
        for (;;) {
            XEvent event;
            XNextEvent(display_, &event);
            if (event.type == SelectionRequest) give(event.xselectionrequest);
            if (event.type != ClientMessage) continue;
            if (event.xclient.message_type == atom(type)) return event.xclient.data.l[1];
        }
    }

    void give(const XSelectionRequestEvent& request) {
        XChangeProperty(display_, request.requestor, request.property, request.target, 8,
                        PropModeReplace, reinterpret_cast<const unsigned char*>(uris_.data()),
                        static_cast<int>(uris_.size()));
        XEvent event{};
        event.xselection.type = SelectionNotify;
        event.xselection.requestor = request.requestor;
        event.xselection.selection = request.selection;
        event.xselection.target = request.target;
        event.xselection.property = request.property;
        event.xselection.time = request.time;
        XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    }

    Display* display_;
    Window target_;
    Window own_ = 0;
    std::string uris_;
};

void ask_to_close(Display* display, Window window) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = window;
    event.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", False));
    XSendEvent(display, window, False, NoEventMask, &event);
}

/// As a desktop does when its user chooses a scale.
void set_density(Display* display, const std::string& dots_per_inch) {
    const std::string text = "Xft.dpi:\t" + dots_per_inch + "\n";
    XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(text.data()),
                    static_cast<int>(text.size()));
}

}  // namespace

int main(int argc, char** argv) {
    Display* const display = argc < 3 ? nullptr : XOpenDisplay(nullptr);
    if (display == nullptr) return 2;
    const std::string_view what = argv[1];
    bool done = true;
    if (what == "drop") {
        std::string uris;
        for (int k = 3; k < argc; ++k) {
            uris += "file://" + std::filesystem::absolute(argv[k]).string() + "\r\n";
        }
        done = DropSource(display, std::strtoul(argv[2], nullptr, 0), uris).drop();
    } else if (what == "close") {
        ask_to_close(display, std::strtoul(argv[2], nullptr, 0));
    } else {
        set_density(display, argv[2]);
    }
    XCloseDisplay(display);
    return done ? 0 : 1;
}

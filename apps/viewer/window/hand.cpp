#include "window/hand.h"

#include <cmath>
#include <numbers>

namespace inktrace::viewer {

using ink::Vec3d;

namespace {

Vec3d to_vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

bool inside(double x, double y, ink::Size picture) {
    return x >= 0 && y >= 0 && x < picture.width && y < picture.height;
}

}  // namespace

void Hand::take(const Input& input, ink::Size picture) {
    if (!interface_.session.has_scene()) return;
    switch (input.kind) {
        case Input::Kind::press: press(input, picture); break;
        case Input::Kind::release: release(input); break;
        case Input::Kind::move: move(input, picture); break;
        case Input::Kind::scroll: scroll(input, picture); break;
        case Input::Kind::key: break;
    }
}

void Hand::press(const Input& input, ink::Size picture) {
    if (!inside(input.x, input.y, picture) || drag_ != Drag::none) return;
    if (interface_.window.interface_has_pointer()) return;
    drag_ = input.button != 0 || input.shift ? Drag::pan : input.ctrl ? Drag::roll : Drag::turn;
    moved_ = false;
    start_x_ = last_x_ = input.x;
    start_y_ = last_y_ = input.y;
}

void Hand::release(const Input& input) {
    const bool click = drag_ != Drag::none && !moved_ && input.button == 0;
    drag_ = Drag::none;
    if (!click) return;
    constexpr auto kDouble = std::chrono::milliseconds(400);
    const bool twice = Clock::now() - last_click_ < kDouble;
    last_click_ = Clock::now();
    Session& session = interface_.session;
    interface_.attempt([&] {
        interface_.picked = session.pick(input.x, input.y);
        if (twice && interface_.picked) {
            session.move_camera(session.camera().focused(to_vector(interface_.picked->center)));
        }
    });
}

void Hand::move(const Input& input, ink::Size picture) {
    constexpr auto kRest = std::chrono::milliseconds(150);
    zoom_point_.reset();
    look_at_ = Clock::now() + kRest;
    if (drag_ == Drag::none) {
        last_x_ = input.x;
        last_y_ = input.y;
        return;
    }
    constexpr double kClick = 4.0;  // pixels that a hand trembles by
    if (!moved_ && std::hypot(input.x - start_x_, input.y - start_y_) < kClick) return;
    moved_ = true;
    const double dx = input.x - last_x_;
    const double dy = input.y - last_y_;
    const CameraPose pose = interface_.session.camera();
    CameraPose next = pose;
    if (drag_ == Drag::turn) {
        // Across the picture's height: half a turn.
        const double degrees = 180.0 / std::max(picture.height, 1);
        next = pose.turned(dx * degrees, dy * degrees);
    } else if (drag_ == Drag::pan) {
        next = pose.panned(dx, dy, picture.height);
    } else {
        const double mx = 0.5 * picture.width;
        const double my = 0.5 * picture.height;
        const double turn =
            std::atan2(input.y - my, input.x - mx) - std::atan2(last_y_ - my, last_x_ - mx);
        next = pose.rolled(std::remainder(turn * 180.0 / std::numbers::pi, 360.0));
    }
    interface_.session.move_camera(next);
    last_x_ = input.x;
    last_y_ = input.y;
}

void Hand::scroll(const Input& input, ink::Size picture) {
    if (interface_.window.interface_has_pointer() || !inside(input.x, input.y, picture)) return;
    Session& session = interface_.session;
    const CameraPose pose = session.camera();
    if (!zoom_point_) {
        zoom_point_ = pose.under(input.x, input.y, picture);
        interface_.attempt([&] {
            if (const auto hit = session.pick(input.x, input.y)) {
                zoom_point_ = to_vector(hit->position);
            }
        });
    }
    constexpr double kNotch = 1.15;
    session.move_camera(pose.zoomed(std::pow(kNotch, -input.amount), *zoom_point_));
}

bool Hand::look() {
    if (!look_at_ || Clock::now() < *look_at_) return false;
    look_at_.reset();
    if (drag_ != Drag::none || interface_.window.interface_has_pointer()) return false;
    const bool before = interface_.under_pointer.has_value();
    const bool over_picture = inside(last_x_, last_y_, interface_.session.size());
    interface_.attempt([&] {
        interface_.under_pointer =
            over_picture ? interface_.session.pick(last_x_, last_y_) : std::nullopt;
    });
    // What is under the pointer is told where news were told before.
    if (interface_.under_pointer && !interface_.session.message().is_error) {
        interface_.session.say("");
    }
    return before || interface_.under_pointer;
}

}  // namespace inktrace::viewer

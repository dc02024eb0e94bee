#include "window/interface.h"

#include <fmt/format.h>

namespace inktrace::viewer {

void Interface::set(const std::string& name, const std::string& value) {
    attempt([&] {
        session.set(name, value);
        if (session.message().is_error) session.say("");
    });
}

std::string describe(const Hit& hit) {
    std::string text = fmt::format("{} {} of {}", hit.kind, hit.primitive + 1, hit.object);
    for (const auto& [name, value] : hit.facts) text += fmt::format(",  {} {}", name, value);
    return text;
}

}  // namespace inktrace::viewer

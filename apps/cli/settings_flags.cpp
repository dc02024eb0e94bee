#include "settings_flags.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace inktrace::cli {

void add_setting_flags(CLI::App& command, Settings& settings, std::string_view topic) {
    for (const SettingInfo& info : all_settings()) {
        if (!topic.empty() && info.topic != topic) continue;
        const std::string help = info.default_value.empty()
                                     ? info.help
                                     : fmt::format("{} [{}]", info.help, info.default_value);
        command
            .add_option_function<std::string>(
                "--" + info.name,
                [&settings, name = info.name](const std::string& value) {
                    settings.set(name, value);
                },
                help)
            ->type_name(info.value)
            ->group(info.topic)
            ->expected(1)
            ->take_last();  // so that a script can add to the flags that it was given
    }
}

}  // namespace inktrace::cli

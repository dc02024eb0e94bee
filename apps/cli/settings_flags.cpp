#include "settings_flags.h"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace inktrace::cli {

void add_setting_flags(CLI::App& command, Settings& settings, std::string_view topic) {
    for (const SettingInfo& info : all_settings()) {
        if (!topic.empty() && info.topic != topic) continue;
        const std::string help = info.default_value.empty()
                                     ? info.help
                                     : fmt::format("{} [{}]", info.help, info.default_value);
        // The last of several counts, so that a script can add to the flags that it was given;
        // unless they add up.
        using Values = std::vector<std::string>;
        command
            .add_option_function<Values>(
                "--" + info.name,
                [&settings, name = info.name](const Values& values) {
                    for (const std::string& value : values) settings.set(name, value);
                },
                help)
            ->type_name(info.value)
            ->group(info.topic)
            ->expected(1)
            ->allow_extra_args(false)
            ->multi_option_policy(info.repeatable ? CLI::MultiOptionPolicy::TakeAll
                                                  : CLI::MultiOptionPolicy::TakeLast);
    }
}

}  // namespace inktrace::cli

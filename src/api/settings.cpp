#include "inktrace/settings.h"

#include <array>

#include "api/guard.h"
#include "api/impl.h"
#include "render/looks.h"
#include "render/scaled.h"

namespace inktrace {

namespace {

ValueForm public_form(const ink::ValueForm& form) {
    using Kind = ValueForm::Kind;
    constexpr std::array kKinds{Kind::text,   Kind::word,   Kind::list, Kind::whole,
                                Kind::number, Kind::length, Kind::color};
    return {kKinds[static_cast<std::size_t>(form.kind)],
            {form.words.begin(), form.words.end()},
            form.least,
            form.most};
}

}  // namespace

const std::vector<SettingInfo>& all_settings() {
    static const std::vector<SettingInfo> kInfos = [] {
        const ink::Settings defaults;
        std::vector<SettingInfo> infos;
        for (const ink::Setting& row : ink::settings_table()) {
            infos.push_back({std::string(row.name), std::string(row.topic), std::string(row.value),
                             std::string(row.help), row.get(defaults), row.repeatable,
                             public_form(row.form)});
        }
        return infos;
    }();
    return kInfos;
}

Settings::Settings() : impl_(std::make_unique<Impl>()) {}
Settings::Settings(const Settings& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
Settings::Settings(Settings&&) noexcept = default;
Settings& Settings::operator=(const Settings& other) {
    impl_ = std::make_unique<Impl>(*other.impl_);  // what was moved from may be assigned to
    return *this;
}
Settings& Settings::operator=(Settings&&) noexcept = default;
Settings::~Settings() = default;

Settings& Settings::set(std::string_view name, std::string_view value) {
    ink::guard([&] { ink::find_setting(name).set(impl_->settings, value); });
    return *this;
}

std::string Settings::get(std::string_view name) const {
    return ink::guard([&] { return ink::find_setting(name).get(impl_->settings); });
}

Settings Settings::scaled(double factor) const {
    Settings copy;
    copy.impl_->settings = ink::scaled(impl_->settings, factor);
    return copy;
}

std::vector<std::pair<std::string, std::string>> Settings::changed() const {
    ink::Settings defaults;
    std::vector<std::pair<std::string, std::string>> list;
    if (!impl_->settings.look.empty()) {
        list.emplace_back("look", impl_->settings.look);
        ink::set_look(defaults, impl_->settings.look);
    }
    for (const ink::Setting& row : ink::settings_table()) {
        std::string value = row.get(impl_->settings);
        if (value != row.get(defaults)) list.emplace_back(row.name, std::move(value));
    }
    return list;
}

}  // namespace inktrace

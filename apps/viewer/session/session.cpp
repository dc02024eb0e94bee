#include "session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "session/command_line.h"

namespace inktrace::viewer {

using ink::Vec3d;

namespace {

/// Settings that decide what is read from the files.
std::string scene_key(const Settings& settings) {
    std::string key = settings.get("ids");  // which of a molecule's levels is a part
    for (const SettingInfo& info : all_settings()) {
        if (info.topic == "Input") key += "\n" + settings.get(info.name);
    }
    if (settings.get("look") == "goodsell") key += "\nby residue";
    return key;
}

Vec3d to_vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

Session::Session(std::function<void()> wake)
    : wake_(std::move(wake)), loader_(wake_), painter_(wake_), exporter_(wake_), watcher_([this] {
          files_changed_ = true;
          wake_();
      }) {}

// ---- Files ----

void Session::open(std::vector<std::filesystem::path> files,
                   const std::vector<std::pair<std::string, std::string>>& flags) {
    Settings base;
    for (const std::filesystem::path& file : files) {
        for (const auto& [name, value] : scene_file_settings(file)) base.set(name, value);
    }
    Settings settings = base;
    for (const auto& [name, value] : flags) settings.set(name, value);
    if (picture_number_ > 0) settings.set("size", settings_.get("size"));
    files_ = std::move(files);
    base_ = base;
    opened_ = settings_ = settings;
    history_.clear();
    playing_ = false;
    series_color_by_.reset();
    message_ = {};
    watcher_.watch(files_);
    load(false);
}

void Session::reload() {
    if (files_.empty()) return;
    watcher_.watch(files_);  // an archive may have got new folders
    forget_range(settings_);
    if (settings_.get("radius") == series_radius_) settings_.set("radius", "");
    series_color_by_.reset();
    load(true);
}

void Session::load(bool keep_camera, std::vector<int> series) {
    if (keep_camera) fix_camera();
    loader_.load({files_, settings_, ++load_number_, std::move(series)});
}

bool Session::files_are_there() {
    for (const std::filesystem::path& file : files_) {
        const bool pattern = file.string().find_first_of("*?") != std::string::npos;
        std::error_code failure;
        if (pattern || std::filesystem::exists(file, failure)) continue;
        say(fmt::format("{} is gone; the picture shows what it held", file.string()), true);
        return false;
    }
    return true;
}

void Session::take(LoadResult result) {
    if (result.request.number != load_number_) return;  // another one is on its way
    if (!result.renderer) {
        say(result.error, true);
        playing_ = false;
        // The settings that the files refuse go back to those of the scene that is shown.
        const bool changed = scene_key(settings_) != scene_key(loaded_);
        if (renderer_ && changed && result.request.files == files_) {
            if (history_.can_undo()) settings_ = history_.take_back(settings_);
            for (const SettingInfo& info : all_settings()) {
                if (info.topic == "Input" || info.name == "ids") {
                    settings_.set(info.name, loaded_.get(info.name));
                }
            }
        }
        return;
    }
    const bool first = !renderer_ || result.request.files.size() != infos_.size();
    renderer_ = std::move(result.renderer);
    infos_ = std::move(result.infos);
    primitives_ = result.primitives;
    loaded_ = std::move(result.request.settings);
    if (result.looked_through) keep_series(loaded_);
    frames_ = 1 << 30;
    for (const FileInfo& info : infos_) frames_ = std::min(frames_, info.frames);
    if (first || message_.is_error) message_ = {};
    for (const FileInfo& info : infos_) {
        if (!info.warnings.empty()) say(info.warnings.front());
    }
    paint(true);
}

// ---- Settings ----

void Session::apply(Settings settings) {
    const bool other_scene = scene_key(settings) != scene_key(settings_);
    settings_ = std::move(settings);
    if (other_scene && !files_.empty()) {
        load(true);
    } else {
        paint(true);
    }
}

void Session::set(const std::string& name, const std::string& value) {
    if (name == "view") return standard_view(value);
    Settings settings = settings_;
    const auto& infos = all_settings();
    const auto info = std::ranges::find(infos, name, &SettingInfo::name);
    if (info != infos.end() && info->repeatable) settings.set(name, "");
    settings.set(name, value);
    if (name == "color-by") forget_range(settings);
    validate(settings);
    if (settings.get(name) == settings_.get(name)) return;
    if (!is_of_view(name)) history_.remember(settings_, name, Clock::now());
    apply(std::move(settings));
}

void Session::reset() {
    Settings settings = opened_;
    for (const SettingInfo& info : all_settings()) {
        if (is_of_view(info.name)) settings.set(info.name, settings_.get(info.name));
    }
    if (settings.changed() == settings_.changed()) return;
    history_.remember(settings_, "", Clock::now());
    apply(std::move(settings));
}

void Session::undo() {
    if (history_.can_undo()) apply(history_.undo(settings_));
}

void Session::redo() {
    if (history_.can_redo()) apply(history_.redo(settings_));
}

// ---- Camera ----

void Session::resize(ink::Size size) {
    if (size.width < 1 || size.height < 1 || size == this->size()) return;
    settings_.set("size", fmt::format("{}x{}", size.width, size.height));
    paint(true);
}

ink::Size Session::size() const {
    const std::string text = settings_.get("size");
    const auto sides = ink::split(text, 'x');
    return {static_cast<int>(ink::parse_int(sides[0]).value_or(1)),
            static_cast<int>(ink::parse_int(sides[1]).value_or(1))};
}

/// Writes out the camera that the settings choose, so that another scene is seen by the same one.
void Session::fix_camera() {
    if (renderer_) settings_ = renderer_->with_camera(settings_);
}

CameraPose Session::camera() const { return CameraPose::of(renderer_->with_camera(settings_)); }

void Session::move_camera(const CameraPose& pose) {
    if (!renderer_) return;
    Settings settings = settings_;
    pose.write(settings);
    settings_ = std::move(settings);
    paint(true);
}

void Session::standard_view(const std::string& name) {
    Settings settings = settings_;
    settings.set("view", name).set("eye", "").set("look-at", "").set("up", "");
    if (orthographic()) settings.set("orthographic", "auto");
    settings_ = std::move(settings);
    paint(true);
}

void Session::frame_all() {
    if (!renderer_ || infos_.empty()) return;
    Vec3d lower = to_vector(infos_.front().lower);
    Vec3d upper = to_vector(infos_.front().upper);
    for (const FileInfo& info : infos_) {
        const Vec3d a = to_vector(info.lower);
        const Vec3d b = to_vector(info.upper);
        lower = {std::min(lower.x, a.x), std::min(lower.y, a.y), std::min(lower.z, a.z)};
        upper = {std::max(upper.x, b.x), std::max(upper.y, b.y), std::max(upper.z, b.z)};
    }
    move_camera(camera().framing(lower, upper, size()));
}

bool Session::orthographic() const { return !settings_.get("orthographic").empty(); }

std::optional<Hit> Session::pick(double x, double y) const {
    if (!renderer_) return std::nullopt;
    return renderer_->pick(settings_, x, y);
}

// ---- Trajectory ----

int Session::frame() const {
    const std::string text = settings_.get("frame");
    return static_cast<int>(ink::parse_int(text.substr(0, text.find(':'))).value_or(0));
}

void Session::set_frame(int frame) {
    const int wrapped = ((frame % frames_) + frames_) % frames_;
    if (wrapped == this->frame()) return;
    set("frame", std::to_string(wrapped));
}

void Session::play(bool on) {
    playing_ = on && frames_ > 1;
    if (!playing_) loader_.stop_looking();
}

/// Whether each frame may choose for itself what those of an animation have in common.
bool Session::chooses_by_frame() const {
    if (series_color_by_ == settings_.get("color-by")) return false;
    const auto has_range = [](const FileInfo& info) { return info.color_range.has_value(); };
    const bool range =
        settings_.get("color-range").empty() && std::ranges::any_of(infos_, has_range);
    const bool kinds = settings_.get("color-by").empty() && infos_.size() == 1 &&
                       !infos_.front().kind_field.empty();
    const bool radius = settings_.get("radius").empty() && infos_.size() == 1 &&
                        infos_.front().chosen_radius.has_value();
    return range || kinds || radius;
}

/// The frames to look through: of very many so many as tell enough.
std::vector<int> Session::series() const {
    constexpr int kMost = 256;
    const int count = std::min(frames_, kMost);
    std::vector<int> frames;
    for (int k = 0; k < count; ++k) {
        frames.push_back(static_cast<int>(std::int64_t{k} * (frames_ - 1) / (count - 1)));
    }
    return frames;
}

/// They become settings like all others, so that the command line draws the picture.
void Session::keep_series(const Settings& found) {
    series_color_by_ = found.get("color-by");
    series_range_ = found.get("color-range");
    series_radius_ = found.get("radius");
    Settings settings = settings_;
    settings.set("color-range", series_range_).set("radius", series_radius_);
    settings.set("color-by", found.get("color-by")).set("colormap", found.get("colormap"));
    if (settings.changed() == settings_.changed()) return;
    history_.remember(settings_, "color-range", Clock::now());
    settings_ = std::move(settings);
}

/// Another field, or other files: their range is another.
void Session::forget_range(Settings& settings) const {
    if (settings.get("color-range") == series_range_) settings.set("color-range", "");
}

std::optional<Clock::time_point> Session::next_update() const {
    if (!playing_ || loader_.busy()) return std::nullopt;
    const auto pause = std::chrono::duration<double>(1.0 / std::max(frames_per_second, 0.1));
    return frame_shown_ + std::chrono::duration_cast<Clock::duration>(pause);
}

// ---- Picture ----

void Session::paint(bool in_motion) {
    if (!renderer_) return;
    Settings settings = settings_;
    settings.set("aov", "none");
    painter_.paint({renderer_, std::move(settings), in_motion, Clock::now()});
}

bool Session::update() {
    bool news = false;
    if (files_changed_.exchange(false) && files_are_there()) reload();
    if (auto result = loader_.take()) {
        take(std::move(*result));
        news = true;
    }
    if (auto painting = painter_.take()) {
        const bool other_frame = painting_.settings.get("frame") != painting->settings.get("frame");
        if (other_frame || !painting_.picture) frame_shown_ = Clock::now();
        painting_ = std::move(*painting);
        ++picture_number_;
        news = true;
    }
    if (auto error = painter_.take_error()) {
        say(std::move(*error), true);
        news = true;
    }
    if (auto result = exporter_.take()) {
        if (result->error.empty()) {
            say(fmt::format("Wrote {}", std::filesystem::absolute(result->file).string()));
        } else {
            say(result->error, true);
        }
        news = true;
    }
    const auto next = next_update();
    // The next frame waits until this one has been seen.
    const bool seen = painting_.settings.get("frame") == settings_.get("frame");
    if (next && seen && Clock::now() >= *next) {
        frame_shown_ = Clock::now();
        if (chooses_by_frame()) {
            load(true, series());
        } else {
            set_frame(frame() + 1);
        }
    }
    return news;
}

// ---- Output ----

std::string Session::command_line(const std::filesystem::path& output) const {
    return viewer::command_line(files_, output, settings_, base_);
}

Settings Session::export_settings(ink::Size size, bool scale_lines) const {
    const double factor = static_cast<double>(size.height) / this->size().height;
    Settings settings = scale_lines && factor != 1.0 ? settings_.scaled(factor) : settings_;
    settings.set("size", fmt::format("{}x{}", size.width, size.height));
    return settings;
}

std::string Session::export_command(const std::filesystem::path& output, ink::Size size,
                                    bool scale_lines) const {
    return viewer::command_line(files_, output, export_settings(size, scale_lines), base_);
}

bool Session::export_picture(const std::filesystem::path& output, ink::Size size,
                             bool scale_lines) {
    if (!renderer_) return false;
    return exporter_.write(renderer_, export_settings(size, scale_lines), output);
}

void Session::save_scene(const std::filesystem::path& output) {
    viewer::save_scene(output, files_, settings_);
    say(fmt::format("Wrote {}", std::filesystem::absolute(output).string()));
}

}  // namespace inktrace::viewer

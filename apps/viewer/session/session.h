#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "inktrace/inktrace.h"
#include "session/camera_pose.h"
#include "session/exporter.h"
#include "session/file_watcher.h"
#include "session/history.h"
#include "session/loader.h"
#include "session/painter.h"

namespace inktrace::viewer {

/// Everything of the interactive viewer but its window: the scene, the camera, the settings, and
/// the pictures of them, which are drawn on threads of their own.
///
/// One thread owns a session and calls it. `wake` is called from other threads when there is news;
/// the owner then calls `update`. Between news nothing runs.
class Session {
  public:
    explicit Session(std::function<void()> wake);

    // ---- Files ----

    /// Loads files in place of those that are there. `flags` are settings as on the command line;
    /// they go before those of scene files. Throws Error for a scene file that cannot be read.
    void open(std::vector<std::filesystem::path> files,
              const std::vector<std::pair<std::string, std::string>>& flags = {});
    /// Reads the files again.
    void reload();
    const std::vector<std::filesystem::path>& files() const { return files_; }
    const std::vector<FileInfo>& infos() const { return infos_; }
    std::size_t primitives() const { return primitives_; }
    bool has_scene() const { return renderer_ != nullptr; }

    // ---- Settings ----

    const Settings& settings() const { return settings_; }
    /// Throws Error (usage) for what `Settings::set` refuses; nothing changes then.
    void set(const std::string& name, const std::string& value);
    /// The value that the program or the scene file starts from.
    std::string base_value(const std::string& name) const { return base_.get(name); }
    /// All settings but the view as they were when the files were opened.
    void reset();
    bool can_undo() const { return history_.can_undo(); }
    bool can_redo() const { return history_.can_redo(); }
    void undo();
    void redo();

    // ---- Camera ----

    /// Size of the picture, pixels. Ignored where a side is 0, as of a minimised window.
    void resize(ink::Size size);
    ink::Size size() const;
    /// The camera that the picture is seen by; needs a scene.
    CameraPose camera() const;
    void move_camera(const CameraPose& pose);
    /// "front", "top", ...: the scene fills the picture, in the projection that is set.
    void standard_view(const std::string& name);
    /// All of the scene in the picture, from where the camera looks.
    void frame_all();
    bool orthographic() const;

    /// What lies under a pixel's point; nothing where that is the background or there is no scene.
    std::optional<Hit> pick(double x, double y) const;

    // ---- Trajectory ----

    int frames() const { return frames_; }  ///< that every file has
    int frame() const;
    void set_frame(int frame);  ///< wraps round at both ends
    bool playing() const { return playing_; }
    /// Plays all frames alike: with one range of colours, or a colour for each kind of particles,
    /// and one radius, where these are left to each frame, as `inktrace render` draws them. All
    /// frames are looked through first.
    void play(bool on);
    /// Share of the frames that has been, in [0, 1).
    double looked_through() const { return loader_.looked_through(); }
    double frames_per_second = 15.0;  ///< of playing, at most

    // ---- Picture ----

    /// Takes in what other threads have finished; true if anything is new to be shown.
    bool update();
    /// The newest picture; its `picture` is null before the first.
    const Painting& painting() const { return painting_; }
    /// Counts pictures: another number, another picture.
    std::uint64_t picture_number() const { return picture_number_; }
    bool busy() const { return painter_.busy() || loader_.busy() || exporter_.busy(); }
    bool loading() const { return loader_.busy(); }
    double refinement() const { return painter_.progress(); }
    /// What it took the last picture that gave way to a move to do so, and how many have.
    double give_way_ms() const { return painter_.give_way_ms(); }
    std::uint64_t cancelled() const { return painter_.cancelled(); }
    /// When `update` should be called even without news: while a trajectory plays.
    std::optional<Clock::time_point> next_update() const;

    // ---- Output ----

    /// The command that draws the picture in the window.
    std::string command_line(const std::filesystem::path& output = "picture.png") const;
    /// Settings of the picture at another size. `scale_lines`: lengths on it grow with its height.
    Settings export_settings(ink::Size size, bool scale_lines) const;
    std::string export_command(const std::filesystem::path& output, ink::Size size,
                               bool scale_lines) const;
    /// Begins to write a picture; `update` brings the message. False while one is being written.
    bool export_picture(const std::filesystem::path& output, ink::Size size, bool scale_lines);
    bool exporting() const { return exporter_.busy(); }
    double export_progress() const { return exporter_.progress(); }
    /// Throws Error (input).
    void save_scene(const std::filesystem::path& output);

    // ---- Messages ----

    struct Message {
        std::string text;
        bool is_error = false;
    };
    /// The last one; empty where there is nothing to say.
    const Message& message() const { return message_; }
    void say(std::string text, bool is_error = false) { message_ = {std::move(text), is_error}; }

  private:
    void load(bool keep_camera, std::vector<int> series = {});
    bool chooses_by_frame() const;
    std::vector<int> series() const;
    void keep_series(const Settings& found);
    void forget_range(Settings& settings) const;
    void take(LoadResult result);
    void paint(bool in_motion);
    void apply(Settings settings);
    void fix_camera();
    bool files_are_there();

    std::function<void()> wake_;
    std::vector<std::filesystem::path> files_;
    std::vector<FileInfo> infos_;
    std::size_t primitives_ = 0;
    int frames_ = 1;
    Settings settings_;
    Settings base_;    ///< defaults, and over them those of scene files
    Settings opened_;  ///< base and flags
    Settings loaded_;  ///< that the renderer's scene was read by
    History history_;
    std::shared_ptr<const Renderer> renderer_;
    std::uint64_t load_number_ = 0;
    Painting painting_;
    std::uint64_t picture_number_ = 0;
    Message message_;
    bool playing_ = false;
    std::optional<std::string> series_color_by_;  ///< the frames have been looked through for,
    std::string series_range_, series_radius_;    ///< and this was found
    Clock::time_point frame_shown_{};
    std::atomic<bool> files_changed_ = false;

    // Their threads call back; they end first.
    Loader loader_;
    Painter painter_;
    Exporter exporter_;
    FileWatcher watcher_;
};

}  // namespace inktrace::viewer

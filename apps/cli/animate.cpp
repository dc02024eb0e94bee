#include "animate.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "animation.h"
#include "color_range.h"
#include "messages.h"
#include "progress_bar.h"

namespace inktrace::cli {

namespace {

/// Renders shot after shot by one camera; a scene stays as long as its frame does.
class Animation {
  public:
    explicit Animation(const RenderArguments& arguments)
        : arguments_(arguments), settings_(arguments.settings) {}

    void run() {
        const auto start = std::chrono::steady_clock::now();
        open_movie();
        const std::string frames = settings_.get("frame");
        const int first = std::stoi(frames.substr(0, frames.find(':')));
        const int count = build(first);
        const FrameRange range = frame_range(settings_, count);
        shots_ = plan_shots(arguments_.output, range, arguments_.turntable);
        if (range.last > range.first) keep_colors(range);
        choose_camera(range);
        {
            ProgressBar bar(!arguments_.quiet);
            for (std::size_t k = 0; k < shots_.size(); ++k) draw(k, bar);
        }
        if (movie_) movie_->finish();
        if (arguments_.quiet) return;
        const std::string there = left_ == 0 ? "" : fmt::format(", {} were there", left_);
        say(fmt::format("{}: {} pictures{}, {:.2f} s\n", arguments_.output, shots_.size() - left_,
                        there, ms_since(start) / 1000));
    }

  private:
    void open_movie() {
        if (!Movie::is_movie(arguments_.output)) return;
        const std::string size = settings_.get("size");
        const std::size_t cross = size.find('x');
        movie_.emplace(arguments_.output, std::stoi(size.substr(0, cross)),
                       std::stoi(size.substr(cross + 1)), arguments_.pictures_a_second);
    }

    /// Loads a frame, unless it is the one that is there; returns how many the files have.
    int build(int frame) {
        if (renderer_ && frame == frame_ && !stale_) return 0;
        Settings settings = settings_;
        settings.set("frame", std::to_string(frame));
        renderer_.reset();
        Loaded loaded = load(arguments_, settings);
        // Or particles would breathe with their distances.
        if (loaded.chosen_radius && arguments_.inputs.size() == 1) {
            settings_.set("radius", fmt::format("{}", *loaded.chosen_radius));
        }
        primitives_ = loaded.scene.primitive_count();
        renderer_.emplace(std::move(loaded.scene));
        frame_ = frame;
        stale_ = false;
        return loaded.frames;
    }

    /// Gives the field that colours show one range over all frames, where it is not set, and kinds
    /// of particles their colours in frames with one kind, too.
    void keep_colors(FrameRange range) {
        const std::vector<std::filesystem::path> files(arguments_.inputs.begin(),
                                                       arguments_.inputs.end());
        std::vector<int> frames(static_cast<std::size_t>(range.last - range.first) + 1);
        std::iota(frames.begin(), frames.end(), range.first);
        const auto go_on = [](double) { return true; };
        if (settings_.get("color-by").empty()) {
            const std::string field =
                files.size() == 1 ? kinds_over(files[0], frames, settings_, go_on) : "";
            if (field.empty()) return;
            settings_.set("color-by", field).set("colormap", "categories");
            stale_ = true;
            return;
        }
        if (!settings_.get("color-range").empty()) return;
        const auto values = color_range_over(files, frames, settings_, go_on);
        if (!values) return;
        settings_.set("color-range", fmt::format("{}:{}", values->first, values->second));
        stale_ = true;
    }

    /// A camera that stays, and that the whole run fits into the view of: chosen for some of the
    /// frames drawn together, the first and the last among them.
    void choose_camera(FrameRange range) {
        constexpr std::size_t kMostFrames = 16;
        constexpr std::size_t kMostPrimitives = 8'000'000;
        const std::size_t frames = static_cast<std::size_t>(range.last - range.first) + 1;
        const bool automatic = settings_.get("eye").empty();
        if (frames == 1 || !automatic) {
            camera_ = renderer_->with_camera(settings_);
            return;
        }
        const std::size_t most = std::clamp<std::size_t>(
            kMostPrimitives / std::max<std::size_t>(primitives_, 1), 2, kMostFrames);
        const std::size_t count = std::min(frames, most);
        Scene all;
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t frame = (frames - 1) * k / (count - 1);
            Settings settings = settings_;
            settings.set("frame", std::to_string(range.first + static_cast<int>(frame)));
            for (const std::string& input : arguments_.inputs) all.load(input, settings);
        }
        camera_ = Renderer(std::move(all)).with_camera(settings_);
    }

    void draw(std::size_t index, ProgressBar& bar) {
        const Shot& shot = shots_[index];
        if (arguments_.resume && std::filesystem::exists(shot.file)) {
            ++left_;
            return;
        }
        RenderOptions options = movie_ ? RenderOptions() : options_for_output(shot.file);
        build(shot.frame);
        Settings settings = arguments_.turntable > 0
                                ? renderer_->with_turned_camera(settings_, shot.turn_deg)
                                : *camera_;
        settings.set("frame", std::to_string(shot.frame));
        const auto total = static_cast<double>(shots_.size());
        options.progress = [&](double share, double megapixels) {
            bar.update((static_cast<double>(index) + share) / total, megapixels * total);
        };
        const Picture picture = renderer_->render(settings, options);
        if (movie_) {
            movie_->add(picture);
        } else {
            picture.save(shot.file);
        }
    }

    const RenderArguments& arguments_;
    Settings settings_;  ///< with what the first frame decides for all
    std::optional<Movie> movie_;
    std::vector<Shot> shots_;
    std::optional<Renderer> renderer_;
    std::size_t primitives_ = 0;  ///< in a frame
    int frame_ = 0;               ///< of the renderer
    bool stale_ = false;          ///< the renderer was made by other settings
    std::optional<Settings> camera_;
    std::size_t left_ = 0;
};

[[noreturn]] void refuse(const char* problem) { throw Error(Error::Kind::usage, problem); }

}  // namespace

bool is_animation(const RenderArguments& arguments) {
    const bool movie = Movie::is_movie(arguments.output);
    const bool several = movie || is_numbered(arguments.output);
    const bool frames = arguments.settings.get("frame").find(':') != std::string::npos;
    if (!several && (frames || arguments.turntable > 0)) {
        refuse(
            "an animation needs a number in the name of its pictures, or a film; "
            "write for example -o out_####.png or -o out.mp4");
    }
    if (frames && arguments.turntable > 0) {
        refuse("--turntable turns one frame; name one with --frame");
    }
    if (movie && !frames && arguments.turntable == 0) {
        refuse("a film shows frames or a turn: add --frame A:B or --turntable K");
    }
    if (movie && (arguments.resume || arguments.settings.get("aov") != "none")) {
        refuse("--resume and --aov are for pictures; leave them out, or write -o out_####.png");
    }
    const bool one_more_file = !arguments.stats_file.empty() || !arguments.lines_file.empty();
    if (several && (arguments.repeat > 1 || one_more_file)) {
        refuse("--repeat, --stats and --lines-json are for one picture; leave them out");
    }
    return several;
}

void run_animation(const RenderArguments& arguments) {
    const bool movie = Movie::is_movie(arguments.output);
    validate(arguments.settings,
             movie ? RenderOptions() : options_for_output(numbered(arguments.output, 0)));
    Animation(arguments).run();
}

}  // namespace inktrace::cli

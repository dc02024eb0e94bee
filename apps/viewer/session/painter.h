#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "inktrace/inktrace.h"
#include "session/pace.h"

namespace inktrace::viewer {

using Clock = std::chrono::steady_clock;

/// What to draw.
struct PaintRequest {
    std::shared_ptr<const Renderer> renderer;
    Settings settings;       ///< of the picture in full
    bool in_motion = false;  ///< a quick picture first, since the next request is near
    Clock::time_point asked{};
};

/// A picture for the window.
struct Painting {
    std::shared_ptr<const Picture> picture;
    Settings settings;        ///< of the request
    bool exact = false;       ///< byte for byte what `Renderer::render` gives for these settings
    double scale = 1.0;       ///< rays along a pixel's side, below 1 for a draft
    double frame_ms = 0.0;    ///< drawing it took
    double latency_ms = 0.0;  ///< from the request
};

/// Draws on a thread of its own (which shares the work with others): of what is asked for, always
/// the newest. A quick picture is finished once begun, so that a moving camera is seen moving; a
/// picture in full gives way to the next request at once.
class Painter {
  public:
    /// `news` is called from the thread when there is a painting to take, or an error.
    explicit Painter(std::function<void()> news);
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;
    ~Painter();

    void paint(PaintRequest request);
    std::optional<Painting> take();
    std::optional<std::string> take_error();

    bool busy() const;
    /// Of the picture in full, in [0, 1].
    double progress() const { return progress_.load(); }
    /// What it took the last picture that had to give way to do so, ms.
    double give_way_ms() const { return give_way_ms_.load(); }
    /// Pictures that had to give way so far.
    std::uint64_t cancelled() const { return cancelled_.load(); }

  private:
    void run();
    void quick(const PaintRequest& request);
    void guess_cost(const PaintRequest& request, double quick_ms_per_megapixel);
    void in_full(const PaintRequest& request);
    void learn_plain(const PaintRequest& request);
    void finish(Painting painting);

    std::function<void()> news_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<PaintRequest> waiting_;
    std::optional<Painting> painting_;
    std::optional<std::string> error_;
    bool running_ = false;
    std::atomic<bool> ending_ = false;
    std::atomic<bool> cancel_ = false;
    std::atomic<Clock::rep> cancelled_at_ = 0;
    std::atomic<double> progress_ = 0.0;
    std::atomic<double> give_way_ms_ = 0.0;
    std::atomic<std::uint64_t> cancelled_ = 0;
    Pace pace_;
    std::weak_ptr<const Renderer> plain_of_;  ///< whose frames without lines the pace knows,
    std::string plain_size_;                  ///< of which size,
    std::vector<std::pair<std::string, std::string>> plain_settings_;  ///< and drawn with which
    double ms_per_megapixel_ = 0.0;          ///< of pictures in full, as far as known,
    std::weak_ptr<const Renderer> cost_of_;  ///< of this renderer
    std::string cost_key_;                   ///< and for these settings
    bool shown_exactly_ = false;             ///< the quick picture was the picture in full
    std::thread thread_;
};

/// Cheaper settings for a camera that moves: the same lines from one ray a pixel.
Settings quick_settings(const Settings& settings);

}  // namespace inktrace::viewer

#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "inktrace/inktrace.h"

namespace inktrace::viewer {

/// What is to be loaded: files, by the settings of topic "Input".
struct LoadRequest {
    std::vector<std::filesystem::path> files;
    Settings settings;
    std::uint64_t number = 0;  ///< that the result comes back with
    /// Frames that are to be drawn alike, the first of them first: what each of them would choose
    /// for itself, radii and the range of colours, is looked up in all and set. None: only one.
    std::vector<int> series{};
};

/// What came of it: a renderer, or the reason why there is none.
struct LoadResult {
    LoadRequest request;  ///< with what was set for a series
    std::shared_ptr<const Renderer> renderer;
    std::vector<FileInfo> infos;
    std::size_t primitives = 0;
    std::string error;
    bool looked_through = false;  ///< the whole series
};

/// Loads files on a thread of its own. A new request takes the place of one that waits.
class Loader {
  public:
    /// `done` is called from the thread when there is a result to take.
    explicit Loader(std::function<void()> done);
    Loader(const Loader&) = delete;
    Loader& operator=(const Loader&) = delete;
    ~Loader();  ///< waits until the file that is being read has been

    void load(LoadRequest request);
    std::optional<LoadResult> take();
    bool busy() const;
    /// Share of a series that has been looked through; 0 where none is.
    double looked_through() const { return looked_through_.load(); }
    /// Loads the frame as it is instead.
    void stop_looking() { stop_ = true; }

  private:
    void run();
    bool look_through(LoadRequest& request);

    std::function<void()> done_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<LoadRequest> waiting_;
    std::optional<LoadResult> result_;
    bool running_ = false;
    bool ending_ = false;
    std::atomic<bool> stop_ = false;
    std::atomic<double> looked_through_ = 0.0;
    std::thread thread_;
};

}  // namespace inktrace::viewer

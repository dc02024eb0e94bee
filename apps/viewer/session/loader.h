#pragma once

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
};

/// What came of it: a renderer, or the reason why there is none.
struct LoadResult {
    LoadRequest request;
    std::shared_ptr<const Renderer> renderer;
    std::vector<FileInfo> infos;
    std::size_t primitives = 0;
    std::string error;
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

  private:
    void run();

    std::function<void()> done_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<LoadRequest> waiting_;
    std::optional<LoadResult> result_;
    bool running_ = false;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace inktrace::viewer

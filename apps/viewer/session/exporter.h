#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "inktrace/inktrace.h"

namespace inktrace::viewer {

/// Renders one picture after the other into files, each on a thread of its own.
class Exporter {
  public:
    /// `news` is called from that thread when a file is written or refused.
    explicit Exporter(std::function<void()> news) : news_(std::move(news)) {}
    Exporter(const Exporter&) = delete;
    Exporter& operator=(const Exporter&) = delete;
    ~Exporter();  ///< gives up what is not finished

    struct Result {
        std::filesystem::path file;
        std::string error;  ///< empty: it is written
    };
    /// False while another one is being written.
    bool write(std::shared_ptr<const Renderer> renderer, Settings settings,
               std::filesystem::path file);
    std::optional<Result> take();
    bool busy() const { return busy_.load(); }
    double progress() const { return progress_.load(); }  ///< in [0, 1]

  private:
    void end();

    std::function<void()> news_;
    std::atomic<bool> cancel_ = false;
    std::atomic<bool> busy_ = false;
    std::atomic<double> progress_ = 0.0;
    std::mutex mutex_;
    std::optional<Result> result_;
    std::thread thread_;
};

}  // namespace inktrace::viewer

#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace inktrace::viewer {

/// Tells when one of some files is written, replaced or removed. It sleeps in the kernel until then
/// (inotify), so it costs nothing; changes that another machine makes to a network folder go
/// unnoticed.
class FileWatcher {
  public:
    /// `changed` is called from a thread of the watcher's, once things have been quiet for a
    /// moment.
    explicit FileWatcher(std::function<void()> changed);
    FileWatcher(const FileWatcher&) = delete;
    FileWatcher& operator=(const FileWatcher&) = delete;
    ~FileWatcher();

    /// Watches these files, and no others any more. A name may hold * and ?. Of a folder, all that
    /// is in it is watched.
    void watch(const std::vector<std::filesystem::path>& files);

  private:
    void add(const std::filesystem::path& folder, std::string pattern);
    void add_archive(const std::filesystem::path& folder);
    void run();
    bool drain();

    struct Watched {
        int folder;  ///< inotify's number
        std::string pattern;
    };
    std::function<void()> changed_;
    int inotify_ = -1;
    int stop_ = -1;
    std::mutex mutex_;
    std::vector<Watched> watched_;
    std::vector<int> folders_;
    std::thread thread_;
};

}  // namespace inktrace::viewer

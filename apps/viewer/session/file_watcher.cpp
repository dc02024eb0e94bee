#include "session/file_watcher.h"

#include <fnmatch.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <utility>

namespace inktrace::viewer {

FileWatcher::FileWatcher(std::function<void()> changed)
    : changed_(std::move(changed)),
      inotify_(inotify_init1(IN_CLOEXEC | IN_NONBLOCK)),
      stop_(eventfd(0, EFD_CLOEXEC)) {
    if (inotify_ >= 0 && stop_ >= 0) thread_ = std::thread([this] { run(); });
}

FileWatcher::~FileWatcher() {
    if (thread_.joinable()) {
        const std::uint64_t one = 1;
        if (write(stop_, &one, sizeof one) == sizeof one) thread_.join();
    }
    for (const int handle : {inotify_, stop_}) {
        if (handle >= 0) close(handle);
    }
}

void FileWatcher::watch(const std::vector<std::filesystem::path>& files) {
    if (inotify_ < 0) return;
    const std::scoped_lock lock(mutex_);
    for (const int folder : folders_) inotify_rm_watch(inotify_, folder);
    folders_.clear();
    watched_.clear();
    for (std::filesystem::path file : files) {
        if (!file.has_filename()) file = file.parent_path();  // "run.uda/"
        // The folder, not the file: programs replace files by renaming others.
        add(file.has_parent_path() ? file.parent_path() : ".", file.filename().string());
        std::error_code failure;
        if (std::filesystem::is_directory(file, failure)) add_archive(file);
    }
}

void FileWatcher::add(const std::filesystem::path& folder, std::string pattern) {
    const int number =
        inotify_add_watch(inotify_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVE | IN_DELETE);
    if (number < 0) return;
    watched_.push_back({number, std::move(pattern)});
    if (std::ranges::find(folders_, number) == folders_.end()) folders_.push_back(number);
}

/// Whatever changes in a folder that is read as one file, or in the folders below it. The kernel
/// does not watch any number of them; a step that is added to an archive changes its topmost
/// folder.
void FileWatcher::add_archive(const std::filesystem::path& folder) {
    constexpr std::size_t kMostFolders = 1000;
    add(folder, "*");
    std::error_code failure;
    std::filesystem::recursive_directory_iterator entry(folder, failure);
    for (; !failure && entry != std::filesystem::recursive_directory_iterator();
         entry.increment(failure)) {
        if (folders_.size() >= kMostFolders) return;
        std::error_code unreadable;
        if (entry->is_directory(unreadable)) add(entry->path(), "*");
    }
}

/// Reads what has happened; whether any of it concerns a watched file.
bool FileWatcher::drain() {
    alignas(inotify_event) std::array<char, 16384> buffer{};
    bool concerned = false;
    for (;;) {
        const ssize_t size = read(inotify_, buffer.data(), buffer.size());
        if (size <= 0) return concerned;
        const std::scoped_lock lock(mutex_);
        for (ssize_t at = 0; at < size;) {
            inotify_event event{};
            std::memcpy(&event, buffer.data() + at, sizeof event);
            const char* const name = buffer.data() + at + sizeof event;
            for (const Watched& file : watched_) {
                concerned |= event.len > 0 && file.folder == event.wd &&
                             (file.pattern == name || fnmatch(file.pattern.c_str(), name, 0) == 0);
            }
            at += static_cast<ssize_t>(sizeof event + event.len);
        }
    }
}

void FileWatcher::run() {
    constexpr int kForever = -1;
    constexpr int kQuiet = 150;  // ms: a program that writes may close and open a file again
    bool pending = false;
    for (;;) {
        std::array<pollfd, 2> handles{{{inotify_, POLLIN, 0}, {stop_, POLLIN, 0}}};
        const int ready = poll(handles.data(), handles.size(), pending ? kQuiet : kForever);
        if ((handles[1].revents & POLLIN) != 0) return;
        if (ready == 0 && pending) {
            pending = false;
            changed_();
        }
        if ((handles[0].revents & POLLIN) != 0 && drain()) pending = true;
    }
}

}  // namespace inktrace::viewer

#include "io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace ink {

namespace fs = std::filesystem;

namespace {

/// The path of a file in work, in memory that a signal handler may read at any moment.
struct UnfinishedFile {
    enum State : int { kFree, kChanging, kListed };
    std::atomic<int> state = kFree;
    std::array<char, PATH_MAX> path{};
};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not wait for a lock");

// More files than a run writes at once. One that finds no room is written all the same; only a
// signal leaves it behind.
std::array<UnfinishedFile, 64> unfinished_files;

void list_unfinished(const fs::path& file) noexcept {
    if (file.native().size() >= PATH_MAX) return;
    for (UnfinishedFile& entry : unfinished_files) {
        int expected = UnfinishedFile::kFree;
        if (!entry.state.compare_exchange_strong(expected, UnfinishedFile::kChanging)) continue;
        std::memcpy(entry.path.data(), file.c_str(), file.native().size() + 1);
        entry.state = UnfinishedFile::kListed;
        return;
    }
}

void unlist_unfinished(const fs::path& file) noexcept {
    for (UnfinishedFile& entry : unfinished_files) {
        if (entry.state == UnfinishedFile::kListed && file.native() == entry.path.data()) {
            entry.state = UnfinishedFile::kFree;
            return;
        }
    }
}

class Descriptor {
  public:
    Descriptor(const fs::path& file, int flags) : fd_(::open(file.c_str(), flags | O_CLOEXEC)) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (is_open()) ::close(fd_);
    }
    bool is_open() const { return fd_ >= 0; }
    int get() const { return fd_; }

  private:
    int fd_;
};

std::string problem_and_remedy(int error) {
    switch (error) {
        case ENOSPC: return "no space left on device; free some or choose another folder";
        case EDQUOT: return "disk quota exceeded; free some space or choose another folder";
        case EFBIG:
            return "larger than a file may be here; see `ulimit -f`, or choose another disk";
        case EACCES:
        case EPERM: return "permission denied; change the permissions or choose another folder";
        case EROFS: return "the file system is read-only; choose another folder";
        case ENAMETOOLONG: return "the name is too long; choose a shorter one";
        default: return std::generic_category().message(error) + "; choose another folder";
    }
}

std::string folder_problem(const fs::path& folder, int error) {
    switch (error) {
        case ENOENT:
            return fmt::format("the folder '{}' does not exist; create it or choose another",
                               folder.string());
        case ENOTDIR:
            return fmt::format("'{}' is not a folder; choose another place", folder.string());
        default:
            return fmt::format("cannot write in the folder '{}': {}", folder.string(),
                               problem_and_remedy(error));
    }
}

fs::file_status checked_status(const fs::path& destination) {
    std::error_code failure;
    const fs::file_status status = fs::status(destination, failure);
    if (fs::is_directory(status) || !destination.has_filename())
        throw OutputError(destination, "names a folder, not a file; add a file name");
    if (!fs::status_known(status)) throw write_error(destination, failure.value());
    // Renaming needs no leave to write the file itself, but who took it away meant to keep it.
    if (fs::exists(status) && ::faccessat(AT_FDCWD, destination.c_str(), W_OK, AT_EACCESS) != 0)
        throw write_error(destination, errno);
    return status;
}

/// Where a write to `file` would end; the last link may point to a file yet to be made.
fs::path follow_links(const fs::path& file) {
    fs::path place = fs::absolute(file);
    std::error_code failure;
    constexpr int kMaxLinks = 40;  // what the kernel allows in one path
    for (int i = 0; i < kMaxLinks && fs::is_symlink(fs::symlink_status(place, failure)); ++i) {
        const fs::path target = fs::read_symlink(place, failure);
        if (failure) break;
        place = place.parent_path() / target;
    }
    return place;
}

fs::path folder_for_temporary_files() {
    std::error_code failure;
    const fs::path folder = fs::temp_directory_path(failure);
    return failure ? fs::path("/tmp") : folder;
}

/// Hidden, and short whatever the length of the final name.
std::string temporary_name() {
    static std::atomic<unsigned> counter = 0;
    return fmt::format(".inktrace-{}-{}.tmp", ::getpid(), counter++);
}

/// An errno value, or 0. Some disks, remote ones above all, report that they are full only here.
int flush_to_disk(const fs::path& file) {
    const Descriptor written(file, O_RDONLY);
    if (!written.is_open()) return errno;
    if (::fsync(written.get()) == 0) return 0;
    const bool cannot_flush = errno == EINVAL || errno == EROFS || errno == ENOSYS;
    return cannot_flush ? 0 : errno;
}

/// An errno value, or 0.
int replace_file(const fs::path& written, const fs::path& place) {
    if (const int error = flush_to_disk(written); error != 0) return error;
    return std::rename(written.c_str(), place.c_str()) == 0 ? 0 : errno;
}

/// An errno value, or 0.
int write_all(int fd, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(fd, bytes.data(), bytes.size());
        if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
        if (count < 0 && errno != EINTR) return errno;
    }
    return 0;
}

/// An errno value, or 0.
int copy_to_stream(const fs::path& written, const fs::path& stream) {
    const Descriptor from(written, O_RDONLY);
    if (!from.is_open()) return errno;
    const Descriptor to(stream, O_WRONLY);
    if (!to.is_open()) return errno;
    std::array<char, 1 << 16> buffer{};
    for (;;) {
        const ssize_t count = ::read(from.get(), buffer.data(), buffer.size());
        if (count == 0) return 0;
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return errno;
        const std::string_view bytes(buffer.data(), static_cast<std::size_t>(count));
        if (const int error = write_all(to.get(), bytes); error != 0) return error;
    }
}

}  // namespace

OutputError write_error(const fs::path& file, int error) {
    return {file, problem_and_remedy(error)};
}

AtomicFile::AtomicFile(fs::path destination) : destination_(std::move(destination)) {
    const fs::file_status status = checked_status(destination_);
    is_stream_ = fs::exists(status) && !fs::is_regular_file(status);
    place_ = is_stream_ ? fs::absolute(destination_) : follow_links(destination_);
    create_temporary(is_stream_ ? folder_for_temporary_files() : place_.parent_path());
    if (fs::is_regular_file(status)) {
        std::error_code ignored;
        fs::permissions(temporary_, status.permissions(), ignored);
    }
}

void AtomicFile::create_temporary(const fs::path& folder) {
    for (;;) {
        temporary_ = folder / temporary_name();
        // Before it exists, so that no signal can come in between.
        list_unfinished(temporary_);
        constexpr mode_t kReadWriteForAll = 0666;  // less the umask
        const int flags = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC;
        const int fd = ::open(temporary_.c_str(), flags, kReadWriteForAll);
        if (fd >= 0) {
            ::close(fd);
            return;
        }
        const int error = errno;
        unlist_unfinished(temporary_);
        // A process that was killed may have left this name behind.
        if (error != EEXIST) throw OutputError(destination_, folder_problem(folder, error));
    }
}

void AtomicFile::remove_temporary() noexcept {
    ::unlink(temporary_.c_str());
    unlist_unfinished(temporary_);
    temporary_.clear();
}

AtomicFile::~AtomicFile() {
    if (!temporary_.empty()) remove_temporary();
}

void AtomicFile::commit() {
    const int error =
        is_stream_ ? copy_to_stream(temporary_, place_) : replace_file(temporary_, place_);
    if (error != 0) throw write_error(destination_, error);
    // After a rename nothing is left under the old name.
    remove_temporary();
}

void AtomicFile::remove_unfinished() noexcept {
    for (const UnfinishedFile& entry : unfinished_files) {
        if (entry.state == UnfinishedFile::kListed) ::unlink(entry.path.data());
    }
}

}  // namespace ink

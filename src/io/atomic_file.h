#pragma once

#include <filesystem>

#include "base/error.h"

namespace ink {

/// A file that appears whole or not at all: written beside its place, then renamed.
///
/// Symbolic links are followed, and a file that is replaced keeps its permissions. A pipe or a
/// device such as /dev/stdout cannot be replaced: what is written goes to the folder for temporary
/// files first and `commit` copies it.
class AtomicFile {
  public:
    /// Throws OutputError where the folder is missing or not writable, or the destination is a
    /// folder or read-only. To know that before a long computation, make one and drop it.
    explicit AtomicFile(std::filesystem::path destination);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    /// Removes what was written unless `commit` was called.
    ~AtomicFile();

    /// Where to write: an empty file that exists already.
    const std::filesystem::path& path() const { return temporary_; }
    /// Moves the finished file to its place. Throws OutputError.
    void commit();

    /// Removes every unfinished file of the process; safe to call from a signal handler.
    static void remove_unfinished() noexcept;

  private:
    void create_temporary(const std::filesystem::path& folder);
    void remove_temporary() noexcept;

    std::filesystem::path destination_;  ///< as the user named it, for messages
    std::filesystem::path place_;        ///< the same, absolute and with links followed
    std::filesystem::path temporary_;    ///< empty once committed
    bool is_stream_ = false;
};

/// What to throw when writing `file` failed with this `errno` value.
OutputError write_error(const std::filesystem::path& file, int error);

}  // namespace ink

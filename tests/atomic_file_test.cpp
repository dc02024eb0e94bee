#include "io/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "output_error.h"
#include "test_files.h"

namespace ink {
namespace {

namespace fs = std::filesystem;
using test::Names;
using test::names_in;
using test::output_error;
using test::read_bytes;
using test::TemporaryFolder;

/// Where the tests run as root, whom no permission stops, somebody else for a while.
class OrdinaryUser {
  public:
    OrdinaryUser() {
        if (is_root_) change_user(kNobody);
    }
    OrdinaryUser(const OrdinaryUser&) = delete;
    OrdinaryUser& operator=(const OrdinaryUser&) = delete;
    ~OrdinaryUser() {
        if (is_root_) change_user(0);
    }

  private:
    static void change_user(uid_t user) { EXPECT_EQ(seteuid(user), 0); }

    static constexpr uid_t kNobody = 65534;
    bool is_root_ = getuid() == 0;
};

void fill(const AtomicFile& file, std::string_view text) {
    std::ofstream(file.path(), std::ios::binary) << text;
}

TEST(AtomicFile, AppearsWholeOrNotAtAll) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.txt";
    {
        AtomicFile output(file);
        fill(output, "whole");
        EXPECT_FALSE(fs::exists(file));
        EXPECT_EQ(output.path().parent_path(), folder.path());
        output.commit();
        EXPECT_EQ(read_bytes(file), "whole");
    }
    EXPECT_EQ(names_in(folder.path()), Names{"a.txt"});
}

TEST(AtomicFile, LeavesTheOldFileWhenItIsNotCommitted) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a.txt", "old");
    fill(AtomicFile(file), "new");
    EXPECT_EQ(read_bytes(file), "old");
    EXPECT_EQ(names_in(folder.path()), Names{"a.txt"});
}

TEST(AtomicFile, KeepsThePermissionsOfTheFileItReplaces) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a.txt", "old");
    const auto mode = fs::perms::owner_read | fs::perms::owner_write | fs::perms::others_read;
    fs::permissions(file, mode);
    AtomicFile output(file);
    fill(output, "new");
    output.commit();
    EXPECT_EQ(read_bytes(file), "new");
    EXPECT_EQ(fs::status(file).permissions(), mode);
}

TEST(AtomicFile, WritesToTheTargetOfASymbolicLink) {
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / "real");
    fs::create_symlink("real/a.txt", folder.path() / "link");
    fs::create_symlink("link", folder.path() / "link to link");
    // The target does not exist in the first round and does in the second.
    for (const std::string text : {"first", "second"}) {
        AtomicFile output(folder.path() / "link to link");
        fill(output, text);
        output.commit();
        EXPECT_EQ(read_bytes(folder.path() / "real" / "a.txt"), text);
        EXPECT_TRUE(fs::is_symlink(folder.path() / "link to link"));
        EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
    }
}

TEST(AtomicFile, CopiesIntoAPipe) {
    const TemporaryFolder folder;
    const fs::path pipe = folder.path() / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
    AtomicFile output(pipe);
    fill(output, "through");
    output.commit();
    std::array<char, 16> bytes{};
    EXPECT_EQ(::read(reader, bytes.data(), bytes.size()), 7);
    EXPECT_STREQ(bytes.data(), "through");
    ::close(reader);
    EXPECT_TRUE(fs::is_fifo(pipe));
    EXPECT_FALSE(fs::exists(output.path()));
}

TEST(AtomicFile, GoesByTheFolderItWasMadeIn) {
    const TemporaryFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    AtomicFile output("a.txt");
    fs::current_path(before);
    fill(output, "here");
    output.commit();
    EXPECT_EQ(read_bytes(folder.path() / "a.txt"), "here");
}

TEST(AtomicFile, NamesTheMissingFolder) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "no" / "a.txt";
    EXPECT_EQ(output_error([&] { AtomicFile{file}; }),
              file.string() + ": the folder '" + (folder.path() / "no").string() +
                  "' does not exist; create it or choose another");
    EXPECT_EQ(names_in(folder.path()), Names{});
}

TEST(AtomicFile, RefusesAPlaceBelowAFile) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a.txt", "");
    EXPECT_EQ(output_error([&] { AtomicFile{file / "b.txt"}; }),
              (file / "b.txt").string() + ": '" + file.string() +
                  "' is not a folder; choose another place");
}

TEST(AtomicFile, RefusesAFolder) {
    const TemporaryFolder folder;
    for (const fs::path& file : {folder.path(), folder.path() / "", fs::path()}) {
        EXPECT_EQ(output_error([&] { AtomicFile{file}; }),
                  file.string() + ": names a folder, not a file; add a file name");
    }
}

TEST(AtomicFile, RefusesAFolderWithoutPermission) {
    const TemporaryFolder folder;
    fs::permissions(folder.path(), fs::perms(0555));
    const OrdinaryUser user;
    EXPECT_EQ(output_error([&] { AtomicFile{folder.path() / "a.txt"}; }),
              (folder.path() / "a.txt").string() + ": cannot write in the folder '" +
                  folder.path().string() +
                  "': permission denied; change the permissions or choose another folder");
}

TEST(AtomicFile, RefusesAReadOnlyFileThatItCouldReplace) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a.txt", "precious");
    fs::permissions(folder.path(), fs::perms(0777));
    fs::permissions(file, fs::perms(0444));
    const OrdinaryUser user;
    EXPECT_EQ(
        output_error([&] { AtomicFile{file}; }),
        file.string() + ": permission denied; change the permissions or choose another folder");
}

TEST(AtomicFile, RefusesANameThatIsTooLong) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / std::string(300, 'x');
    EXPECT_EQ(output_error([&] { AtomicFile{file}; }),
              file.string() + ": the name is too long; choose a shorter one");
    EXPECT_NO_THROW(AtomicFile{folder.path() / std::string(255, 'x')}.commit());
}

TEST(AtomicFile, IsRemovedFromASignalHandler) {
    const TemporaryFolder folder;
    const auto interrupt = [&] {
        // More than can be listed at once in all; those that were finished made room again.
        for (int i = 0; i < 100; ++i) AtomicFile(folder.path() / "done").commit();
        const AtomicFile first(folder.path() / "a.txt");
        const AtomicFile second(folder.path() / "b.txt");
        fill(first, "half");
        std::signal(SIGINT, [](int) {
            AtomicFile::remove_unfinished();
            _exit(130);
        });
        std::raise(SIGINT);
    };
    EXPECT_EXIT(interrupt(), testing::ExitedWithCode(130), "");
    EXPECT_EQ(names_in(folder.path()), Names{"done"});
}

TEST(AtomicFile, PassesByWhatAKilledNamesakeLeftBehind) {
    const TemporaryFolder folder;
    std::string next;
    {
        // Names count upwards, so the one after this is the one the next file would like.
        const AtomicFile output(folder.path() / "a.txt");
        const std::string stem = output.path().stem().string();
        const std::size_t dash = stem.rfind('-') + 1;
        next = stem.substr(0, dash) + std::to_string(std::stoul(stem.substr(dash)) + 1) + ".tmp";
    }
    folder.write(next, "left behind");
    AtomicFile output(folder.path() / "a.txt");
    EXPECT_NE(output.path().filename(), next);
    output.commit();
    EXPECT_EQ(read_bytes(folder.path() / next), "left behind");
}

}  // namespace
}  // namespace ink

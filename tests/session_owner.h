#pragma once

// What the tests of the viewer's session share.

#include <gtest/gtest.h>
#include <png.h>
#include <sys/wait.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "paths.h"
#include "session/command_line.h"
#include "session/waiting_owner.h"
#include "test_files.h"

namespace inktrace::viewer::test {

namespace fs = std::filesystem;
using ink::Vec3d;
using ink::test::TemporaryFolder;

inline constexpr std::string_view kPdb =
    "ATOM      1  N   ALA A   7      -2.000   0.000   0.000  1.00 10.50           N  \n"
    "ATOM      2  CA  ALA A   7       2.000   0.000   0.000  1.00 20.25           C  \n"
    "END\n";
inline constexpr std::string_view kFrames =
    "2\nfirst\nC 0 0 0\nO 0 1.2 0\n"
    "2\nsecond\nC 0 0 0\nO 0 2.2 0\n"
    "2\nthird\nC 0 0 0\nO 0 3.2 0\n";

class Owner : public WaitingOwner {
  public:
    /// False if it takes a minute.
    bool wait_for(const std::function<bool()>& done) {
        return wait_until(done, std::chrono::minutes(1));
    }
    bool wait_for_picture() {
        return wait_for([this] { return has_picture(); });
    }
    void open(const std::vector<fs::path>& files) {
        session.open(files);
        session.resize({120, 90});
    }
};

inline std::vector<std::uint8_t> bytes(const Picture& picture) {
    return {picture.rgba().begin(), picture.rgba().end()};
}

inline std::vector<std::uint8_t> read_png(const fs::path& file) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&image, file.c_str()) == 0) return {};
    image.format = PNG_FORMAT_RGBA;
    std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
    if (png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) == 0) return {};
    return pixels;
}

/// Runs a command line of the session with the program that was built; its exit status.
inline int run(std::string command, const fs::path& folder) {
    const std::string_view name = "inktrace ";
    EXPECT_TRUE(command.starts_with(name));
    command = "cd " + shell_quoted(folder.string()) + " && " +
              shell_quoted(ink::test::program().string()) + command.substr(name.size() - 1) +
              " --quiet";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline fs::path sample() { return ink::test::source_dir() / "samples/acetaminophen.xyz"; }

}  // namespace inktrace::viewer::test

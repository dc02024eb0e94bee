// Any bytes must give a valid scene or an InputError: no crash, no hang, no unbounded memory.

#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "io/reader.h"

namespace {

/// A file of this process in memory, where the system has such a folder: no disk in the loop.
std::filesystem::path scratch_file() {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder =
        std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    return folder / ("inktrace-fuzz-" + std::to_string(getpid()) + "." EXTENSION);
}

const std::filesystem::path& file() {
    static const std::filesystem::path kFile = [] {
        std::atexit([] { std::filesystem::remove(scratch_file()); });
        return scratch_file();
    }();
    return kFile;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::ofstream(file(), std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        ink::ReadOptions options;
        options.summarize = true;
        options.data.representation = ink::Representation::ball_and_stick;
        const ink::Scene scene(ink::read_file(file(), options).objects);
        if (scene.primitive_count() == 0) __builtin_trap();
        const ink::Bounds3f& box = scene.bounds();
        if (!std::isfinite(ink::length(box.extent()))) __builtin_trap();
    } catch (const ink::InputError&) {
    }
    return 0;
}

// Any bytes must give a valid scene or an InputError: no crash, no hang, no unbounded memory.

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "io/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::filesystem::path kFile =
        std::filesystem::temp_directory_path() /
        ("inktrace-fuzz-" + std::to_string(getpid()) + "." EXTENSION);
    std::ofstream(kFile, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        const ink::Scene scene(ink::read_file(kFile).objects);
        if (scene.primitive_count() == 0) __builtin_trap();
    } catch (const ink::InputError&) {
    }
    return 0;
}

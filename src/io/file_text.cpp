#include "io/file_text.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>

#include "base/error.h"
#include "base/memory.h"

namespace ink {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;
/// At most so much is asked of zlib at once. More than twice its buffer goes straight to its place.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 28;
/// What is made of a text takes about as much again; what is less is left to luck.
constexpr double kShareOfText = 1.5;

struct GzClose {
    void operator()(gzFile handle) const { gzclose(handle); }
};
using GzHandle = std::unique_ptr<gzFile_s, GzClose>;

/// zlib copies a file that is not gzipped as it is.
GzHandle open(const std::filesystem::path& file) {
    GzHandle handle(gzopen(file.c_str(), "rb"));
    if (!handle) {
        throw InputError(file, fmt::format("cannot be opened ({}); check its permissions",
                                           std::strerror(errno)));
    }
    gzbuffer(handle.get(), kChunk);
    return handle;
}

[[noreturn]] void throw_read_error(const std::filesystem::path& file, gzFile handle) {
    int code = Z_OK;
    const std::string reason = gzerror(handle, &code);
    if (code == Z_ERRNO) {
        throw InputError(file,
                         fmt::format("cannot be read ({}); check the disk", std::strerror(errno)));
    }
    throw InputError(file,
                     fmt::format("the compressed data are damaged ({}); copy or download it again",
                                 reason.substr(reason.rfind(": ") + 1)));
}

/// Room for a file of this many bytes on disk and one more, to notice its end.
std::size_t first_capacity(const std::filesystem::path& file, std::size_t limit) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) return kChunk;
    const auto bytes = static_cast<std::size_t>(std::min<std::uintmax_t>(size, limit));
    check_memory(file, bytes);
    return bytes + 1;
}

}  // namespace

void check_memory(const std::filesystem::path& file, std::size_t bytes) {
    constexpr std::size_t kSmall = std::size_t{64} << 20;
    if (bytes < kSmall) return;
    const double needed = kShareOfText * static_cast<double>(bytes);
    const double free = free_memory_bytes();
    if (needed <= free) return;
    throw InputError(file, fmt::format("needs at least {:.2g} GB of memory to be read, but {:.2g} "
                                       "GB are free; split it, or use a larger machine",
                                       needed * 1e-9, free * 1e-9));
}

std::string read_text(const std::filesystem::path& file, std::size_t limit) {
    const GzHandle handle = open(file);
    std::string text;
    const auto grow = [&](std::size_t bytes) {
        reserve_large(text, bytes);
        text.resize(bytes);
    };
    grow(first_capacity(file, limit));
    std::size_t size = 0;
    for (;;) {
        if (size == text.size()) {
            const std::size_t more = std::min(2 * text.size() + kChunk, limit + 1);
            check_memory(file, more);
            grow(more);
        }
        const auto room = static_cast<unsigned>(std::min(text.size() - size, kMostAtOnce));
        const int got = gzread(handle.get(), text.data() + size, room);
        if (got < 0) throw_read_error(file, handle.get());
        if (got == 0) break;
        size += static_cast<std::size_t>(got);
        if (size > limit) {
            throw InputError(file, fmt::format("holds more than {} MB of text; split it or keep "
                                               "only the part to be drawn",
                                               limit >> 20));
        }
    }
    int code = Z_OK;
    gzerror(handle.get(), &code);
    if (code != Z_OK) {
        throw InputError(file, "the compressed data end too early; copy or download it again");
    }
    text.resize(size);
    return text;
}

std::string excerpt(std::string_view text) {
    constexpr std::size_t kLongest = 40;
    std::string shown(text.substr(0, kLongest));
    std::ranges::replace_if(
        shown, [](char c) { return c < ' ' || c > '~'; }, '?');
    return fmt::format("'{}{}'", shown, text.size() > kLongest ? "..." : "");
}

}  // namespace ink

#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "base/image.h"

namespace ink {

static_assert(std::endian::native == std::endian::little,
              "DisplayImage::pixels are handed to the libraries as R, G, B, A bytes");

/// The way into a file for C libraries, through which no exception may pass: the first failure is
/// kept, and what is written after it is dropped.
class ByteSink {
  public:
    explicit ByteSink(const std::filesystem::path& file) noexcept;
    /// Takes over an open stream; null is a failure that `errno` explains.
    explicit ByteSink(std::FILE* stream) noexcept;

    void write(const void* bytes, std::size_t count) noexcept;
    /// `origin` as for fseek.
    void seek(std::int64_t offset, int origin) noexcept;
    std::uint64_t position() noexcept;
    /// To be called before `error` can say that all is well.
    void close() noexcept;
    /// The errno value of the first failure, or 0.
    int error() const noexcept { return error_; }

  private:
    struct Close {
        void operator()(std::FILE* file) const noexcept { std::fclose(file); }
    };
    std::unique_ptr<std::FILE, Close> file_;
    int error_ = 0;
};

/// A library refused the picture; the message is its reason.
struct EncodeError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Each throws EncodeError; whether the bytes arrived is for the caller to ask the sink. The same
// arguments give the same bytes.
void encode_png(ByteSink& sink, const DisplayImage& image, double dpi, const Metadata& metadata);
void encode_jpeg(ByteSink& sink, const DisplayImage& image, double dpi, const Metadata& metadata);
void encode_tiff(ByteSink& sink, const DisplayImage& image, double dpi, const Metadata& metadata);
void encode_exr(ByteSink& sink, const ChannelImage& image, double dpi, const Metadata& metadata);

/// Lets `encode` write a file that appears whole or not at all. Throws OutputError.
void write_whole(const std::filesystem::path& file, const std::function<void(ByteSink&)>& encode);

/// A PNG as it would be in a file.
std::string png_bytes(const DisplayImage& image, double dpi);

bool is_opaque(const DisplayImage& image);

/// "Software: Inktrace 0.1.0\nScene: ...", for formats that have one text only.
std::string as_text(const Metadata& metadata);

}  // namespace ink

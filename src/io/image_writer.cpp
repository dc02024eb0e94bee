#include "io/image_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <memory>
#include <new>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "io/atomic_file.h"
#include "io/image_writers.h"

namespace ink {

ByteSink::ByteSink(const std::filesystem::path& file) noexcept
    : file_(std::fopen(file.c_str(), "wb")) {
    if (!file_) error_ = errno;
}

ByteSink::ByteSink(std::FILE* stream) noexcept : file_(stream) {
    if (!file_) error_ = errno;
}

void ByteSink::write(const void* bytes, std::size_t count) noexcept {
    if (error_ == 0 && std::fwrite(bytes, 1, count, file_.get()) != count) error_ = errno;
}

void ByteSink::seek(std::int64_t offset, int origin) noexcept {
    if (error_ == 0 && ::fseeko(file_.get(), offset, origin) != 0) error_ = errno;
}

std::uint64_t ByteSink::position() noexcept {
    if (error_ != 0) return 0;
    const off_t position = ::ftello(file_.get());
    if (position < 0) error_ = errno;
    return position < 0 ? 0 : static_cast<std::uint64_t>(position);
}

void ByteSink::close() noexcept {
    if (file_ && std::fclose(file_.release()) != 0 && error_ == 0) error_ = errno;
}

bool is_opaque(const DisplayImage& image) {
    return std::all_of(image.pixels.begin(), image.pixels.end(),
                       [](std::uint32_t pixel) { return pixel >> 24U == 255; });
}

std::string as_text(const Metadata& metadata) {
    std::string text;
    for (const auto& [key, value] : metadata) {
        if (!text.empty()) text += '\n';
        text.append(key).append(": ").append(value);
    }
    return text;
}

void write_whole(const std::filesystem::path& file, const std::function<void(ByteSink&)>& encode) {
    AtomicFile output(file);
    ByteSink sink(output.path());
    try {
        encode(sink);
    } catch (const EncodeError& refusal) {
        // A library that noticed the disk is full knows less about it than the sink does.
        if (sink.error() == 0) {
            throw OutputError(file, fmt::format("{}; try another size or format", refusal.what()));
        }
    }
    sink.close();
    if (sink.error() != 0) throw write_error(file, sink.error());
    output.commit();
}

std::string png_bytes(const DisplayImage& image, double dpi) {
    char* bytes = nullptr;
    std::size_t count = 0;
    ByteSink sink(::open_memstream(&bytes, &count));
    const std::unique_ptr<char*, void (*)(char**)> owner(&bytes, [](char** p) { std::free(*p); });
    encode_png(sink, image, dpi, {});
    sink.close();
    if (sink.error() != 0) throw std::bad_alloc();
    return {bytes, count};
}

std::optional<ImageFormat> image_format(const std::filesystem::path& file) {
    static constexpr std::array<std::pair<std::string_view, ImageFormat>, 6> kExtensions{{
        {".png", ImageFormat::png},
        {".jpg", ImageFormat::jpeg},
        {".jpeg", ImageFormat::jpeg},
        {".tif", ImageFormat::tiff},
        {".tiff", ImageFormat::tiff},
        {".exr", ImageFormat::exr},
    }};
    const std::string extension = to_lower(file.extension().string());
    for (const auto& [name, format] : kExtensions) {
        if (extension == name) return format;
    }
    return std::nullopt;
}

void write_image(const std::filesystem::path& file, ImageFormat format, const DisplayImage& image,
                 double dpi, const Metadata& metadata) {
    assert(image.pixels.size() == image.size.pixels());
    write_whole(file, [&](ByteSink& sink) {
        switch (format) {
            case ImageFormat::png: return encode_png(sink, image, dpi, metadata);
            case ImageFormat::jpeg: return encode_jpeg(sink, image, dpi, metadata);
            case ImageFormat::tiff: return encode_tiff(sink, image, dpi, metadata);
            case ImageFormat::exr: throw EncodeError("EXR takes channels, not 8-bit pixels");
        }
    });
}

void write_exr(const std::filesystem::path& file, const ChannelImage& image, double dpi,
               const Metadata& metadata) {
    write_whole(file, [&](ByteSink& sink) { encode_exr(sink, image, dpi, metadata); });
}

}  // namespace ink

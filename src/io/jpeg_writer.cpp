#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <string_view>
#include <vector>

// After <cstdio>: it uses FILE without declaring it.
#include <jpeglib.h>

#include "io/image_writers.h"

namespace ink {

namespace {

constexpr int kQuality = 95;

struct Errors {
    jpeg_error_mgr manager{};  ///< first, so that the library's pointer to it is one to this
    std::jmp_buf escape{};
    std::array<char, JMSG_LENGTH_MAX> message{};
};

[[noreturn]] void on_error(j_common_ptr jpeg) {
    auto& errors = *reinterpret_cast<Errors*>(jpeg->err);
    jpeg->err->format_message(jpeg, errors.message.data());
    std::longjmp(errors.escape, 1);
}

void on_message(j_common_ptr /*jpeg*/) {}

struct Destination {
    jpeg_destination_mgr manager{};  ///< first, as above
    ByteSink* sink = nullptr;
    std::array<JOCTET, 1 << 16> buffer{};
};

void empty_buffer(Destination& destination) {
    destination.manager.next_output_byte = destination.buffer.data();
    destination.manager.free_in_buffer = destination.buffer.size();
}

void on_start(j_compress_ptr jpeg) { empty_buffer(*reinterpret_cast<Destination*>(jpeg->dest)); }

boolean on_full_buffer(j_compress_ptr jpeg) {
    auto& destination = *reinterpret_cast<Destination*>(jpeg->dest);
    destination.sink->write(destination.buffer.data(), destination.buffer.size());
    empty_buffer(destination);
    return TRUE;
}

void on_end(j_compress_ptr jpeg) {
    auto& destination = *reinterpret_cast<Destination*>(jpeg->dest);
    destination.sink->write(destination.buffer.data(),
                            destination.buffer.size() - destination.manager.free_in_buffer);
}

struct Writer {
    jpeg_compress_struct jpeg{};
    Errors errors;
    Destination destination;

    explicit Writer(ByteSink& sink) {
        jpeg.err = jpeg_std_error(&errors.manager);
        errors.manager.error_exit = on_error;
        errors.manager.output_message = on_message;
        destination.sink = &sink;
        destination.manager.init_destination = on_start;
        destination.manager.empty_output_buffer = on_full_buffer;
        destination.manager.term_destination = on_end;
    }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer() { jpeg_destroy_compress(&jpeg); }
};

void start(jpeg_compress_struct& jpeg, Size size, double dpi) {
    jpeg.image_width = static_cast<JDIMENSION>(size.width);
    jpeg.image_height = static_cast<JDIMENSION>(size.height);
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, kQuality, TRUE);
    // Halved chroma would fringe the lines.
    jpeg.comp_info[0].h_samp_factor = 1;
    jpeg.comp_info[0].v_samp_factor = 1;
    constexpr UINT8 kDotsPerInch = 1;
    jpeg.density_unit = kDotsPerInch;
    jpeg.X_density = static_cast<UINT16>(std::clamp(std::lround(dpi), 1L, 65535L));
    jpeg.Y_density = jpeg.X_density;
    jpeg_start_compress(&jpeg, TRUE);
}

void write_comment(jpeg_compress_struct& jpeg, std::string_view text) {
    constexpr std::size_t kMarkerBytes = 65533;  // a 16-bit length that counts itself
    while (!text.empty()) {
        const std::string_view part = text.substr(0, kMarkerBytes);
        jpeg_write_marker(&jpeg, JPEG_COM, reinterpret_cast<const JOCTET*>(part.data()),
                          static_cast<unsigned>(part.size()));
        text.remove_prefix(part.size());
    }
}

/// One channel of straight alpha over white, to the nearest.
JOCTET over_white(std::uint32_t channel, std::uint32_t alpha) {
    return static_cast<JOCTET>((channel * alpha + 255U * (255U - alpha) + 127U) / 255U);
}

void fill_row(std::vector<JOCTET>& row, const std::uint32_t* pixels) {
    for (std::size_t i = 0; i < row.size(); i += 3) {
        const std::uint32_t pixel = *pixels++;
        const std::uint32_t alpha = pixel >> 24U;
        row[i] = over_white(pixel & 0xFFU, alpha);
        row[i + 1] = over_white((pixel >> 8U) & 0xFFU, alpha);
        row[i + 2] = over_white((pixel >> 16U) & 0xFFU, alpha);
    }
}

/// False on failure. Owns nothing, and neither does what it calls: libjpeg jumps out of the middle.
bool write_all(Writer& writer, const DisplayImage& image, double dpi, std::string_view comment,
               std::vector<JOCTET>& row) {
    if (setjmp(writer.errors.escape) != 0) return false;
    jpeg_compress_struct& jpeg = writer.jpeg;
    jpeg_create_compress(&jpeg);
    jpeg.dest = &writer.destination.manager;
    start(jpeg, image.size, dpi);
    write_comment(jpeg, comment);
    while (jpeg.next_scanline < jpeg.image_height) {
        fill_row(row, image.pixels.data() + std::size_t{jpeg.next_scanline} * jpeg.image_width);
        JSAMPROW rows = row.data();
        jpeg_write_scanlines(&jpeg, &rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    return true;
}

}  // namespace

void encode_jpeg(ByteSink& sink, const DisplayImage& image, double dpi, const Metadata& metadata) {
    const std::string comment = as_text(metadata);
    std::vector<JOCTET> row(3 * static_cast<std::size_t>(image.size.width));
    Writer writer(sink);
    if (!write_all(writer, image, dpi, comment, row))
        throw EncodeError(std::string("JPEG: ") + writer.errors.message.data());
}

}  // namespace ink

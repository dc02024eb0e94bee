// compare_pictures EXPECTED ACTUAL DIFFERENCE: exits with 0 where two PNGs agree but for rounding:
// the mean difference of a channel is below 0.5 of 255 and fewer than 1 in 200 pixels differ by
// more than 16. Otherwise writes the difference, white on black, and exits with 1.

#include <png.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

struct Picture {
    png_image header{};
    std::vector<std::uint8_t> rgba;
};

Picture read(const char* file) {
    Picture picture;
    picture.header.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&picture.header, file) == 0) {
        std::fprintf(stderr, "%s: %s\n", file, picture.header.message);
        std::exit(1);
    }
    picture.header.format = PNG_FORMAT_RGBA;
    picture.rgba.resize(PNG_IMAGE_SIZE(picture.header));
    png_image_finish_read(&picture.header, nullptr, picture.rgba.data(), 0, nullptr);
    return picture;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) return 2;
    Picture expected = read(argv[1]);
    const Picture actual = read(argv[2]);
    if (expected.header.width != actual.header.width ||
        expected.header.height != actual.header.height) {
        std::fprintf(stderr, "sizes differ\n");
        return 1;
    }

    double sum = 0.0;
    std::size_t far_off = 0;
    for (std::size_t i = 0; i < actual.rgba.size(); i += 4) {
        int largest = 0;
        for (std::size_t k = i; k < i + 4; ++k) {
            const int difference = std::abs(expected.rgba[k] - actual.rgba[k]);
            sum += difference;
            largest = std::max(largest, difference);
        }
        far_off += largest > 16 ? 1 : 0;
        std::fill_n(expected.rgba.begin() + static_cast<std::ptrdiff_t>(i), 3,
                    static_cast<std::uint8_t>(largest));
        expected.rgba[i + 3] = 255;
    }
    const std::size_t pixels = actual.rgba.size() / 4;
    const double mean = sum / static_cast<double>(actual.rgba.size());
    std::printf("mean difference %.3f, pixels that differ by more than 16: %zu of %zu\n", mean,
                far_off, pixels);
    if (mean < 0.5 && far_off * 200 < pixels) return 0;
    png_image_write_to_file(&expected.header, argv[3], 0, expected.rgba.data(), 0, nullptr);
    std::printf("see %s\n", argv[3]);
    return 1;
}

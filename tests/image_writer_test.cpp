#include "io/image_writer.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <gtest/gtest.h>
#include <half.h>
#include <png.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <limits>
#include <memory>
#include <ostream>
#include <random>
#include <set>
#include <tuple>

// After <cstdio>: it uses FILE without declaring it.
#include <jpeglib.h>

#include "base/error.h"
#include "output_error.h"
#include "test_files.h"

namespace ink {

/// For names of tests; GoogleTest looks for it beside the type.
static void PrintTo(Size size, std::ostream* out) { *out << size.width << 'x' << size.height; }

namespace {

namespace fs = std::filesystem;
using test::Names;
using test::names_in;
using test::output_error;
using test::read_bytes;
using test::TemporaryFolder;

const Metadata kMetadata{{"Software", "Inktrace 0.1.0"}, {"Scene", "caffeine.sdf"}};
const std::string kMetadataText = "Software: Inktrace 0.1.0\nScene: caffeine.sdf";
constexpr double kDpi = 300;

std::uint32_t rgba(unsigned r, unsigned g, unsigned b, unsigned a = 255) {
    return r | g << 8U | b << 16U | a << 24U;
}

/// Every bit is chance, so that a mistake in order or stride cannot hide.
DisplayImage noise(Size size, bool opaque) {
    std::mt19937 generator(7);
    DisplayImage image{size, {}};
    for (std::size_t i = 0; i < size.pixels(); ++i) {
        const auto pixel = static_cast<std::uint32_t>(generator());
        image.pixels.push_back(opaque ? pixel | rgba(0, 0, 0, 255) : pixel & ~rgba(0, 0, 0, 1));
    }
    return image;
}

DisplayImage gradient(Size size) {
    DisplayImage image{size, {}};
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            image.pixels.push_back(rgba(static_cast<unsigned>(255 * x / size.width),
                                        static_cast<unsigned>(255 * y / size.height), 128));
        }
    }
    return image;
}

Pixels pixels_of(const std::vector<std::uint8_t>& bytes, int channels) {
    Pixels pixels;
    const auto step = static_cast<std::size_t>(channels);
    for (std::size_t i = 0; i < bytes.size(); i += step)
        pixels.push_back(
            rgba(bytes[i], bytes[i + 1], bytes[i + 2], channels == 4 ? bytes[i + 3] : 255U));
    return pixels;
}

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using Stream = std::unique_ptr<std::FILE, Close>;

/// What another program finds in a file.
struct Found {
    DisplayImage image;
    int channels = 0;
    double dpi = 0;
    Metadata texts;
    bool is_srgb = false;
    bool is_subsampled = false;
};

Found read_png(const fs::path& file) {
    const Stream stream(std::fopen(file.c_str(), "rb"));
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, stream.get());
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);

    Found found;
    found.channels = png_get_channels(png, info);
    found.image.size = {static_cast<int>(png_get_image_width(png, info)),
                        static_cast<int>(png_get_image_height(png, info))};
    found.dpi = png_get_x_pixels_per_meter(png, info) * 0.0254;
    found.is_srgb = png_get_valid(png, info, PNG_INFO_sRGB) != 0;
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < found.image.size.height; ++y) {
        const png_bytep row = png_get_rows(png, info)[y];
        bytes.insert(bytes.end(), row, row + png_get_rowbytes(png, info));
    }
    found.image.pixels = pixels_of(bytes, found.channels);
    png_textp texts = nullptr;
    const int count = png_get_text(png, info, &texts, nullptr);
    for (int i = 0; i < count; ++i) found.texts.emplace_back(texts[i].key, texts[i].text);
    png_destroy_read_struct(&png, &info, nullptr);
    return found;
}

Found read_jpeg(const fs::path& file) {
    const Stream stream(std::fopen(file.c_str(), "rb"));
    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_decompress(&jpeg);
    jpeg_stdio_src(&jpeg, stream.get());
    jpeg_save_markers(&jpeg, JPEG_COM, 0xFFFF);
    jpeg_read_header(&jpeg, TRUE);
    jpeg_start_decompress(&jpeg);

    Found found;
    found.channels = jpeg.output_components;
    found.image.size = {static_cast<int>(jpeg.output_width), static_cast<int>(jpeg.output_height)};
    found.dpi = jpeg.density_unit == 1 ? jpeg.X_density : 0;
    found.is_subsampled = jpeg.max_h_samp_factor != 1 || jpeg.max_v_samp_factor != 1;
    std::vector<std::uint8_t> bytes(3 * found.image.size.pixels());
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW row = bytes.data() + std::size_t{3} * jpeg.output_width * jpeg.output_scanline;
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    found.image.pixels = pixels_of(bytes, 3);
    for (auto* marker = jpeg.marker_list; marker != nullptr; marker = marker->next) {
        found.texts.emplace_back("Comment", std::string(reinterpret_cast<char*>(marker->data),
                                                        std::size_t{marker->data_length}));
    }
    jpeg_destroy_decompress(&jpeg);
    return found;
}

Found read_tiff(const fs::path& file) {
    const std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff(TIFFOpen(file.c_str(), "r"), &TIFFClose);
    Found found;
    std::uint16_t channels = 0;
    std::uint16_t unit = 0;
    float resolution = 0;
    const char* description = "";
    const char* software = "";
    TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &found.image.size.width);
    TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &found.image.size.height);
    TIFFGetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &channels);
    TIFFGetField(tiff.get(), TIFFTAG_XRESOLUTION, &resolution);
    TIFFGetField(tiff.get(), TIFFTAG_RESOLUTIONUNIT, &unit);
    TIFFGetField(tiff.get(), TIFFTAG_IMAGEDESCRIPTION, &description);
    TIFFGetField(tiff.get(), TIFFTAG_SOFTWARE, &software);
    found.channels = channels;
    found.dpi = unit == RESUNIT_INCH ? double{resolution} : 0;
    found.texts = {{"ImageDescription", description}, {"Software", software}};
    const auto row_bytes = static_cast<std::size_t>(TIFFScanlineSize(tiff.get()));
    const auto height = static_cast<std::uint32_t>(found.image.size.height);
    std::vector<std::uint8_t> bytes(row_bytes * height);
    for (std::uint32_t y = 0; y < height; ++y)
        TIFFReadScanline(tiff.get(), bytes.data() + y * row_bytes, y, 0);
    found.image.pixels = pixels_of(bytes, channels);
    return found;
}

double mean_error(const DisplayImage& a, const DisplayImage& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        for (unsigned shift = 0; shift < 24; shift += 8) {
            sum += std::abs(static_cast<double>((a.pixels[i] >> shift) & 0xFFU) -
                            static_cast<double>((b.pixels[i] >> shift) & 0xFFU));
        }
    }
    return sum / static_cast<double>(3 * a.pixels.size());
}

template <class T>
Plane<T> read_exr_plane(const fs::path& file, const char* name, Imf::PixelType type) {
    Imf::InputFile exr(file.c_str());
    const auto window = exr.header().dataWindow();
    const auto width = static_cast<std::size_t>(window.max.x + 1);
    Plane<T> values(width * static_cast<std::size_t>(window.max.y + 1));
    Imf::FrameBuffer frame;
    frame.insert(name, Imf::Slice(type, reinterpret_cast<char*>(values.data()), sizeof(T),
                                  sizeof(T) * width));
    exr.setFrameBuffer(frame);
    exr.readPixels(0, window.max.y);
    return values;
}

Plane<float> random_floats(std::size_t count, float from, float to) {
    std::mt19937 generator(11);
    std::uniform_real_distribution<float> value(from, to);
    Plane<float> values(count);
    std::generate(values.begin(), values.end(), [&] { return value(generator); });
    return values;
}

ChannelImage channel_image(Size size) {
    std::mt19937 generator(13);
    Plane<std::uint32_t> ids(size.pixels());
    std::generate(ids.begin(), ids.end(), [&] { return static_cast<std::uint32_t>(generator()); });
    Plane<float> depth = random_floats(size.pixels(), 1, 1e6F);
    depth.front() = std::numeric_limits<float>::infinity();
    return {size,
            {{"R", random_floats(size.pixels(), 0, 4)},
             {"A", random_floats(size.pixels(), 0, 1)},
             {"Z", depth},
             {"N.X", random_floats(size.pixels(), -1, 1)},
             {"id.primitive", ids}}};
}

const Plane<float>& floats(const ChannelImage& image, std::size_t channel) {
    return std::get<0>(image.channels[channel].values);
}

/// Runs `write` where no file may grow beyond `bytes`, which fails as a full disk does.
template <class Write>
void with_file_size_limit(rlim_t bytes, const Write& write) {
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
    write();
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
}

bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
}

/// All four formats, with a picture too large for one buffer of any library.
void write_noise(const fs::path& file) {
    const Size size{200, 150};
    const auto format = image_format(file).value();
    if (format == ImageFormat::exr)
        write_exr(file, channel_image(size), kDpi, kMetadata);
    else
        write_image(file, format, noise(size, true), kDpi, kMetadata);
}

class EveryFormat : public testing::TestWithParam<const char*> {
  protected:
    TemporaryFolder folder_;
    fs::path file_ = folder_.path() / (std::string("picture") + GetParam());
};
INSTANTIATE_TEST_SUITE_P(Written, EveryFormat, testing::Values(".png", ".jpg", ".tif", ".exr"),
                         [](const auto& test) { return std::string(test.param + 1); });

class EverySize : public testing::TestWithParam<std::tuple<Size, bool>> {
  protected:
    TemporaryFolder folder_;
    DisplayImage image_ = noise(std::get<0>(GetParam()), std::get<1>(GetParam()));
    int channels_ = std::get<1>(GetParam()) ? 3 : 4;
};
std::string size_name(const testing::TestParamInfo<std::tuple<Size, bool>>& test) {
    const auto [size, opaque] = test.param;
    return std::to_string(size.width) + "x" + std::to_string(size.height) +
           (opaque ? "_opaque" : "_transparent");
}
INSTANTIATE_TEST_SUITE_P(Written, EverySize,
                         testing::Combine(testing::Values(Size{1, 1}, Size{3, 7}, Size{64, 48},
                                                          Size{1, 500}, Size{500, 1},
                                                          Size{401, 353}),
                                          testing::Bool()),
                         size_name);

TEST(ImageFormatByName, LooksAtTheExtensionInAnyCase) {
    EXPECT_EQ(image_format("a/b.png"), ImageFormat::png);
    EXPECT_EQ(image_format("b.JPG"), ImageFormat::jpeg);
    EXPECT_EQ(image_format("b.jpeg"), ImageFormat::jpeg);
    EXPECT_EQ(image_format("b.Tif"), ImageFormat::tiff);
    EXPECT_EQ(image_format("b.tiff"), ImageFormat::tiff);
    EXPECT_EQ(image_format("b.png.exr"), ImageFormat::exr);
    EXPECT_EQ(image_format("b.svg"), std::nullopt);
    EXPECT_EQ(image_format("png"), std::nullopt);
    EXPECT_EQ(image_format(""), std::nullopt);
}

TEST_P(EverySize, ComesBackExactlyFromPng) {
    const fs::path file = folder_.path() / "a.png";
    write_image(file, ImageFormat::png, image_, kDpi, kMetadata);
    const Found found = read_png(file);
    EXPECT_EQ(found.image.size, image_.size);
    EXPECT_EQ(found.image.pixels, image_.pixels);
    EXPECT_EQ(found.channels, channels_);
}

TEST_P(EverySize, ComesBackExactlyFromTiff) {
    const fs::path file = folder_.path() / "a.tif";
    write_image(file, ImageFormat::tiff, image_, kDpi, kMetadata);
    const Found found = read_tiff(file);
    EXPECT_EQ(found.image.size, image_.size);
    EXPECT_EQ(found.image.pixels, image_.pixels);
    EXPECT_EQ(found.channels, channels_);
}

TEST_P(EverySize, ComesBackFromJpegWithASmallError) {
    const DisplayImage smooth = gradient(image_.size);
    const fs::path file = folder_.path() / "a.jpg";
    write_image(file, ImageFormat::jpeg, smooth, kDpi, kMetadata);
    const Found found = read_jpeg(file);
    EXPECT_EQ(found.image.size, smooth.size);
    EXPECT_LT(mean_error(found.image, smooth), 2.0);
}

TEST_P(EverySize, ComesBackFromExrWithColourInHalfPrecisionAndDataExactly) {
    const ChannelImage image = channel_image(image_.size);
    const fs::path file = folder_.path() / "a.exr";
    write_exr(file, image, kDpi, kMetadata);

    const auto red = read_exr_plane<float>(file, "R", Imf::FLOAT);
    const auto alpha = read_exr_plane<float>(file, "A", Imf::FLOAT);
    for (std::size_t i = 0; i < red.size(); ++i) {
        ASSERT_EQ(red[i], static_cast<float>(half(floats(image, 0)[i])));
        ASSERT_EQ(alpha[i], static_cast<float>(half(floats(image, 1)[i])));
    }
    EXPECT_EQ(read_exr_plane<float>(file, "Z", Imf::FLOAT), floats(image, 2));
    EXPECT_EQ(read_exr_plane<float>(file, "N.X", Imf::FLOAT), floats(image, 3));
    EXPECT_EQ(read_exr_plane<std::uint32_t>(file, "id.primitive", Imf::UINT),
              std::get<1>(image.channels[4].values));
}

TEST(Png, TellsResolutionColourSpaceAndMetadata) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    write_image(file, ImageFormat::png, gradient({8, 8}), kDpi, kMetadata);
    const Found found = read_png(file);
    EXPECT_NEAR(found.dpi, kDpi, 0.02);
    EXPECT_TRUE(found.is_srgb);
    EXPECT_EQ(found.texts, kMetadata);
}

TEST(Png, KeepsTextBeyondLatin1) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    const Metadata metadata{{"Scene", "β-カロテン.sdf"}, {"Author", "Åsa"}, {"Comment", ""}};
    write_image(file, ImageFormat::png, gradient({8, 8}), kDpi, metadata);
    EXPECT_EQ(read_png(file).texts, metadata);
    EXPECT_TRUE(contains(read_bytes(file), "iTXt"));
}

TEST(Jpeg, TellsResolutionAndMetadata) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.jpg";
    write_image(file, ImageFormat::jpeg, gradient({8, 8}), kDpi, kMetadata);
    const Found found = read_jpeg(file);
    EXPECT_EQ(found.dpi, kDpi);
    EXPECT_EQ(found.texts, (Metadata{{"Comment", kMetadataText}}));
}

TEST(Jpeg, SplitsMetadataTooLongForOneMarker) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.jpg";
    const Metadata metadata{{"Scene", std::string(100'000, 'x')}};
    write_image(file, ImageFormat::jpeg, gradient({8, 8}), kDpi, metadata);
    const Found found = read_jpeg(file);
    ASSERT_EQ(found.texts.size(), 2U);
    EXPECT_EQ(found.texts[0].second + found.texts[1].second, "Scene: " + std::string(100'000, 'x'));
}

TEST(Jpeg, ShowsWhiteWhereThePictureIsTransparent) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.jpg";
    const Size size{16, 16};
    const auto mean_of = [&](std::uint32_t pixel) {
        write_image(file, ImageFormat::jpeg, {size, Pixels(size.pixels(), pixel)}, kDpi, {});
        return read_jpeg(file).image.pixels.front() & 0xFFU;
    };
    EXPECT_EQ(mean_of(rgba(0, 0, 0, 0)), 255U);
    EXPECT_EQ(mean_of(rgba(0, 0, 0, 255)), 0U);
    EXPECT_NEAR(mean_of(rgba(0, 0, 0, 128)), 127, 1);
}

TEST(Jpeg, KeepsChromaAtFullResolution) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.jpg";
    write_image(file, ImageFormat::jpeg, gradient({32, 32}), kDpi, {});
    EXPECT_FALSE(read_jpeg(file).is_subsampled);
}

TEST(Jpeg, SaysSoWhenThePictureIsTooWide) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.jpg";
    const std::string message = output_error([&] {
        write_image(file, ImageFormat::jpeg, gradient({70'000, 1}), kDpi, {});
    });
    EXPECT_TRUE(message.starts_with(file.string() + ": JPEG: ")) << message;
    EXPECT_TRUE(contains(message, "65500")) << message;
    EXPECT_TRUE(message.ends_with("; try another size or format")) << message;
    EXPECT_EQ(names_in(folder.path()), Names{});
}

TEST(Tiff, TellsResolutionAndMetadata) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.tif";
    write_image(file, ImageFormat::tiff, gradient({8, 8}), kDpi, kMetadata);
    const Found found = read_tiff(file);
    EXPECT_EQ(found.dpi, kDpi);
    EXPECT_EQ(found.texts,
              (Metadata{{"ImageDescription", kMetadataText}, {"Software", "Inktrace 0.1.0"}}));
}

TEST(Exr, TellsResolutionAndMetadata) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr";
    write_exr(file, channel_image({4, 4}), kDpi, kMetadata);
    const Imf::InputFile exr(file.c_str());
    EXPECT_EQ(Imf::xDensity(exr.header()), 300.0F);
    for (const auto& [key, value] : kMetadata)
        EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>(key.c_str()).value(), value);
}

TEST(Exr, StoresHalvesForColourFloatsForDataAndIntegersForIds) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr";
    write_exr(file, channel_image({4, 4}), kDpi, {});
    const Imf::InputFile exr(file.c_str());
    const Imf::ChannelList& channels = exr.header().channels();
    EXPECT_EQ(channels["R"].type, Imf::HALF);
    EXPECT_EQ(channels["A"].type, Imf::HALF);
    EXPECT_EQ(channels["Z"].type, Imf::FLOAT);
    EXPECT_EQ(channels["id.primitive"].type, Imf::UINT);
    std::set<std::string> layers;
    channels.layers(layers);
    EXPECT_EQ(layers, (std::set<std::string>{"N", "id"}));
}

TEST(Exr, DoesNotDependOnTheNumberOfThreads) {
    const TemporaryFolder folder;
    const ChannelImage image = channel_image({100, 300});
    write_exr(folder.path() / "own.exr", image, kDpi, kMetadata);
    for (const int threads : {1, 5}) {
        Imf::setGlobalThreadCount(threads);
        write_exr(folder.path() / "set.exr", image, kDpi, kMetadata);
        EXPECT_EQ(Imf::globalThreadCount(), threads);
        EXPECT_EQ(read_bytes(folder.path() / "set.exr"), read_bytes(folder.path() / "own.exr"));
    }
    Imf::setGlobalThreadCount(0);
}

TEST(Exr, RefusesMetadataUnderANameThatTheFormatNeedsItself) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.exr";
    const std::string message = output_error([&] {
        write_exr(file, channel_image({4, 4}), kDpi, {{"channels", "four"}});
    });
    EXPECT_TRUE(message.starts_with(file.string() + ": EXR: ")) << message;
    EXPECT_EQ(names_in(folder.path()), Names{});
}

TEST_P(EveryFormat, GivesTheSameBytesTwice) {
    write_noise(file_);
    const std::string first = read_bytes(file_);
    fs::remove(file_);
    write_noise(file_);
    EXPECT_EQ(read_bytes(file_), first);
    EXPECT_FALSE(first.empty());
}

TEST_P(EveryFormat, LeavesNothingButTheFile) {
    write_noise(file_);
    EXPECT_EQ(names_in(folder_.path()), Names{file_.filename().string()});
}

TEST_P(EveryFormat, LeavesNoFileWhenTheDiskIsFull) {
    // Full in the middle of the pixels, and so early that even the first bytes cannot be flushed.
    for (const rlim_t bytes : {20'000U, 10U}) {
        std::string message;
        with_file_size_limit(bytes, [&] { message = output_error([&] { write_noise(file_); }); });
        EXPECT_TRUE(message.starts_with(file_.string() + ": larger than a file may be here; "))
            << message;
        EXPECT_EQ(names_in(folder_.path()), Names{});
    }
}

TEST_P(EveryFormat, LeavesTheOldFileAsItWasWhenTheDiskIsFull) {
    folder_.write(file_.filename().string(), "old");
    with_file_size_limit(20'000, [&] { EXPECT_THROW(write_noise(file_), OutputError); });
    EXPECT_EQ(read_bytes(file_), "old");
    EXPECT_EQ(names_in(folder_.path()), Names{file_.filename().string()});
}

TEST_P(EveryFormat, SaysThatTheDeviceIsFull) {
    fs::create_symlink("/dev/full", file_);
    EXPECT_EQ(output_error([&] { write_noise(file_); }),
              file_.string() + ": no space left on device; free some or choose another folder");
    EXPECT_TRUE(fs::is_character_file(file_));
}

}  // namespace

}  // namespace ink

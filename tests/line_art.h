#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/reader.h"
#include "paths.h"
#include "render/render.h"
#include "scene/scene.h"
#include "test_files.h"
#include "vector/line_art.h"
#include "vector/svg_writer.h"

/// Drawings made of curves, and what librsvg makes of them.
namespace ink::test {

struct Drawn {
    Film film;
    LineArt art;
};

inline Drawn draw(const Scene& scene, const Settings& settings, bool inked = false) {
    const auto tracer = make_tracer(scene);
    Drawing drawing;
    Film film =
        render(scene, *tracer, settings, {.display = true, .lines = inked}, {}, nullptr, &drawing);
    LineArt art = make_line_art(scene, settings, drawing, film.display());
    return {std::move(film), std::move(art)};
}

inline Scene acetaminophen() {
    return Scene(read_file(source_dir() / "samples/acetaminophen.xyz").objects);
}

/// Of a file of ../shared, if it is there.
inline std::optional<Scene> shared_scene(const char* name) {
    const auto file = data_file(name);
    if (!std::filesystem::exists(file)) return std::nullopt;
    return Scene(read_file(file).objects);
}

inline Settings picture(int side = 512) {
    Settings settings;
    settings.size = {side, side};
    settings.threads = 2;
    return settings;
}

inline std::string svg_of(const LineArt& art) {
    const TemporaryFolder folder;
    write_svg(folder.path() / "x.svg", art);
    return read_bytes(folder.path() / "x.svg");
}

inline bool has_rsvg() {
    static const bool has = std::system("rsvg-convert --version >/dev/null 2>&1") == 0;
    return has;
}

#define REQUIRE_RSVG() \
    if (!has_rsvg()) GTEST_SKIP() << "rsvg-convert is not installed (package librsvg2-bin)"

/// R, G, B, A bytes a pixel, over white, of a picture that librsvg makes of an SVG; empty if it
/// cannot.
inline std::vector<std::uint8_t> rasterised_rgba(const std::string& svg, int side) {
    const TemporaryFolder folder;
    const auto file = folder.write("x.svg", svg);
    const std::string png = (folder.path() / "x.png").string();
    const std::string command = "rsvg-convert -b white -w " + std::to_string(side) + " -h " +
                                std::to_string(side) + " '" + file.string() + "' -o '" + png + "'";
    if (std::system(command.c_str()) != 0) return {};
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&image, png.c_str()) == 0) return {};
    image.format = PNG_FORMAT_RGBA;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
    png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr);
    return bytes;
}

/// The green of each pixel, in [0, 1].
inline std::vector<float> rasterised(const std::string& svg, int side) {
    std::vector<float> values;
    const std::vector<std::uint8_t> bytes = rasterised_rgba(svg, side);
    for (std::size_t k = 0; k < bytes.size(); k += 4) {
        values.push_back(static_cast<float>(bytes[k + 1]) / 255.0F);
    }
    return values;
}

}  // namespace ink::test

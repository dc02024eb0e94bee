#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "api/guard.h"
#include "api/impl.h"
#include "base/text.h"
#include "film/aov_pictures.h"
#include "inktrace/render.h"
#include "io/atomic_file.h"
#include "io/image_writer.h"
#include "vector/lines_json.h"
#include "vector/pdf_writer.h"
#include "vector/svg_writer.h"

namespace inktrace {

Picture::Picture(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Picture::Picture(Picture&&) noexcept = default;
Picture& Picture::operator=(Picture&&) noexcept = default;
Picture::~Picture() = default;

int Picture::width() const { return impl_->film.size().width; }
int Picture::height() const { return impl_->film.size().height; }

std::span<const std::uint8_t> Picture::rgba() const {
    const auto& pixels = impl_->film.display().pixels;
    return {reinterpret_cast<const std::uint8_t*>(pixels.data()), pixels.size() * 4};
}

std::span<const float> Picture::channel(std::string_view name) const {
    for (const ink::Channel& channel : impl_->film.channels().channels) {
        const auto* values = std::get_if<ink::Plane<float>>(&channel.values);
        if (channel.name == name && values != nullptr) return *values;
    }
    return {};
}

const RenderStats& Picture::stats() const { return impl_->stats; }

namespace {

enum class CurveFormat { svg, packed_svg, pdf };

std::optional<CurveFormat> curve_format(const std::filesystem::path& file) {
    const std::string extension = ink::to_lower(file.extension().string());
    if (extension == ".svg") return CurveFormat::svg;
    if (extension == ".svgz") return CurveFormat::packed_svg;
    if (extension == ".pdf") return CurveFormat::pdf;
    return std::nullopt;
}

ink::ImageFormat picture_format(const std::filesystem::path& file) {
    const auto format = ink::image_format(file);
    if (!format) {
        throw ink::UsageError(fmt::format(
            "{}: cannot tell the picture's format; end the name in .png, .jpg, .tiff, .exr, .svg, "
            ".svgz or .pdf",
            file.string()));
    }
    return *format;
}

/// "x.png" and "depth" make "x.depth.png"; beside an SVG or PDF it is a PNG as well.
std::filesystem::path beside(const std::filesystem::path& file, std::string_view name) {
    std::filesystem::path sibling = file;
    sibling.replace_extension();
    sibling += fmt::format(".{}{}", name, curve_format(file) ? ".png" : file.extension().string());
    return sibling;
}

const ink::LineArt& line_art(const Picture::Impl& picture, const std::filesystem::path& file) {
    if (picture.line_art) return *picture.line_art;
    throw ink::UsageError(fmt::format(
        "{}: the lines were not kept as curves; set RenderOptions::curves", file.string()));
}

/// Throws where 8-bit pixels were not asked for.
void need_display(const Picture::Impl& picture, const std::filesystem::path& file) {
    if (!picture.film.display().pixels.empty()) return;
    throw ink::UsageError(
        fmt::format("{}: no 8-bit pixels were made; set RenderOptions::display", file.string()));
}

void save_curves(const Picture::Impl& picture, const std::filesystem::path& file,
                 CurveFormat format) {
    const ink::LineArt& art = line_art(picture, file);
    if (art.image || !art.regions.empty()) need_display(picture, file);
    if (format == CurveFormat::svg) ink::write_svg(file, art);
    if (format == CurveFormat::packed_svg) ink::write_svgz(file, art);
    if (format == CurveFormat::pdf) ink::write_pdf(file, art);
}

void save_pixels(const Picture::Impl& picture, const std::filesystem::path& file) {
    const ink::ImageFormat format = picture_format(file);
    if (format != ink::ImageFormat::exr) {
        need_display(picture, file);
        ink::write_image(file, format, picture.film.display(), picture.dpi, picture.metadata);
        return;
    }
    if (picture.film.channels().channels.empty()) {
        throw ink::UsageError(fmt::format(
            "{}: an EXR holds linear pixels, and none were made; set RenderOptions::linear",
            file.string()));
    }
    ink::write_exr(file, picture.film.channels(), picture.dpi, picture.metadata);
}

void save_aovs(const Picture::Impl& picture, const std::filesystem::path& file) {
    const ink::ImageFormat format = ink::image_format(file).value_or(ink::ImageFormat::png);
    if (format == ink::ImageFormat::exr) return;
    for (const ink::AovPicture& aov : ink::aov_pictures(picture.film.channels())) {
        ink::write_image(beside(file, aov.name), format, aov.image, picture.dpi, picture.metadata);
    }
}

}  // namespace

void Picture::save(const std::filesystem::path& file) const {
    ink::guard([&] {
        if (const auto format = curve_format(file)) {
            save_curves(*impl_, file, *format);
        } else {
            save_pixels(*impl_, file);
        }
        save_aovs(*impl_, file);
    });
}

void Picture::save_lines(const std::filesystem::path& file) const {
    ink::guard([&] { ink::write_lines_json(file, line_art(*impl_, file)); });
}

std::vector<Polyline> Picture::lines() const {
    std::vector<Polyline> lines;
    if (!impl_->line_art) return lines;
    for (const ink::Chain& chain : impl_->line_art->chains) {
        Polyline line;
        line.type = ink::name_of(chain.type);
        line.left = chain.left;
        line.right = chain.right;
        line.left_name = impl_->line_art->names(chain.left).label();
        line.right_name = impl_->line_art->names(chain.right).label();
        line.left_in_front = chain.left_in_front;
        line.hidden = chain.hidden;
        line.closed = chain.closed;
        line.strength = static_cast<double>(chain.strength);
        line.level = chain.level;
        for (const ink::Vec2f point : chain.points) line.points.push_back({point.x, point.y});
        line.depth = chain.t;
        line.strengths = chain.strengths;
        lines.push_back(std::move(line));
    }
    return lines;
}

void check_output(const std::filesystem::path& file) {
    ink::guard([&] { const ink::AtomicFile probe(file); });
}

RenderOptions options_for_output(const std::filesystem::path& file) {
    return ink::guard([&] {
        const bool curves = curve_format(file).has_value();
        const bool exr = !curves && picture_format(file) == ink::ImageFormat::exr;
        const ink::AtomicFile probe(file);  // throws where the folder cannot be written
        RenderOptions options;
        options.display = !exr;
        options.linear = exr;
        options.curves = curves;
        options.inked = !curves;
        return options;
    });
}

}  // namespace inktrace

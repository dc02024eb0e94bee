#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "api/guard.h"
#include "api/impl.h"
#include "film/aov_pictures.h"
#include "inktrace/render.h"
#include "io/atomic_file.h"
#include "io/image_writer.h"

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
        const auto* values = std::get_if<std::vector<float>>(&channel.values);
        if (channel.name == name && values != nullptr) return *values;
    }
    return {};
}

const RenderStats& Picture::stats() const { return impl_->stats; }

namespace {

ink::ImageFormat picture_format(const std::filesystem::path& file) {
    const auto format = ink::image_format(file);
    if (!format) {
        throw ink::UsageError(fmt::format(
            "{}: cannot tell the picture's format; end the name in .png, .jpg, .tiff or .exr",
            file.string()));
    }
    return *format;
}

/// "x.png" and "depth" make "x.depth.png".
std::filesystem::path beside(const std::filesystem::path& file, std::string_view name) {
    std::filesystem::path sibling = file;
    sibling.replace_extension();
    sibling += fmt::format(".{}{}", name, file.extension().string());
    return sibling;
}

}  // namespace

void Picture::save(const std::filesystem::path& file) const {
    ink::guard([&] {
        const ink::ImageFormat format = picture_format(file);
        if (format == ink::ImageFormat::exr) {
            if (impl_->film.channels().channels.empty()) {
                throw ink::UsageError(fmt::format(
                    "{}: an EXR holds linear pixels, and none were made; set RenderOptions::linear",
                    file.string()));
            }
            ink::write_exr(file, impl_->film.channels(), impl_->dpi, impl_->metadata);
            return;
        }
        ink::write_image(file, format, impl_->film.display(), impl_->dpi, impl_->metadata);
        for (const ink::AovPicture& aov : ink::aov_pictures(impl_->film.channels())) {
            ink::write_image(beside(file, aov.name), format, aov.image, impl_->dpi,
                             impl_->metadata);
        }
    });
}

RenderOptions options_for_output(const std::filesystem::path& file) {
    return ink::guard([&] {
        const bool exr = picture_format(file) == ink::ImageFormat::exr;
        const ink::AtomicFile probe(file);  // throws where the folder cannot be written
        RenderOptions options;
        options.display = !exr;
        options.linear = exr;
        return options;
    });
}

}  // namespace inktrace

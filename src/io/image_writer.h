#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"

namespace ink {

enum class ImageFormat { png, jpeg, tiff, exr };

/// By extension (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr"), in any case.
std::optional<ImageFormat> image_format(const std::filesystem::path& file);

/// Writes 8-bit pictures (PNG, TIFF: with alpha where any pixel is not opaque; JPEG: over white,
/// quality 95, no chroma subsampling), with the resolution and the metadata in the file. The file
/// appears whole or not at all, and the same arguments give the same bytes. `dpi` is positive;
/// EXR is for `write_exr`. Throws OutputError.
void write_image(const std::filesystem::path& file, ImageFormat format, const DisplayImage& image,
                 double dpi, const Metadata& metadata);

/// Writes an EXR of half-float colour and 32-bit data channels. Likewise.
void write_exr(const std::filesystem::path& file, const ChannelImage& image, double dpi,
               const Metadata& metadata);

}  // namespace ink

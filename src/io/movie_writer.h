#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace ink {

/// Whether the name is a film's: .mp4.
bool is_movie(const std::filesystem::path& file);

/// Makes pictures into a film (H.264 in MP4), by the program ffmpeg, to which it pipes them. The
/// file appears whole or not at all.
class MovieWriter {
  public:
    /// `rate` pictures a second; sides are cut down to even ones, which the format needs. Throws
    /// OutputError where the file cannot be written, and Error where there is no ffmpeg.
    MovieWriter(const std::filesystem::path& file, int width, int height, double rate);
    MovieWriter(const MovieWriter&) = delete;
    MovieWriter& operator=(const MovieWriter&) = delete;
    /// Without `finish`, nothing is left.
    ~MovieWriter();

    /// The next picture: R, G, B bytes of all its pixels, rows from the top. Throws Error where
    /// ffmpeg has given up, with what it says.
    void add(std::span<const std::uint8_t> rgb);
    void finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ink

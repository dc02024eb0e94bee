#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "inktrace/lines.h"
#include "inktrace/scene.h"
#include "inktrace/settings.h"

namespace inktrace {

/// What a render took. Times are wall time in milliseconds; a phase's is the mean over threads.
struct RenderStats {
    double render_ms = 0.0;  ///< from the built scene to the finished pixels
    double trace_ms = 0.0;   ///< rays through the pixels
    double lines_ms = 0.0;   ///< finding lines and drawing them
    double shade_ms = 0.0;   ///< colours of surfaces, and pixels
    double curves_ms = 0.0;  ///< after `render_ms`: joining lines and fitting curves to them
    std::uint64_t rays = 0;
    std::uint64_t crossings = 0;  ///< of lines with the lattice, located by method "edges"
    int threads = 0;
};

/// A finished picture.
class Picture {
  public:
    Picture(Picture&&) noexcept;
    Picture& operator=(Picture&&) noexcept;
    ~Picture();

    int width() const;
    int height() const;
    /// R, G, B, A bytes a pixel, rows from the top; sRGB, straight alpha. Empty if not asked for.
    std::span<const std::uint8_t> rgba() const;
    /// A plane of floats by its name in an EXR: "R", "G", "B", "A" (linear, premultiplied; if asked
    /// for) or an AOV such as "Z". Empty where there is none.
    std::span<const float> channel(std::string_view name) const;
    const RenderStats& stats() const;
    /// The lines as data; empty unless asked for with `RenderOptions::curves`.
    std::vector<Polyline> lines() const;

    /// Writes .png, .jpg or .tiff (which need `display` pixels), .exr (`linear` pixels), .svg,
    /// .svgz or .pdf (`curves`, and `display` pixels for what lies below them), with the settings
    /// in the file's metadata. AOVs become channels of an EXR, or pictures beside any other file
    /// ("x.depth.png"). Files appear whole or not at all. Throws Error (input) where the file
    /// cannot be written, Error (usage) where the picture lacks what the file needs.
    void save(const std::filesystem::path& file) const;
    /// Writes the lines as JSON (docs/formats.md); needs `curves`. Likewise.
    void save_lines(const std::filesystem::path& file) const;

    struct Impl;  ///< the library's own, as what makes a picture of it
    explicit Picture(std::unique_ptr<Impl> impl);

  private:
    std::unique_ptr<Impl> impl_;
};

/// Pictures of one size, one after another, as a film (.mp4), which the program ffmpeg makes of
/// them.
class Movie {
  public:
    /// `rate` pictures a second. Throws Error (input) where the file cannot be written or there is
    /// no ffmpeg, before any time is spent.
    Movie(const std::filesystem::path& file, int width, int height, double rate);
    Movie(Movie&&) noexcept;
    Movie& operator=(Movie&&) noexcept;
    ~Movie();

    /// The next picture, which needs display pixels; laid over white where it is transparent.
    /// Throws Error (input), also where it has another size.
    void add(const Picture& picture);
    /// The film appears, whole, with this; without it, not at all.
    void finish();

    /// Whether the name is a film's, by its extension.
    static bool is_movie(const std::filesystem::path& file);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// How to follow a render, and what it is for.
struct RenderOptions {
    bool display = true;  ///< make 8-bit sRGB pixels
    bool linear = false;  ///< make linear float pixels, as an EXR holds them
    bool curves = false;  ///< keep the lines as curves, which takes method edges
    bool inked = true;    ///< draw the lines on the pixels; SVG and PDF draw their own on top
    /// Below 1: a draft for a camera that moves, from so many rays along a pixel's side. Shading
    /// gets softer and what is thinner than 1 / draft pixels may be missed; lines keep their types,
    /// widths and places. Makes display pixels only, and no AOVs.
    double draft = 1.0;
    /// Called with the share that is done, in (0, 1], and the size of the whole in megapixels, from
    /// the rendering threads, one at a time.
    std::function<void(double share, double megapixels)> progress{};
    /// Once true, rendering stops within a tile's time and throws Error (cancelled). Must outlive
    /// the call; null: nothing stops it.
    const std::atomic<bool>* cancel = nullptr;
};

/// What `Picture::save` to this file needs. Throws Error (usage) for an extension that is not a
/// picture's, Error (input) where the file cannot be written, before any time is spent.
RenderOptions options_for_output(const std::filesystem::path& file);

/// Throws Error (input) where a file cannot be written, before any time is spent.
void check_output(const std::filesystem::path& file);

/// Throws Error (usage) where `Renderer::render` would refuse the settings whatever the scene, as a
/// picture that does not fit into memory: worth asking before a large scene is loaded.
void validate(const Settings& settings, const RenderOptions& options = {});

/// What lies under a point of a picture.
struct Hit {
    std::string object;                ///< name of the molecule, mesh or particle set
    std::string kind;                  ///< "atom", "particle", "triangle" or "shape"
    std::size_t object_number = 1;     ///< in the scene, from 1, as in `--line TYPE@K:...`
    std::size_t primitive = 0;         ///< in its object, from 0
    std::array<double, 3> position{};  ///< on the surface, in the units of the file
    std::array<double, 3> center{};    ///< of the sphere; of anything else the position
    /// Names and values: part, and what the file says where `LoadOptions::facts` kept it.
    std::vector<std::pair<std::string, std::string>> facts;
};

/// A scene made ready for rays. Build it once, render it often; several threads may render with one
/// at the same time.
class Renderer {
  public:
    /// Takes the scene over. Throws Error (input) where it is empty or does not fit into memory.
    explicit Renderer(Scene scene);
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;
    ~Renderer();

    /// The settings with the camera that they choose for this scene written out, so that other
    /// frames are seen by the same one.
    Settings with_camera(const Settings& settings) const;
    /// The same for a camera that goes round the scene, `turn_deg` from where it would stand, far
    /// enough away for every side.
    Settings with_turned_camera(const Settings& settings, double turn_deg) const;

    /// The same scene and settings give the same bytes. Throws Error.
    Picture render(const Settings& settings, const RenderOptions& options = {}) const;

    /// What the ray through a point of the picture meets: pixels, x right, y down, from its upper
    /// left corner. Nothing where that is the background. Throws Error.
    std::optional<Hit> pick(const Settings& settings, double x, double y) const;

    double build_ms() const;  ///< that the constructor took

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace inktrace

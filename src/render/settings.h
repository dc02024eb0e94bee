#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/color.h"
#include "base/image.h"
#include "camera/camera.h"
#include "film/film.h"
#include "lines/dashes.h"
#include "lines/line_type.h"
#include "lines/stencil_features.h"
#include "lines/strength.h"
#include "render/line_styles.h"
#include "render/values.h"
#include "scene/data_settings.h"
#include "scene/ids.h"
#include "shading/shading.h"

namespace ink {

enum class Method : std::uint8_t { edges, stencil };

struct AntiAliasing {
    enum class Kind : std::uint8_t {
        none,        ///< one sample at the pixel's centre
        edges,       ///< method "edges": pixels that a located edge cuts mix its two sides' colours
        stencil,     ///< the stencil's rays are shaded too (paper, section 4.2)
        multisample  ///< S samples, each with a stencil of its own
    };
    Kind kind = Kind::none;
    int samples = 1;  ///< of `multisample`
};

enum class Aov : std::uint8_t { id, depth, normal, position, lines };

inline constexpr int kMostLatticePoints = 4;  ///< along a pixel's side

inline constexpr int kMostSpecularDepth = 16;

/// What SVG and PDF show below the lines.
enum class Fill : std::uint8_t {
    automatic,  ///< flat, or the image where a geometry has several colours
    none,
    flat,      ///< each geometry filled with one colour
    two_tone,  ///< its light and its shaded part with one colour each
    image      ///< the shaded picture, embedded
};

/// How lines on surfaces behind others are drawn.
struct HiddenLines {
    enum class Kind : std::uint8_t { none, dashed, solid };
    Kind kind = Kind::none;
    /// Of a dash and of the gap after it, in line widths: ISO 128-2, line type 02.
    double dash = 12.0, gap = 3.0;
};

/// Where a legend says what colours mean.
enum class LegendPlace : std::uint8_t {
    automatic,  ///< in the lower right corner, where a field gives the colours
    none,
    top_left,
    top_right,
    bottom_left,
    bottom_right
};

enum class LineBlend : std::uint8_t { automatic, display, linear };

/// Everything that decides what a picture looks like. settings_table() is the way in for text.
struct Settings {
    std::string look;  ///< the last one that was set (render/looks.h); what it sets, it has set
    std::vector<LineRule> look_rules;  ///< go before `line_rules`

    Size size{1024, 1024};
    double dpi = 300.0;
    int frame = 0;       ///< the first one that is drawn
    int last_frame = 0;  ///< of an animation; kLastOfFile: whatever the file has
    static constexpr int kLastOfFile = 1 << 30;
    DataSettings data;

    ViewSettings view;

    Method method = Method::edges;
    LineTypes lines = LineTypes::usual();
    int lattice = 1;  ///< points along a pixel's side, for method "edges"
    Length line_width{3.0, Length::Unit::px};
    Rgb8 line_color{0, 0, 0};
    std::vector<LineRule> line_rules;  ///< for single types and objects; later ones win
    /// Share of an area (LineThinning), or of one small ball or stick (SmallThings), that lines may
    /// cover; where they would cover more, they get thinner. 1: they never do. Chosen by eye: on
    /// ribosomes, capsids and grains at 512 and 1024 pixels more is a grey mush, less makes
    /// outlines thin that stand apart.
    double line_density = 0.4;
    LineBlend line_blend = LineBlend::automatic;
    std::optional<IdLevel> ids;
    std::optional<Metric> metric;  ///< default: solid for method "edges", linear for "stencil"
    int rings = 1;
    Length ridge_scale{0.8, Length::Unit::percent};  ///< radius that ridges are looked for in
    double ridge_turn_deg = 8.0;   ///< that a normal turns in 1 % of the height, least
    StencilThresholds thresholds;  ///< of method "stencil"

    double line_fade = 0.0;   ///< share of their ink that the farthest lines lose, [0, 1]
    double line_taper = 0.0;  ///< share of their width that they lose, [0, 1]
    Length halo{0.0, Length::Unit::px};  ///< gap around outlines far in front of what they hide

    HiddenLines hidden;
    int hidden_layers = 4;  ///< surfaces behind the first one that are looked at

    Compose compose = Compose::both;
    LegendPlace legend = LegendPlace::automatic;
    ShadingSettings shading;
    int specular_depth = 4;  ///< hits of a ray after the first, [0, kMostSpecularDepth]

    std::optional<AntiAliasing> aa;  ///< default: the method's own, see smoothing()
    std::vector<Aov> aovs;

    // Lines as curves: SVG, PDF and JSON.
    Fill fill = Fill::automatic;
    double curve_tolerance_px = 0.1;
    Length min_length{0.0, Length::Unit::px};

    int threads = 0;
    int tile = 64;

    double line_width_px() const { return line_width.pixels(dpi, size.height); }
    double halo_px() const { return halo.pixels(dpi, size.height); }
    double ridge_scale_px() const { return ridge_scale.pixels(dpi, size.height); }
    /// How lines of a type and a level are drawn that belong to an object, counted from 1.
    /// `inner`: both sides are of one whole, see LineRule.
    StrokeStyle line_style(LineType type, int object, int level = 0, bool inner = false) const;
    /// Likewise, of hidden lines.
    StrokeStyle hidden_style(int object) const;
    /// The dashes of such a line of this length; nothing if it is solid.
    std::optional<Dashes> hidden_dashes(double width_px, double length_px, bool closed) const;
    bool draws_hidden() const { return hidden.kind != HiddenLines::Kind::none && draws_lines(); }
    bool draws_lines() const { return compose != Compose::shaded && !lines.empty(); }
    /// Whether curves are to show light and shade as regions of their own.
    bool divides_tones() const { return fill == Fill::two_tone && compose != Compose::lines; }
    /// The metric that is set, or else the method's own.
    Metric profile() const;
    /// What the method makes of `aa`. Method "edges" knows none and edges, and samples more densely
    /// for multisample (lattice_points); without `lines` there is nothing to find and its own is
    /// none. Method "stencil" knows all but edges.
    AntiAliasing smoothing() const;
    /// Lattice points along a pixel's side.
    int lattice_points() const;
};

/// One row of the table: the single source for flags, help and reference pages.
struct Setting {
    std::string_view name;   ///< "line-width"
    std::string_view topic;  ///< "Lines"
    std::string_view value;  ///< how a value is written: "LEN"
    std::string_view help;   ///< one sentence, no full stop
    /// Throws UsageError that says what is wrong and what is allowed.
    std::function<void(Settings&, std::string_view)> set;
    /// The value in the form that `set` reads; empty for "chosen automatically".
    std::function<std::string(const Settings&)> get;
    bool repeatable = false;  ///< `set` adds to what is there; an empty value clears it
    ValueForm form = {};
};

/// Rows of topic "Input": what of a file is drawn, and as what (data_settings.cpp).
std::vector<Setting> data_settings_rows();
/// The row of looks, which set other settings and so come first; and rows of the topics "Lines" and
/// "Shading" about light and distance (look_settings.cpp).
std::vector<Setting> look_rows();
std::vector<Setting> light_rows();

/// All settings, grouped by topic.
std::span<const Setting> settings_table();

/// The row of that name. Throws UsageError, with the closest name there is.
const Setting& find_setting(std::string_view name);

/// How a scene is shaded, with nothing left open: light comes from all around unless told otherwise
/// where method "edges" draws atoms or particles as spheres. All else has diffuse light alone: it
/// shows the form as well, in a tenth of the time or less.
ShadingSettings shading_of(const Settings& settings, const Scene& scene);

/// Checks what concerns several settings at once, and that the picture fits into the machine's
/// memory, given the bytes that the colour of a pixel takes: 4 on a display, 16 as linear numbers.
/// Throws UsageError.
void validate(const Settings& settings, int color_bytes = 4);

}  // namespace ink

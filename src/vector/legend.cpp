#include "vector/legend.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "scene/color_scale.h"

#ifdef __SANITIZE_ADDRESS__
/// Fontconfig keeps what it has read of fonts until the program ends, which counts as leaked.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }
#endif

namespace ink {

namespace {

// Lengths in units of the font's size, chosen by eye on pictures of 300 to 2000 pixels.
constexpr double kMargin = 1.3;
constexpr double kLineHeight = 1.45;
constexpr double kBarWidth = 0.9;
constexpr double kBarHeight = 10.0;
constexpr double kSwatch = 0.85;
constexpr double kGap = 0.45;       ///< between a colour and its name
constexpr double kTick = 0.3;       ///< length of the mark at a number
constexpr double kHairline = 0.07;  ///< width of marks and frames
constexpr double kRim = 0.16;

/// Fonts are this share of the picture's smaller side, and not smaller than can be read.
constexpr double kFontShare = 0.025;
constexpr double kSmallestFont = 9.0;
/// A picture below this is a thumbnail: a legend comes on request only.
constexpr int kSmallestPicture = 240;

constexpr std::size_t kMostKinds = 14;
constexpr std::size_t kMostScales = 3;

struct DestroySurface {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct DestroyContext {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
struct DestroyPath {
    void operator()(cairo_path_t* path) const { cairo_path_destroy(path); }
};
struct DestroyOptions {
    void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
using Surface = std::unique_ptr<cairo_surface_t, DestroySurface>;
using Context = std::unique_ptr<cairo_t, DestroyContext>;

Vec2f point(const cairo_path_data_t& data) {
    return {static_cast<float>(data.point.x), static_cast<float>(data.point.y)};
}

std::vector<Curve> to_curves(const cairo_path_t& path) {
    std::vector<Curve> curves;
    for (int i = 0; i < path.num_data; i += path.data[i].header.length) {
        const cairo_path_data_t* const data = path.data + i;
        switch (data->header.type) {
            case CAIRO_PATH_MOVE_TO: curves.push_back({point(data[1]), {}}); break;
            case CAIRO_PATH_LINE_TO:
                curves.back().pieces.push_back(straight_piece(curves.back().end(), point(data[1])));
                break;
            case CAIRO_PATH_CURVE_TO:
                curves.back().pieces.push_back({point(data[1]), point(data[2]), point(data[3])});
                break;
            case CAIRO_PATH_CLOSE_PATH: break;
        }
    }
    std::erase_if(curves, [](const Curve& curve) { return curve.pieces.empty(); });
    return curves;
}

void set_font(cairo_t* cr, double size) {
    const std::unique_ptr<cairo_font_options_t, DestroyOptions> options(
        cairo_font_options_create());
    cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(cr, options.get());
    cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size);
}

/// Words as outlines. On a surface without bounds: cairo leaves out letters beyond those of others.
class Typesetter {
  public:
    explicit Typesetter(double size)
        : surface_(cairo_recording_surface_create(CAIRO_CONTENT_ALPHA, nullptr)),
          context_(cairo_create(surface_.get())) {
        set_font(context_.get(), size);
    }

    double width(const std::string& text) const {
        cairo_text_extents_t extents;
        cairo_text_extents(context_.get(), text.c_str(), &extents);
        return extents.x_advance;
    }
    /// From x on, on the base line y.
    std::vector<Curve> outlines(const std::string& text, double x, double y) const {
        cairo_t* const cr = context_.get();
        cairo_new_path(cr);
        cairo_move_to(cr, x, y);
        cairo_text_path(cr, text.c_str());
        const std::unique_ptr<cairo_path_t, DestroyPath> path(cairo_copy_path(cr));
        return to_curves(*path);
    }

  private:
    Surface surface_;
    Context context_;
};

/// Round numbers within a range, three to seven of them.
std::vector<double> ticks(double least, double most) {
    if (!(most > least)) return {least};
    const double raw = (most - least) / 6.0;
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    double step = 10.0 * power;
    for (const double nice : {5.0, 2.0, 1.0}) {
        if (nice * power >= raw * 0.999) step = nice * power;
    }
    std::vector<double> values;
    const double first = std::ceil(least / step - 1e-6);
    for (int k = 0; k < 12 && (first + k) * step <= most + 1e-6 * step; ++k) {
        values.push_back((first + k) * step);
    }
    return values;
}

std::string number(double value) {
    std::string text = fmt::format("{:.4g}", value);
    if (text == "-0") return "0";
    // A minus is as long as a plus.
    return text.starts_with('-') ? "\u2212" + text.substr(1) : text;
}

class LegendMaker {
  public:
    LegendMaker(const Settings& settings, Legend& legend)
        : settings_(settings), legend_(legend), em_(font_size(settings.size)), type_(em_) {
        const Rgb8 paper = settings.shading.transparent_background ? Rgb8{255, 255, 255}
                                                                   : settings.shading.background;
        const int light = 3 * paper.r + 6 * paper.g + paper.b;
        ink_ = light > 1280 ? Rgb8{0, 0, 0} : Rgb8{255, 255, 255};
        legend_.paper = paper;
        legend_.rim_px = kRim * em_;
    }

    void run(const std::vector<const ColorScale*>& scales) {
        double width = 0.0;
        double height = 0.0;
        for (const ColorScale* scale : scales) {
            width = std::max(width, width_of(*scale));
            height += height_of(*scale) + (height > 0.0 ? kLineHeight * em_ : 0.0);
        }
        const bool left = settings_.legend == LegendPlace::top_left ||
                          settings_.legend == LegendPlace::bottom_left;
        const bool top =
            settings_.legend == LegendPlace::top_left || settings_.legend == LegendPlace::top_right;
        const double x = left ? kMargin * em_ : settings_.size.width - kMargin * em_ - width;
        double y = top ? kMargin * em_ : settings_.size.height - kMargin * em_ - height;
        for (const ColorScale* scale : scales) {
            draw(*scale, x, y);
            y += height_of(*scale) + kLineHeight * em_;
        }
    }

  private:
    static double font_size(Size size) {
        return std::max(kFontShare * std::min(size.width, size.height), kSmallestFont);
    }

    double bar_height() const { return std::min(kBarHeight * em_, 0.6 * settings_.size.height); }

    double height_of(const ColorScale& scale) const {
        if (scale.map != nullptr) return kLineHeight * em_ + bar_height() + 0.4 * em_;
        return kLineHeight * em_ * static_cast<double>(1 + names(scale).size());
    }

    double width_of(const ColorScale& scale) const {
        double widest = 0.0;
        const double beside = scale.map != nullptr ? kBarWidth + kTick + kGap : kSwatch + kGap;
        if (scale.map != nullptr) {
            for (const double value : ticks(scale.least, scale.most)) {
                widest = std::max(widest, type_.width(number(value)));
            }
        } else {
            for (const std::string& name : names(scale)) {
                widest = std::max(widest, type_.width(name));
            }
        }
        return std::max(beside * em_ + widest, type_.width(scale.title));
    }

    static std::vector<std::string> names(const ColorScale& scale) {
        std::vector<std::string> names;
        for (const ColorScale::Entry& entry : scale.entries) names.push_back(entry.name);
        if (names.size() <= kMostKinds) return names;
        const std::size_t more = names.size() - (kMostKinds - 1);
        names.resize(kMostKinds - 1);
        names.push_back(fmt::format("and {} more", more));
        return names;
    }

    void draw(const ColorScale& scale, double x, double y) {
        text(scale.title, x, y + 0.5 * em_);
        y += kLineHeight * em_;
        if (scale.map != nullptr) {
            draw_bar(scale, x, y + 0.4 * em_);
            return;
        }
        const std::vector<std::string> lines = names(scale);
        for (std::size_t k = 0; k < lines.size(); ++k, y += kLineHeight * em_) {
            const bool kind = lines[k] == scale.entries[k].name;
            if (kind) swatch(x, y + 0.5 * (1.0 - kSwatch) * em_, scale.entries[k].color);
            text(lines[k], x + (kind ? kSwatch + kGap : 0.0) * em_, y + 0.5 * em_);
        }
    }

    void swatch(double x, double y, Rgb8 color) {
        const double frame = kHairline * em_;
        rectangle(x - frame, y - frame, kSwatch * em_ + 2 * frame, kSwatch * em_ + 2 * frame, ink_);
        rectangle(x, y, kSwatch * em_, kSwatch * em_, color);
    }

    void draw_bar(const ColorScale& scale, double x, double y) {
        constexpr int kSteps = 128;
        const double height = bar_height();
        const double width = kBarWidth * em_;
        const double frame = kHairline * em_;
        const double most = scale.most > scale.least ? scale.most : scale.least + 1.0;
        for (const double value : ticks(scale.least, scale.most)) {
            const double at = y + height * (1.0 - (value - scale.least) / (most - scale.least));
            rectangle(x + width, at - 0.5 * frame, frame + kTick * em_, frame, ink_);
            text(number(value), x + width + (kTick + kGap) * em_, at);
        }
        rectangle(x - frame, y - frame, width + 2 * frame, height + 2 * frame, ink_);
        // Each reaches to the end, so that there is no seam between it and the next.
        for (int k = 0; k < kSteps; ++k) {
            const double from = height * k / kSteps;
            rectangle(x, y + from, width, height - from, scale.map->at(1.0 - (k + 0.5) / kSteps));
        }
    }

    /// From x on, about the height y of a capital's middle.
    void text(const std::string& words, double x, double y) {
        constexpr double kMiddle = 0.36;  // over the base line
        const double base = y + kMiddle * em_;
        legend_.shapes.push_back({type_.outlines(words, x, base), ink_, words, x, base, em_});
    }

    void rectangle(double x, double y, double width, double height, Rgb8 color) {
        const auto corner = [&](double across, double down) {
            return Vec2f{static_cast<float>(x + across * width),
                         static_cast<float>(y + down * height)};
        };
        Curve curve{corner(0, 0), {}};
        for (const Vec2f to : {corner(1, 0), corner(1, 1), corner(0, 1), corner(0, 0)}) {
            curve.pieces.push_back(straight_piece(curve.end(), to));
        }
        legend_.shapes.push_back({{std::move(curve)}, color});
    }

    const Settings& settings_;
    Legend& legend_;
    double em_;
    Typesetter type_;
    Rgb8 ink_;
};

/// Whether a legend comes unasked: colours of numbers mean nothing without one.
bool is_wanted(const ColorScale& scale, const Settings& settings) {
    if (settings.legend == LegendPlace::none || settings.compose == Compose::lines) return false;
    if (settings.legend != LegendPlace::automatic) return true;
    const bool is_rainbow = settings.data.color_by == "rainbow";
    return scale.map != nullptr && !is_rainbow &&
           std::min(settings.size.width, settings.size.height) >= kSmallestPicture;
}

void add_path(cairo_t* cr, const LegendShape& shape) {
    for (const Curve& curve : shape.outlines) {
        cairo_move_to(cr, double{curve.start.x}, double{curve.start.y});
        for (const auto& [c1, c2, end, straight] : curve.pieces) {
            if (straight) {
                cairo_line_to(cr, double{end.x}, double{end.y});
            } else {
                cairo_curve_to(cr, double{c1.x}, double{c1.y}, double{c2.x}, double{c2.y},
                               double{end.x}, double{end.y});
            }
        }
        cairo_close_path(cr);
    }
}

void set_color(cairo_t* cr, Rgb8 color) {
    cairo_set_source_rgb(cr, color.r / 255.0, color.g / 255.0, color.b / 255.0);
}

/// The legend alone: native-endian ARGB with premultiplied alpha, of the part of the picture where
/// it is.
struct LegendImage {
    int x = 0, y = 0, width = 0, height = 0;
    std::vector<std::uint32_t> pixels;
};

/// What a legend covers, without the rims of its words.
struct LegendBox {
    Vec2f lower{kInfinity, kInfinity};
    Vec2f upper{-kInfinity, -kInfinity};

    explicit LegendBox(const Legend& legend) {
        for (const LegendShape& shape : legend.shapes) {
            for (const Curve& curve : shape.outlines) {
                for (const CurvePiece& piece : curve.pieces) {
                    for (const Vec2f p : {piece.control1, piece.control2, piece.end}) add(p);
                }
            }
        }
    }

  private:
    void add(Vec2f p) {
        lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
        upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
    }
};

LegendImage image_of(const Legend& legend, Size size) {
    const auto [lower, upper] = LegendBox(legend);
    const auto rim = static_cast<float>(legend.rim_px) + 1.0F;
    const auto within = [](float v, int most) {
        return std::clamp(static_cast<int>(std::floor(v)), 0, most);
    };
    LegendImage image;
    image.x = within(lower.x - rim, size.width);
    image.y = within(lower.y - rim, size.height);
    image.width = within(upper.x + rim + 1.0F, size.width) - image.x;
    image.height = within(upper.y + rim + 1.0F, size.height) - image.y;
    if (image.width <= 0 || image.height <= 0) return {};
    image.pixels.resize(static_cast<std::size_t>(image.width) *
                        static_cast<std::size_t>(image.height));
    const Surface surface(cairo_image_surface_create_for_data(
        reinterpret_cast<unsigned char*>(image.pixels.data()), CAIRO_FORMAT_ARGB32, image.width,
        image.height, image.width * 4));
    const Context context(cairo_create(surface.get()));
    cairo_translate(context.get(), -image.x, -image.y);
    draw(legend, context.get());
    cairo_surface_flush(surface.get());
    cairo_surface_finish(surface.get());
    return image;
}

/// A block of 4 x 4 pixels of the image, as ink for a film; what lies beyond it is none.
struct InkBlock {
    Lanes<float> alpha{}, r{}, g{}, b{};

    InkBlock(const LegendImage& image, int x0, int y0, const Film& film) {
        for (int i = 0; i < kLanes; ++i) {
            const int x = x0 + i % kBlockSide;
            const int y = y0 + i / kBlockSide;
            if (x >= image.width || y >= image.height) continue;
            const std::uint32_t pixel =
                image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                             static_cast<std::size_t>(x)];
            const std::uint32_t share = pixel >> 24U;
            if (share == 0) continue;
            const auto channel = [&](unsigned shift) {
                const std::uint32_t value = (pixel >> shift & 255U) * 255U / share;
                return static_cast<std::uint8_t>(std::min(value, 255U));
            };
            const Color color = film.in_blend_space(Rgb8{channel(16), channel(8), channel(0)});
            alpha[i] = static_cast<float>(share) / 255.0F;
            r[i] = color.r * alpha[i];
            g[i] = color.g * alpha[i];
            b[i] = color.b * alpha[i];
        }
    }
};

}  // namespace

Legend make_legend(const Scene& scene, const Settings& settings) {
    std::vector<const ColorScale*> scales;
    for (const Object& object : scene.objects()) {
        if (!object.color_scale || !is_wanted(*object.color_scale, settings)) continue;
        const ColorScale& scale = *object.color_scale;
        const auto same = [&](const ColorScale* known) { return *known == scale; };
        if (std::ranges::none_of(scales, same) && scales.size() < kMostScales) {
            scales.push_back(&scale);
        }
    }
    Legend legend;
    if (!scales.empty()) LegendMaker(settings, legend).run(scales);
    return legend;
}

ViewSettings beside(const Legend& legend, ViewSettings view, Size size) {
    if (legend.empty()) return view;
    constexpr double kMost = 0.4;  // beyond which the scene would be the smaller part
    const LegendBox box(legend);
    const double width = size.width;
    const bool is_left = static_cast<double>(box.lower.x + box.upper.x) < width;
    const double taken =
        is_left ? static_cast<double>(box.upper.x) : width - static_cast<double>(box.lower.x);
    (is_left ? view.left_taken : view.right_taken) = std::min(taken / width, kMost);
    return view;
}

void draw(const Legend& legend, cairo_t* cr, Words words) {
    cairo_set_fill_rule(cr, CAIRO_FILL_RULE_WINDING);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    for (const LegendShape& shape : legend.shapes) {
        add_path(cr, shape);
        if (shape.is_text()) {
            set_color(cr, legend.paper);
            cairo_set_line_width(cr, 2.0 * legend.rim_px);
            cairo_stroke_preserve(cr);
        }
        set_color(cr, shape.color);
        if (words == Words::text && shape.is_text() && !shape.outlines.empty()) {
            cairo_new_path(cr);
            set_font(cr, shape.size);
            cairo_move_to(cr, shape.x, shape.y);
            cairo_show_text(cr, shape.text.c_str());
            cairo_new_path(cr);
        } else {
            cairo_fill(cr);
        }
    }
}

void lay_over(const Legend& legend, Film& film) {
    if (legend.empty()) return;
    const LegendImage image = image_of(legend, film.size());
    for (int y = 0; y < image.height; y += kBlockSide) {
        for (int x = 0; x < image.width; x += kBlockSide) {
            const InkBlock ink(image, x, y, film);
            film.lay_ink(image.x + x, image.y + y,
                         {.alpha = ink.alpha,
                          .color = std::nullopt,
                          .colors = {ink.r.data(), ink.g.data(), ink.b.data()}});
        }
    }
}

}  // namespace ink

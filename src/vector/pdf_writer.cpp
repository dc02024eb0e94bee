#include "vector/pdf_writer.h"

#include <cairo-pdf.h>
#include <cairo.h>

#include <array>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "io/image_writers.h"
#include "vector/line_layers.h"
#include "vector/xml_text.h"

namespace ink {

namespace {

struct DestroySurface {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct DestroyContext {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, DestroySurface>;
using Context = std::unique_ptr<cairo_t, DestroyContext>;

cairo_status_t write_bytes(void* sink, const unsigned char* bytes, unsigned int count) {
    static_cast<ByteSink*>(sink)->write(bytes, count);
    return CAIRO_STATUS_SUCCESS;  // the sink remembers
}

void check(cairo_status_t status) {
    if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
    if (status != CAIRO_STATUS_SUCCESS) {
        throw EncodeError(std::string("PDF: ") + cairo_status_to_string(status));
    }
}

void set_color(cairo_t* cr, Rgb8 color, double alpha = 1.0) {
    cairo_set_source_rgba(cr, color.r / 255.0, color.g / 255.0, color.b / 255.0, alpha);
}

void add_curve(cairo_t* cr, const Curve& curve, bool closed) {
    const auto move = [&](Vec2f p) { cairo_move_to(cr, double{p.x}, double{p.y}); };
    const auto line = [&](Vec2f p) { cairo_line_to(cr, double{p.x}, double{p.y}); };
    move(curve.start);
    for (const auto& [c1, c2, end, straight] : curve.pieces) {
        if (straight) {
            line(end);
        } else {
            cairo_curve_to(cr, double{c1.x}, double{c1.y}, double{c2.x}, double{c2.y},
                           double{end.x}, double{end.y});
        }
    }
    if (closed) cairo_close_path(cr);
}

/// Cairo wants native-endian ARGB with premultiplied alpha.
std::vector<std::uint32_t> cairo_pixels(const DisplayImage& image) {
    std::vector<std::uint32_t> pixels;
    pixels.reserve(image.pixels.size());
    for (const std::uint32_t pixel : image.pixels) {
        const std::uint32_t alpha = pixel >> 24U;
        const auto channel = [&](unsigned shift) {
            return ((pixel >> shift & 255U) * alpha + 127U) / 255U;
        };
        pixels.push_back(alpha << 24U | channel(0) << 16U | channel(8) << 8U | channel(16));
    }
    return pixels;
}

void draw_image(cairo_t* cr, const DisplayImage& image) {
    std::vector<std::uint32_t> pixels = cairo_pixels(image);
    const auto format = is_opaque(image) ? CAIRO_FORMAT_RGB24 : CAIRO_FORMAT_ARGB32;
    const Surface surface(cairo_image_surface_create_for_data(
        reinterpret_cast<unsigned char*>(pixels.data()), format, image.size.width,
        image.size.height, image.size.width * 4));
    check(cairo_surface_status(surface.get()));
    cairo_set_source_surface(cr, surface.get(), 0.0, 0.0);
    cairo_paint(cr);
    cairo_surface_finish(surface.get());  // before the pixels go
}

void draw_regions(cairo_t* cr, const LineArt& art) {
    cairo_set_fill_rule(cr, CAIRO_FILL_RULE_EVEN_ODD);
    cairo_set_line_width(cr, kUnderlapPx);
    for (const Region& region : art.regions) {
        for (const Curve& outline : region.outlines) add_curve(cr, outline, true);
        set_color(cr, region.color);
        cairo_fill_preserve(cr);
        cairo_stroke(cr);
    }
}

struct DestroyPattern {
    void operator()(cairo_pattern_t* pattern) const { cairo_pattern_destroy(pattern); }
};

void set_fade(cairo_t* cr, const Stroke& stroke, Rgb8 color, double alpha) {
    const Vec2f from = stroke.curve.start;
    const Vec2f to = stroke.curve.end();
    const std::unique_ptr<cairo_pattern_t, DestroyPattern> pattern(
        cairo_pattern_create_linear(double{from.x}, double{from.y}, double{to.x}, double{to.y}));
    for (const auto& [offset, opacity] : stroke.fade) {
        cairo_pattern_add_color_stop_rgba(pattern.get(), offset, color.r / 255.0, color.g / 255.0,
                                          color.b / 255.0, alpha * opacity);
    }
    cairo_set_source(cr, pattern.get());
}

void draw_stroke(cairo_t* cr, const LineArt& art, const Stroke& stroke, double alpha) {
    const Rgb8 color = art.styles[stroke.chain].color;
    add_curve(cr, stroke.curve, stroke.closed);
    cairo_set_line_width(cr, stroke.width_px);
    if (stroke.fade.empty()) {
        set_color(cr, color, alpha * stroke.opacity);
    } else {
        set_fade(cr, stroke, color, alpha);
    }
    const auto& dashes = art.dashes[stroke.chain];
    if (dashes) {
        const std::array<double, 2> lengths{dashes->stroke, dashes->gap};
        cairo_set_dash(cr, lengths.data(), 2, stroke.begins_at);
    }
    cairo_stroke(cr);
    if (dashes) cairo_set_dash(cr, nullptr, 0, 0.0);
}

/// Draws what is to be of one opacity where it overlaps itself, too.
template <class Draw>
void draw_group(cairo_t* cr, double opacity, const Draw& draw) {
    if (opacity < 1.0) cairo_push_group(cr);
    draw();
    if (opacity >= 1.0) return;
    cairo_pop_group_to_source(cr);
    cairo_paint_with_alpha(cr, opacity);
}

void draw_lines(cairo_t* cr, const LineArt& art) {
    const LineLayers lines = layers_of(art);
    draw_group(cr, lines.opacity, [&] {
        for (const LineLayer& layer : lines.layers) {
            draw_group(cr, layer.opacity.value_or(1.0), [&] {
                for (const std::size_t k : layer.strokes) {
                    const Stroke& stroke = art.strokes[k];
                    draw_stroke(cr, art, stroke,
                                layer.opacity ? 1.0 : art.styles[stroke.chain].opacity);
                }
            });
        }
    });
}

std::string value_of(const Metadata& metadata, std::string_view key) {
    for (const auto& [name, value] : metadata) {
        if (name == key) return value;
    }
    return {};
}

void set_document(cairo_surface_t* surface, const LineArt& art) {
    const auto set = [&](cairo_pdf_metadata_t entry, const std::string& text) {
        cairo_pdf_surface_set_metadata(surface, entry, text.c_str());
    };
    set(CAIRO_PDF_METADATA_TITLE, valid_utf8(art.title));
    set(CAIRO_PDF_METADATA_CREATOR, value_of(art.metadata, "Software"));
    set(CAIRO_PDF_METADATA_SUBJECT, valid_utf8(value_of(art.metadata, "Settings")));
    // Or the present time would make every file another one.
    set(CAIRO_PDF_METADATA_CREATE_DATE, "");
}

void encode_pdf(ByteSink& sink, const LineArt& art) {
    const double points_per_px = 72.0 / art.dpi;
    const Surface surface(cairo_pdf_surface_create_for_stream(
        write_bytes, &sink, art.size.width * points_per_px, art.size.height * points_per_px));
    check(cairo_surface_status(surface.get()));
    set_document(surface.get(), art);
    const Context context(cairo_create(surface.get()));
    cairo_t* cr = context.get();
    cairo_scale(cr, points_per_px, points_per_px);
    if (art.background) {
        set_color(cr, *art.background);
        cairo_rectangle(cr, 0.0, 0.0, art.size.width, art.size.height);
        cairo_fill(cr);
    }
    if (art.image) draw_image(cr, *art.image);
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    draw_regions(cr, art);
    draw_lines(cr, art);
    draw(art.legend, cr, Words::text);
    cairo_show_page(cr);
    check(cairo_status(cr));
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()));
}

}  // namespace

void write_pdf(const std::filesystem::path& file, const LineArt& art) {
    write_whole(file, [&](ByteSink& sink) { encode_pdf(sink, art); });
}

}  // namespace ink

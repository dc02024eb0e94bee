#include "vector/svg_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "io/gzip.h"
#include "io/image_writers.h"
#include "vector/line_layers.h"
#include "vector/path_data.h"
#include "vector/xml_text.h"

namespace ink {

namespace {

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        std::uint32_t group = 0;
        for (std::size_t n = 0; n < 3; ++n) {
            group <<= 8U;
            if (k + n < bytes.size()) group |= static_cast<unsigned char>(bytes[k + n]);
        }
        for (std::size_t n = 0; n < 4; ++n) {
            const bool padding = k + n > bytes.size();
            text += padding ? '=' : kDigits[group >> (18U - 6U * n) & 63U];
        }
    }
    return text;
}

class SvgText {
  public:
    explicit SvgText(const LineArt& art) : art_(art) {}

    std::string document();

  private:
    template <class... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    }
    void add_head();
    void add_paper();
    void add_regions();
    void add_lines();
    void add_fades();
    void add_layer(const LineLayer& layer);
    void add_stroke(std::size_t k, const LineLayer& layer);
    void add_opacity(double opacity);
    void add_legend();
    void add_names(GeometryId id, std::string_view also_of_class = {});

    const LineArt& art_;
    std::string text_;
};

void SvgText::add_head() {
    const double mm_per_px = 25.4 / art_.dpi;
    text_ += "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    add("<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
        "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" version=\"1.1\" "
        "width=\"{:.4f}mm\" height=\"{:.4f}mm\" viewBox=\"0 0 {} {}\">\n",
        art_.size.width * mm_per_px, art_.size.height * mm_per_px, art_.size.width,
        art_.size.height);
    add("<title>{}</title>\n", xml_text(art_.title));
    add("<desc>Feature lines of {}, as curves</desc>\n", xml_text(art_.title));
    // As RDF, which Inkscape keeps; other elements it complains of. Keys are names.
    text_ +=
        "<metadata>\n<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" "
        "xmlns:inktrace=\"urn:inktrace\">\n<rdf:Description rdf:about=\"\"";
    for (const auto& [key, value] : art_.metadata) {
        add(" inktrace:{}=\"{}\"", key, xml_text(value));
    }
    text_ += "/>\n</rdf:RDF>\n</metadata>\n";
}

void SvgText::add_paper() {
    if (art_.background) {
        add("<rect id=\"background\" width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", art_.size.width,
            art_.size.height, to_string(*art_.background));
    }
    if (!art_.image) return;
    add("<image id=\"shading\" width=\"{}\" height=\"{}\" xlink:href=\"data:image/png;base64,",
        art_.size.width, art_.size.height);
    text_ += base64(png_bytes(*art_.image, art_.dpi));
    text_ += "\"/>\n";
}

/// Classes and data- attributes that say what is shown.
void SvgText::add_names(GeometryId id, std::string_view also) {
    const GeometryName name = art_.names(id);
    std::string classes(also);
    if (!also.empty()) classes += ' ';
    classes += class_name("object-", name.object);
    if (!name.part.empty()) classes.append(class_name(" part-", name.part));
    if (!name.element.empty()) classes.append(class_name(" element-", name.element));
    add(" class=\"{}\" data-object=\"{}\"", classes, xml_text(name.object));
    if (!name.part.empty()) add(" data-part=\"{}\"", xml_text(name.part));
    if (!name.element.empty()) add(" data-element=\"{}\"", xml_text(name.element));
    if (name.index) add(" data-index=\"{}\"", *name.index + 1);
}

void SvgText::add_regions() {
    if (art_.regions.empty()) return;
    add("<g id=\"regions\" inkscape:groupmode=\"layer\" inkscape:label=\"regions\" "
        "fill-rule=\"evenodd\" stroke-width=\"{}\" stroke-linejoin=\"round\">\n",
        kUnderlapPx);
    for (const Region& region : art_.regions) {
        text_ += "<path";
        add_names(region.id);
        if (region.tone == Region::Tone::light) text_ += " data-tone=\"light\"";
        if (region.tone == Region::Tone::shade) text_ += " data-tone=\"shade\"";
        add(" fill=\"{0}\" stroke=\"{0}\" d=\"", to_string(region.color));
        for (const Curve& outline : region.outlines) append_path_data(text_, outline, true);
        text_ += "\"/>\n";
    }
    text_ += "</g>\n";
}

/// Fades between stops of one colour, for strokes to refer to.
void SvgText::add_fades() {
    const auto fades = [](const Stroke& stroke) { return !stroke.fade.empty(); };
    if (std::ranges::none_of(art_.strokes, fades)) return;
    text_ += "<defs>\n";
    for (std::size_t k = 0; k < art_.strokes.size(); ++k) {
        const Stroke& stroke = art_.strokes[k];
        if (!fades(stroke)) continue;
        const Vec2f from = stroke.curve.start;
        const Vec2f to = stroke.curve.end();
        add("<linearGradient id=\"fade-{}\" gradientUnits=\"userSpaceOnUse\" x1=\"{:.2f}\" "
            "y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\">",
            k, from.x, from.y, to.x, to.y);
        for (const auto& [offset, opacity] : stroke.fade) {
            add("<stop offset=\"{:.3f}\" stop-color=\"{}\" stop-opacity=\"{:.2f}\"/>", offset,
                to_string(art_.styles[stroke.chain].color), opacity);
        }
        text_ += "</linearGradient>\n";
    }
    text_ += "</defs>\n";
}

/// A group whose style is that of its first line; others of another style say so themselves.
void SvgText::add_layer(const LineLayer& layer) {
    add("<g id=\"{0}\" class=\"{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0}\" "
        "stroke=\"{1}\" stroke-width=\"{2:.4g}\"",
        layer.name, to_string(layer.usual.color), layer.usual.width_px);
    add_opacity(layer.opacity.value_or(1.0));
    text_ += ">\n";
    for (const std::size_t k : layer.strokes) add_stroke(k, layer);
    text_ += "</g>\n";
}

/// Of a group as a whole.
void SvgText::add_opacity(double opacity) {
    if (opacity < 0.995) add(" opacity=\"{:.2f}\"", opacity);
}

void SvgText::add_stroke(std::size_t k, const LineLayer& layer) {
    const Stroke& stroke = art_.strokes[k];
    const Chain& chain = art_.chains[stroke.chain];
    const StrokeStyle& style = art_.styles[stroke.chain];
    text_ += "<path";
    add_names(front(chain), chain.hidden ? name_of(chain.type) : "");
    if (behind(chain) != front(chain) && behind(chain) != kBackground) {
        add(" data-behind=\"{}\"", xml_text(art_.names(behind(chain)).label()));
    }
    if (chain.level > 0) add(" data-level=\"{}\"", chain.level);
    if (!stroke.fade.empty()) {
        add(" stroke=\"url(#fade-{})\"", k);
    } else if (style.color != layer.usual.color) {
        add(" stroke=\"{}\"", to_string(style.color));
    }
    if (std::abs(stroke.width_px - layer.usual.width_px) > 0.005) {
        add(" stroke-width=\"{:.3g}\"", stroke.width_px);
    }
    const double opacity =
        (layer.opacity ? 1.0 : style.opacity) * (stroke.fade.empty() ? stroke.opacity : 1.0);
    if (opacity < 0.995) add(" stroke-opacity=\"{:.2f}\"", opacity);
    if (const auto& dashes = art_.dashes[stroke.chain]) {
        add(" stroke-dasharray=\"{:.2f} {:.2f}\"", dashes->stroke, dashes->gap);
        if (stroke.begins_at > 0.0) add(" stroke-dashoffset=\"{:.2f}\"", stroke.begins_at);
    }
    text_ += " d=\"";
    append_path_data(text_, stroke.curve, stroke.closed);
    text_ += "\"/>\n";
}

void SvgText::add_lines() {
    const LineLayers lines = layers_of(art_);
    if (lines.layers.empty()) return;
    add_fades();
    text_ += "<g id=\"lines\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"";
    add_opacity(lines.opacity);
    text_ += ">\n";
    for (const LineLayer& layer : lines.layers) add_layer(layer);
    text_ += "</g>\n";
}

/// Words are outlines, each over its own rim.
void SvgText::add_legend() {
    if (art_.legend.empty()) return;
    text_ +=
        "<g id=\"legend\" inkscape:groupmode=\"layer\" inkscape:label=\"legend\" "
        "stroke-linejoin=\"round\">\n";
    for (const LegendShape& shape : art_.legend.shapes) {
        std::string path;
        for (const Curve& curve : shape.outlines) append_path_data(path, curve, true);
        if (shape.is_text()) {
            add("<path fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2f}\" d=\"{}\"/>\n",
                to_string(art_.legend.paper), 2.0 * art_.legend.rim_px, path);
        }
        add("<path fill=\"{}\" d=\"{}\"/>\n", to_string(shape.color), path);
    }
    text_ += "</g>\n";
}

std::string SvgText::document() {
    add_head();
    add_paper();
    add_regions();
    add_lines();
    add_legend();
    text_ += "</svg>\n";
    return std::move(text_);
}

}  // namespace

void write_svg(const std::filesystem::path& file, const LineArt& art) {
    const std::string text = SvgText(art).document();
    write_whole(file, [&](ByteSink& sink) { sink.write(text.data(), text.size()); });
}

void write_svgz(const std::filesystem::path& file, const LineArt& art) {
    const std::string packed = gzipped(SvgText(art).document());
    write_whole(file, [&](ByteSink& sink) { sink.write(packed.data(), packed.size()); });
}

}  // namespace ink

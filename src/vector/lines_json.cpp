#include "vector/lines_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "io/image_writers.h"

namespace ink {

namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json geometry(const GeometryName& name) {
    Json json{{"object", name.object}};
    if (!name.part.empty()) json["part"] = name.part;
    if (!name.element.empty()) json["element"] = name.element;
    if (name.index) json["index"] = *name.index;
    return json;
}

/// The names of all geometries that lines touch, by ID.
Json geometries(const LineArt& art) {
    std::vector<GeometryId> ids;
    for (const Chain& chain : art.chains) {
        for (const GeometryId id : {chain.left, chain.right}) {
            if (id != kBackground) ids.push_back(id);
        }
    }
    std::ranges::sort(ids);
    const auto [first, last] = std::ranges::unique(ids);
    ids.erase(first, last);
    Json json = Json::object();
    for (const GeometryId id : ids) json[fmt::format("{}", id)] = geometry(art.names(id));
    return json;
}

/// Points by hand: a tree of numbers would take many times the memory of the drawing.
void append_line(std::string& text, const Chain& chain) {
    const auto out = std::back_inserter(text);
    fmt::format_to(out,
                   "{{\"type\":\"{}\",\"level\":{},\"left\":{},\"right\":{},\"front\":\"{}\","
                   "\"closed\":{},{}\"strength\":{:.4g},\"points\":[",
                   name_of(chain.type), chain.level, chain.left, chain.right,
                   chain.left_in_front ? "left" : "right", chain.closed,
                   chain.hidden ? "\"hidden\":true," : "", chain.strength);
    for (std::size_t k = 0; k < chain.points.size(); ++k) {
        fmt::format_to(out, "{}[{:.3f},{:.3f},{:.7g}]", k == 0 ? "" : ",", chain.points[k].x,
                       chain.points[k].y, chain.t[k]);
    }
    text += ']';
    if (std::ranges::any_of(chain.strengths,
                            [&](float s) { return std::abs(s - chain.strength) > 1e-3F; })) {
        text += ",\"strengths\":[";
        for (std::size_t k = 0; k < chain.strengths.size(); ++k) {
            fmt::format_to(out, "{}{:.3g}", k == 0 ? "" : ",", chain.strengths[k]);
        }
        text += ']';
    }
    text += '}';
}

}  // namespace

void write_lines_json(const std::filesystem::path& file, const LineArt& art) {
    Json metadata = Json::object();
    for (const auto& [key, value] : art.metadata) metadata[key] = value;
    std::string text = fmt::format(
        "{{\"format\":\"inktrace-lines\",\"version\":1,\n\"title\":{},\n\"metadata\":{},\n"
        "\"width\":{},\"height\":{},\"dpi\":{},\n\"geometries\":{},\n\"lines\":[",
        dump(art.title), dump(metadata), art.size.width, art.size.height, art.dpi,
        dump(geometries(art)));
    for (std::size_t k = 0; k < art.chains.size(); ++k) {
        text += k == 0 ? "\n" : ",\n";
        append_line(text, art.chains[k]);
    }
    text += "\n]}\n";
    write_whole(file, [&](ByteSink& sink) { sink.write(text.data(), text.size()); });
}

}  // namespace ink

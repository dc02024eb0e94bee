#include "io/obj_materials.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/text.h"
#include "io/file_text.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

std::optional<Path> library_path(const Path& file, std::string_view name) {
    const Path folder = std::filesystem::absolute(file).parent_path().lexically_normal();
    const Path path = (folder / Path(name)).lexically_normal();
    const Path below = path.lexically_relative(folder);
    if (below.empty() || *below.begin() == ".." || to_lower(path.extension().string()) != ".mtl") {
        return std::nullopt;
    }
    std::error_code error;
    return std::filesystem::is_regular_file(path, error) ? std::optional(path) : std::nullopt;
}

}  // namespace

Rgb8 to_rgb8(Vec3f color) {
    // Written so that NaN becomes 0.
    const auto byte = [](float x) {
        return static_cast<std::uint8_t>(x > 0.F ? std::lround(std::min(x, 1.F) * 255.F) : 0);
    };
    return {byte(color.x), byte(color.y), byte(color.z)};
}

void ObjMaterials::open(const Path& file, std::string_view name) {
    const auto path = library_path(file, name);
    if (path) {
        read(read_text(*path));
        found_ = true;
        missing_.clear();
    } else if (!found_ && missing_.empty()) {
        missing_ = Path(name).filename().string();
    }
}

void ObjMaterials::read(std::string_view text) {
    LineCursor lines(text);
    std::string material;
    while (lines.next()) {
        std::string_view line = lines.line();
        const std::string_view keyword = take_word(line);
        if (keyword == "newmtl") material = trim(line);
        if (keyword != "Kd") continue;
        Vec3f color;
        bool complete = true;
        for (float* const channel : {&color.x, &color.y, &color.z}) {
            const auto value = parse_double(take_word(line));
            complete = complete && value.has_value();
            *channel = static_cast<float>(value.value_or(0.0));
        }
        if (complete) colors_.insert_or_assign(material, to_rgb8(color));
    }
}

std::optional<Rgb8> ObjMaterials::color(const std::string& material) const {
    const auto known = colors_.find(material);
    return known == colors_.end() ? std::nullopt : std::optional(known->second);
}

}  // namespace ink

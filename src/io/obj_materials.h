#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/color.h"
#include "base/vec.h"

namespace ink {

/// Reals from 0 to 1, cut off beyond; NaN is 0.
Rgb8 to_rgb8(Vec3f color);

/// The colours in the material libraries (.mtl) that an OBJ file names.
class ObjMaterials {
  public:
    /// Reads the library of that name beside `file`. The names in a model are a stranger's: nothing
    /// outside its folder is opened.
    void open(const std::filesystem::path& file, std::string_view name);

    /// The diffuse colour of a material, if it has one.
    std::optional<Rgb8> color(const std::string& material) const;

    /// The first library that was asked for, where none was found; else empty.
    const std::string& missing() const { return missing_; }

  private:
    void read(std::string_view text);

    std::map<std::string, Rgb8> colors_;
    std::string missing_;
    bool found_ = false;
};

}  // namespace ink

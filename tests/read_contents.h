#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/error.h"
#include "io/reader.h"

namespace ink::test {

inline const Spheres& spheres(const FileContents& contents) {
    return std::get<Spheres>(contents.objects.at(0).shape);
}

inline std::vector<Vec3d> positions(const FileContents& contents) {
    std::vector<Vec3d> out;
    const Spheres& shape = spheres(contents);
    for (std::size_t i = 0; i < shape.count(); ++i) {
        out.push_back(contents.objects[0].frame.to_world(shape.at(i).centre));
    }
    return out;
}

inline std::vector<float> radii(const FileContents& contents) {
    std::vector<float> out;
    for (const Sphere& sphere : spheres(contents).spheres) out.push_back(sphere.radius);
    return out;
}

/// What a reader says of a file that it refuses.
inline std::string refusal(const std::filesystem::path& file, const ReadOptions& options = {}) {
    try {
        read_file(file, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "(it was read)";
}

inline void expect_refused(const std::filesystem::path& file, std::string_view problem,
                           const ReadOptions& options = {}) {
    const std::string message = refusal(file, options);
    EXPECT_NE(message.find(file.string()), std::string::npos) << message;
    EXPECT_NE(message.find(problem), std::string::npos) << message;
}

}  // namespace ink::test

#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "base/error.h"
#include "io/reader.h"
#include "test_files.h"

/// Small meshes as text, and what readers make of them.
namespace ink::test {

inline const Mesh& mesh_of(const FileContents& contents) {
    return std::get<Mesh>(contents.objects.at(0).shape);
}

inline FileContents read_text_as(std::string_view name, std::string_view content) {
    const TemporaryFolder folder;
    return read_file(folder.write(name, content));
}

/// What reading says is wrong, without the folder.
inline std::string error_of(std::string_view name, std::string_view content) {
    const TemporaryFolder folder;
    try {
        read_file(folder.write(name, content));
    } catch (const InputError& error) {
        return std::string(error.what()).substr(folder.path().string().size() + 1);
    }
    return "no error";
}

inline double area(const Mesh& mesh) {
    double sum = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d origin = to_double(mesh.vertices[a]);
        sum += length(cross(to_double(mesh.vertices[b]) - origin,
                            to_double(mesh.vertices[c]) - origin)) /
               2.0;
    }
    return sum;
}

}  // namespace ink::test

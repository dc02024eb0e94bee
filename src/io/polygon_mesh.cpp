#include "io/polygon_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include "base/bounds.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/triangulate.h"
#include "io/wire_mesh.h"
#include "scene/mesh_topology.h"

namespace ink {

namespace {

constexpr std::size_t kGrain = 1 << 14;

/// Distance from the origin over size beyond which 32-bit coordinates show as steps: a float keeps
/// 1.7e7 steps to the distance, so less than 2000 across the model, about one a pixel.
constexpr double kFarFromOrigin = 1e4;

bool usable(Vec3f normal) {
    const float size = length(normal);
    return std::isfinite(size) && size > 1e-12f;
}

/// Cuts the polygons of a file into the triangles of a Mesh.
class Triangulator {
  public:
    Triangulator(const std::filesystem::path& file, const PolygonMesh& from)
        : file_(file), from_(from), keep_faces_(has_other_than_triangles(from)) {
        packed_.resize(from.normals.size());
        parallel_ranges(packed_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) packed_[i] = pack_normal(from.normals[i]);
        });
        reserve_large(mesh_.triangles, from.polygon_ends.size());
    }

    Mesh run() {
        if (!keep_faces_ && all_vertices_exist()) {
            copy_triangles();
            return std::move(mesh_);
        }
        std::uint32_t begin = 0;
        for (std::size_t i = 0; i < from_.polygon_ends.size(); ++i) {
            const std::uint32_t end = from_.polygon_ends[i];
            add_polygon(i, std::span(from_.corners).subspan(begin, end - begin));
            begin = end;
        }
        return std::move(mesh_);
    }

    std::size_t too_small() const { return too_small_; }

  private:
    static bool has_other_than_triangles(const PolygonMesh& from) {
        for (std::size_t i = 0; i < from.polygon_ends.size(); ++i) {
            if (from.polygon_ends[i] != 3 * (i + 1)) return true;
        }
        return false;
    }

    bool all_vertices_exist() const {
        std::atomic<bool> all = true;
        parallel_ranges(from_.corners.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (from_.corners[i] >= from_.positions.size()) all = false;
            }
        });
        return all;
    }

    void copy_triangles() {
        const std::size_t count = from_.polygon_ends.size();
        mesh_.triangles.resize(count);
        mesh_.parts = from_.parts;
        if (!packed_.empty()) mesh_.corner_normals.resize(count);
        parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::uint32_t vertex = from_.corners[3 * i + k];
                    mesh_.triangles[i][k] = vertex;
                    if (!packed_.empty()) mesh_.corner_normals[i][k] = packed_[vertex];
                }
            }
        });
    }

    void add_polygon(std::size_t polygon, std::span<const std::uint32_t> vertices) {
        check_vertices(polygon, vertices);
        if (vertices.size() < 3) {
            ++too_small_;
        } else if (vertices.size() == 3) {
            add_triangle(polygon, {vertices[0], vertices[1], vertices[2]});
        } else {
            cut(polygon, vertices);
        }
    }

    void check_vertices(std::size_t polygon, std::span<const std::uint32_t> vertices) const {
        for (const std::uint32_t vertex : vertices) {
            if (vertex < from_.positions.size()) continue;
            throw InputError(file_, fmt::format("face {} uses vertex {}, but there are only {}; "
                                                "the file is damaged: export it again",
                                                polygon + 1, vertex, from_.positions.size()));
        }
    }

    void cut(std::size_t polygon, std::span<const std::uint32_t> vertices) {
        corners_.clear();
        cuts_.clear();
        for (const std::uint32_t vertex : vertices) corners_.push_back(from_.positions[vertex]);
        if (!triangulate(corners_, cuts_)) {
            throw InputError(file_,
                             fmt::format("face {} has {} corners and cannot be cut into "
                                         "triangles; triangulate the model where it was made",
                                         polygon + 1, vertices.size()));
        }
        for (const auto& [a, b, c] : cuts_) {
            add_triangle(polygon, {vertices[a], vertices[b], vertices[c]});
        }
    }

    void add_triangle(std::size_t polygon, const Mesh::Triangle& triangle) {
        mesh_.triangles.push_back(triangle);
        if (keep_faces_) mesh_.faces.push_back(static_cast<std::uint32_t>(polygon));
        if (!from_.parts.empty()) mesh_.parts.push_back(from_.parts[polygon]);
        if (packed_.empty()) return;
        mesh_.corner_normals.push_back(
            {packed_[triangle[0]], packed_[triangle[1]], packed_[triangle[2]]});
    }

    const std::filesystem::path& file_;
    const PolygonMesh& from_;
    bool keep_faces_;
    std::vector<std::uint32_t> packed_;  ///< normals, a vertex
    Mesh mesh_;
    std::size_t too_small_ = 0;
    std::vector<Vec3f> corners_;
    std::vector<Mesh::Triangle> cuts_;
};

void check_file_normals(PolygonMesh& polygons) {
    if (std::ranges::all_of(polygons.normals, usable)) return;
    polygons.normals.clear();
    polygons.warnings.emplace_back(
        "Some normals of the file are zero or not finite; all were computed anew.");
}

void warn_about_small(std::size_t too_small, PolygonMesh& polygons) {
    if (too_small == 0) return;
    polygons.warnings.push_back(
        fmt::format("{} faces with fewer than 3 corners were left out.", too_small));
}

/// The triangles of a file as they are.
Mesh raw_mesh(const std::filesystem::path& file, PolygonMesh& polygons) {
    Triangulator triangulator(file, polygons);
    Mesh mesh = triangulator.run();
    // Welding needs the memory.
    release(polygons.corners);
    release(polygons.polygon_ends);
    release(polygons.parts);
    release(polygons.normals);
    mesh.vertices = std::move(polygons.positions);
    mesh.colors = std::move(polygons.colors);
    warn_about_small(triangulator.too_small(), polygons);
    return mesh;
}

/// Leaves out what cannot be seen, and merges the vertices that triangles share.
void clean(Mesh& mesh, PolygonMesh& polygons) {
    const std::size_t all = mesh.triangles.size();
    const std::size_t without_area = weld(mesh);
    if (without_area == 0) return;
    polygons.warnings.push_back(
        fmt::format("{} of {} triangles have no area, their corners coincide or lie on a line, "
                    "and were left out.",
                    without_area, all));
}

/// True at the first triangle of almost every mesh.
bool any_has_area(const Mesh& mesh) {
    return std::ranges::any_of(
        mesh.triangles, [&](const Mesh::Triangle& triangle) { return has_area(mesh, triangle); });
}

/// Vertices of triangles, each place once.
std::size_t used_vertices(const Mesh& mesh) {
    std::set<std::array<float, 3>> places;
    for (const Mesh::Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) {
            const Vec3f p = mesh.vertices[vertex] + Vec3f{};  // -0 + 0 is 0
            places.insert({p.x, p.y, p.z});
        }
    }
    return places.size();
}

/// A surface that can be made of matter has none of these; what was meant is anyone's guess.
void warn_about_branches(const Mesh& mesh, const MeshTopology& topology, PolygonMesh& polygons) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t i = 0; i < 3 * mesh.triangles.size(); ++i) {
        const auto edge = static_cast<Corner>(i);
        if (topology.twin(edge) != MeshTopology::kBranching) continue;
        edges.emplace_back(std::minmax(topology.vertex(edge), topology.vertex(next(edge))));
    }
    if (edges.empty()) return;
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    polygons.warnings.push_back(
        fmt::format("{} {} more than two faces; a line runs along each as along a crease.",
                    edges.size(), edges.size() == 1 ? "edge has" : "edges have"));
}

void warn_if_far(const Object& object, PolygonMesh& polygons) {
    if (!polygons.single_precision) return;
    const Bounds3d bounds = object.world_bounds();
    const double distance = length(bounds.centre());
    const double size = length(bounds.extent());
    if (distance <= kFarFromOrigin * size) return;
    polygons.warnings.push_back(
        fmt::format("The coordinates lie far from the origin ({:.2g} times the size of the model), "
                    "where 32-bit numbers are too coarse for its shape; move the model nearer.",
                    distance / size));
}

/// Faces without area show their edges, which is all that there is of them.
FileContents wire_contents(const std::filesystem::path& file, const Mesh& mesh, Object object,
                           PolygonMesh& polygons) {
    Glyphs wires = wires_of(mesh);
    if (wires.placements.empty()) {
        throw InputError(file, "no face has an area; check the export and its scale");
    }
    FileContents contents;
    contents.format = std::move(polygons.format);
    contents.counts = {{"vertices", used_vertices(mesh)}, {"triangles", mesh.triangles.size()}};
    contents.warnings = std::move(polygons.warnings);
    contents.warnings.emplace_back(
        "No face has an area, their corners coincide or lie on a line: only their edges are drawn, "
        "as wires.");
    object.shape = std::move(wires);
    contents.objects.push_back(std::move(object));
    return contents;
}

FileContents describe(Object object, PolygonMesh polygons) {
    FileContents contents;
    const Mesh& mesh = std::get<Mesh>(object.shape);
    contents.format = std::move(polygons.format);
    contents.counts = {{"vertices", mesh.vertices.size()}, {"triangles", mesh.triangles.size()}};
    if (!object.part_names.empty()) {
        contents.counts.emplace_back("parts", object.part_names.size());
        contents.names.emplace_back("parts", object.part_names);
    }
    contents.warnings = std::move(polygons.warnings);
    contents.objects.push_back(std::move(object));
    return contents;
}

}  // namespace

bool is_usable_position(Vec3d position) {
    const auto in_range = [](double x) { return std::abs(x) <= kLargestCoordinate; };
    return in_range(position.x) && in_range(position.y) && in_range(position.z);
}

bool PolygonMesh::add_position(Vec3d position) {
    if (!is_usable_position(position)) return false;
    if (positions.empty()) origin = position;
    positions.push_back(to_float(position - origin));
    return true;
}

std::string model_name(const std::filesystem::path& file) {
    const bool compressed = to_lower(file.extension().string()) == ".gz";
    return compressed ? file.stem().stem().string() : file.stem().string();
}

FileContents mesh_contents(const std::filesystem::path& file, PolygonMesh polygons) {
    if (polygons.polygon_ends.empty()) {
        throw InputError(file, polygons.positions.empty()
                                   ? "holds no faces; export the model again"
                                   : "holds points, no faces; export the surface with its faces");
    }
    check_file_normals(polygons);
    Object object;
    object.name = model_name(file);
    object.kind = ObjectKind::mesh;
    object.frame.origin = polygons.origin;
    if (polygons.color) object.material.color = *polygons.color;
    Mesh mesh = raw_mesh(file, polygons);
    if (!any_has_area(mesh)) return wire_contents(file, mesh, std::move(object), polygons);
    clean(mesh, polygons);
    MeshTopology topology(mesh);
    stitch(mesh, topology);
    smooth_normals(mesh, topology);
    warn_about_branches(mesh, topology, polygons);
    mesh.twins = std::move(topology).take_twins();
    object.shape = std::move(mesh);
    object.part_names = std::move(polygons.part_names);
    warn_if_far(object, polygons);
    return describe(std::move(object), std::move(polygons));
}

}  // namespace ink

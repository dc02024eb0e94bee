#include "render/face_tiling.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <optional>
#include <span>
#include <variant>

#include "render/screen_vertices.h"

namespace ink {

namespace {

constexpr std::uint32_t kAllPixels = 0xFFFFU;  ///< of a block

/// Whether an edge of a triangle lies within a polygon, or has a line of another type.
bool has_no_line(const Mesh& mesh, std::uint32_t triangle, std::size_t edge) {
    if (!mesh.edge_flags.empty() && mesh.is_boundary(triangle, edge)) return true;
    if (mesh.faces.empty() || mesh.twins.empty()) return false;
    const std::uint32_t twin = mesh.twins[3 * std::size_t{triangle} + edge];
    return twin < Mesh::kManyTwins && mesh.faces[twin / 3] == mesh.faces[triangle];
}

/// A bit for each of those edges.
std::uint32_t sides_without_line(const Mesh& mesh, std::uint32_t triangle) {
    if (mesh.edge_flags.empty() && mesh.faces.empty()) return 0;
    std::uint32_t without = 0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
        without |= has_no_line(mesh, triangle, edge) ? 1U << edge : 0U;
    }
    return without;
}

}  // namespace

FaceTiling::FaceTiling(const Scene& scene, const Projection& projection,
                       const Enlargement& enlargement)
    : projection_(projection),
      small_(enlargement.small()),
      large_(enlargement.large()),
      factor_(enlargement.factor()),
      blocks_across_((small_.width + kBlockSide - 1) / kBlockSide),
      near_(static_cast<std::size_t>(blocks_across_) *
            static_cast<std::size_t>((small_.height + kBlockSide - 1) / kBlockSide)),
      spots_(near_.size() * kLanes) {
    for (const Object& object : scene.objects()) {
        meshes_.push_back(std::get_if<Mesh>(&object.shape));
    }
    const auto blocks = [](int pixels) {
        return static_cast<std::size_t>((pixels + kBlockSide - 1) / kBlockSide);
    };
    columns_.resize(blocks(large_.width));
    rows_.resize(blocks(large_.height));
    for (std::size_t k = 0; k < columns_.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            const auto x = static_cast<float>(static_cast<int>(k) * kBlockSide + i % kBlockSide);
            const float at = enlargement.shrunk({x + 0.5F, 0.0F}).x;
            const int near = std::clamp(static_cast<int>(std::floor(at)), 0, small_.width - 1);
            columns_[k].nearest[static_cast<std::size_t>(i % kBlockSide)] = near;
            columns_[k].off[i] = (at - static_cast<float>(near) - 0.5F) * factor_;
        }
    }
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            const auto y = static_cast<float>(static_cast<int>(k) * kBlockSide + i / kBlockSide);
            const float at = enlargement.shrunk({0.0F, y + 0.5F}).y;
            const int near = std::clamp(static_cast<int>(std::floor(at)), 0, small_.height - 1);
            rows_[k].nearest[static_cast<std::size_t>(i / kBlockSide)] = near;
            rows_[k].off[i] = (at - static_cast<float>(near) - 0.5F) * factor_;
        }
    }
    const auto one = [](const Places& places, const auto& index_of) {
        const auto& near = places.nearest;
        return near.front() == near.back() ? index_of(near.front()) : kSeveral;
    };
    for (const Places& column : columns_) {
        one_column_.push_back(one(column, [&](int x) { return index_of_column(x); }));
    }
    for (const Places& row : rows_) {
        one_row_.push_back(one(row, [&](int y) { return index_of_row(y); }));
    }
    aside_.resize(columns_.size() * rows_.size() * kLanes);
}

bool FaceTiling::put(int x, int y, const HitPacket& hits, const SidesPacket* sides) {
    if (x < 0 || y < 0 || x >= small_.width || y >= small_.height) return false;
    const auto sees_none = [](std::uint32_t object) { return object == kNoObject; };
    if (std::ranges::all_of(hits.object, sees_none)) return false;
    const std::size_t k = block(x, y);
    bool any = false;
    for (int i = 0; i < kLanes; ++i) {
        TilingSpot& spot = spots_[k * kLanes + static_cast<std::size_t>(i)];
        const std::uint32_t object = hits.object[i];
        const Mesh* const mesh = object == kNoObject ? nullptr : meshes_[object];
        spot.object = TilingSpot::kNone;
        if (mesh == nullptr) continue;
        any = true;
        const std::uint32_t triangle = hits.primitive[i];
        const Vec2f point{static_cast<float>(x + i % kBlockSide) + 0.5F,
                          static_cast<float>(y + i / kBlockSide) + 0.5F};
        spot.sides = sides != nullptr ? (*sides)[static_cast<std::size_t>(i)]
                                      : project_sides(*mesh, triangle, point);
        spot.t = hits.t[i];
        spot.object = object << 3U | sides_without_line(*mesh, triangle);
    }
    near_[k] = any ? kSeesMesh : 0;
    return any;
}

TriangleSides FaceTiling::project_sides(const Mesh& mesh, std::uint32_t triangle,
                                        Vec2f point) const {
    std::array<Vec2f, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
        const ScreenPoint seen =
            project(projection_, to_double(mesh.vertices[mesh.triangles[triangle][k]]));
        if (seen.width <= 0.0F) return TriangleSides::none();  // behind the eye
        corners[k] = {seen.x, seen.y};
    }
    const Vec2f u = corners[1] - corners[0];
    const Vec2f v = corners[2] - corners[0];
    const float area = u.x * v.y - u.y * v.x;
    TriangleSides sides = TriangleSides::none();
    if (area == 0.0F) return sides;
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec2f side = corners[k + 1] - corners[k];
        const Vec2f way = point - corners[k];
        sides.inside[k] = (side.x * way.y - side.y * way.x) / area;
        sides.dx[k] = -side.y / area;
        sides.dy[k] = side.x / area;
    }
    return sides;
}

/// By Cauchy's way of counting: half of the sides over the area. Of polygons, too: the picture in
/// full counts triangles (LineFinder::add_face_density).
float FaceTiling::length_at(int x, int y, int lane) const {
    const TilingSpot& spot = spots_[block(x, y) * kLanes + static_cast<std::size_t>(lane)];
    if (spot.object == TilingSpot::kNone) return 0.0F;
    const auto& [inside, step_x, step_y] = spot.sides;
    float length = 0.0F;
    for (unsigned k = 0; k < 3; ++k) {
        const float dx = k < 2 ? step_x[k] : -step_x[0] - step_x[1];
        const float dy = k < 2 ? step_y[k] : -step_y[0] - step_y[1];
        length += std::sqrt(dx * dx + dy * dy);
    }
    // The lattice of the picture in full notices only one of the lines that cross between two
    // neighbours; how many do is about a matter of chance.
    const float most = 0.5F * std::numbers::pi_v<float> * factor_;
    return most * (1.0F - std::exp(-length / most));
}

/// `sees` for a block whose pixels may lie about several spots.
bool FaceTiling::several_see(int x, int y) const {
    const auto& columns = columns_[static_cast<std::size_t>(x / kBlockSide)].nearest;
    const auto& rows = rows_[static_cast<std::size_t>(y / kBlockSide)].nearest;
    const auto near = [&](int column, int row) { return near_[block(column, row)] != 0; };
    return near(columns.front(), rows.front()) || near(columns.back(), rows.front()) ||
           near(columns.front(), rows.back()) || near(columns.back(), rows.back());
}

void FaceTiling::look_nowhere(int first_row, int last_row) {
    const std::size_t across = columns_.size() * kLanes;
    const auto row = [](int y) {
        return static_cast<std::size_t>((y + kBlockSide - 1) / kBlockSide);
    };
    std::fill(aside_.data() + row(first_row) * across, aside_.data() + row(last_row) * across, 0);
}

void FaceTiling::look_at(int x, int y, int column, int row) {
    const auto bx = static_cast<std::size_t>(x / kBlockSide);
    const auto by = static_cast<std::size_t>(y / kBlockSide);
    const int near_column = columns_[bx].nearest[static_cast<std::size_t>(x % kBlockSide)];
    const int near_row = rows_[by].nearest[static_cast<std::size_t>(y % kBlockSide)];
    // Other threads may say so, too.
    const std::atomic_ref near(near_[block(near_column, near_row)]);
    if ((near.load(std::memory_order_relaxed) & kLooksAside) == 0) {
        near.fetch_or(kLooksAside, std::memory_order_relaxed);
    }
    const int right = column - near_column;
    const int below = row - near_row;
    const int code = 1 + (std::clamp(below, -1, 1) + 1) * 3 + std::clamp(right, -1, 1) + 1;
    const auto lane = static_cast<std::size_t>(y % kBlockSide * kBlockSide + x % kBlockSide);
    aside_[(by * columns_.size() + bx) * kLanes + lane] = static_cast<std::uint8_t>(code);
}

/// Whether any pixel of a block looks aside.
bool FaceTiling::looks_aside(const std::uint8_t* aside) {
    std::array<std::uint64_t, 2> any;
    static_assert(sizeof(any) == kLanes);
    std::memcpy(any.data(), aside, sizeof(any));
    return (any[0] | any[1]) != 0;
}

const TilingSpot* FaceTiling::spot_at(int column, int row) const {
    if ((near_[block(column, row)] & kSeesMesh) == 0) return nullptr;
    const TilingSpot& spot =
        spots_[static_cast<std::size_t>(index_of_column(column) + index_of_row(row))];
    return spot.object == TilingSpot::kNone ? nullptr : &spot;
}

/// Calls `visit(spot, off x, off y, own)` for each point that pixels of the block at (x, y) lie
/// about and that sees a mesh: from it to the pixels, and a bit for each that lies about it.
template <class Visit>
void FaceTiling::for_each_spot(int x, int y, const Visit& visit) const {
    const auto bx = static_cast<std::size_t>(x / kBlockSide);
    const auto by = static_cast<std::size_t>(y / kBlockSide);
    const Places& columns = columns_[bx];
    const Places& rows = rows_[by];
    const std::uint8_t* const aside = aside_of(x, y);
    if (const std::optional<std::int32_t> one = one_spot(x, y)) {
        const TilingSpot& spot = spots_[static_cast<std::size_t>(*one)];
        if (spot.object != TilingSpot::kNone) visit(spot, columns.off, rows.off, kAllPixels);
        return;
    }
    Lanes<std::int32_t> column;
    Lanes<std::int32_t> row;
    Lanes<float> off_x = columns.off;
    Lanes<float> off_y = rows.off;
    for (int i = 0; i < kLanes; ++i) {
        column[i] = columns.nearest[static_cast<std::size_t>(i % kBlockSide)];
        row[i] = rows.nearest[static_cast<std::size_t>(i / kBlockSide)];
        if (aside[i] == 0) continue;
        const int right = (aside[i] - 1) % 3 - 1;
        const int below = (aside[i] - 1) / 3 - 1;
        column[i] += right;
        row[i] += below;
        off_x[i] -= static_cast<float>(right) * factor_;
        off_y[i] -= static_cast<float>(below) * factor_;
    }
    for (std::uint32_t left = kAllPixels; left != 0;) {
        const int first = std::countr_zero(left);
        std::uint32_t own = 0;
        for (int i = first; i < kLanes; ++i) {
            own |= column[i] == column[first] && row[i] == row[first] ? 1U << i : 0U;
        }
        left &= ~own;
        const TilingSpot* const spot = spot_at(std::clamp(column[first], 0, small_.width - 1),
                                               std::clamp(row[first], 0, small_.height - 1));
        if (spot != nullptr) visit(*spot, off_x, off_y, own);
    }
}

bool FaceTiling::measure(int x, int y, float reach, NearestEdges& nearest) const {
    nearest.distance.fill(kInfinity);
    nearest.nx.fill(1.0F);
    nearest.ny.fill(0.0F);
    nearest.t.fill(0.0F);
    nearest.triangle.fill(0);
    for_each_spot(x, y,
                  [&](const TilingSpot& spot, const Lanes<float>& off_x, const Lanes<float>& off_y,
                      std::uint32_t own) {
                      NearestEdges found;
                      find_nearest(lines_about(spot, factor_), off_x, off_y, found);
                      for (; own != 0; own &= own - 1) {
                          const int i = std::countr_zero(own);
                          nearest.distance[i] = found.distance[i];
                          nearest.nx[i] = found.nx[i];
                          nearest.ny[i] = found.ny[i];
                          nearest.t[i] = spot.t;
                          nearest.triangle[i] = spot.object >> 3U;
                      }
                  });
    return std::ranges::any_of(nearest.distance, [&](float d) { return d < reach; });
}

/// `ink` for one block whose pixels may lie about several spots.
bool FaceTiling::ink_about_several(int x, int y, const RowBands& band, Lanes<float>& alpha) const {
    bool any = false;
    const Lanes<float> others = alpha;
    for_each_spot(x, y,
                  [&](const TilingSpot& spot, const Lanes<float>& off_x, const Lanes<float>& off_y,
                      std::uint32_t own) {
                      any = true;
                      Lanes<float> found = others;
                      TilingBlocks block{
                          .which = 1, .spots = {}, .off_x = {&off_x}, .off_y = &off_y};
                      ink::ink(block, &spot, factor_, band, std::span(&found, 1));
                      for (; own != 0; own &= own - 1) {
                          const int i = std::countr_zero(own);
                          alpha[i] = found[i];
                      }
                  });
    return any;
}

LaneBits FaceTiling::ink(int x, int y, LaneBits seeing, const RowBands& bands,
                         std::span<Lanes<float>> alphas) const {
    const auto by = static_cast<std::size_t>(y / kBlockSide);
    TilingBlocks blocks{.which = 0, .spots = {}, .off_x = {}, .off_y = &rows_[by].off};
    LaneBits inked = 0;
    for (; seeing != 0; seeing &= seeing - 1) {
        const int k = std::countr_zero(seeing);
        const LaneBits bit = LaneBits{1} << k;
        const int block_x = x + k * kBlockSide;
        const auto place = static_cast<std::size_t>(k);
        const std::optional<std::int32_t> spot = one_spot(block_x, y);
        if (!spot) {
            const RowBands band{.half = {bands.half[k]}, .opacity = bands.opacity};
            inked |= ink_about_several(block_x, y, band, alphas[place]) ? bit : 0U;
            continue;
        }
        if (spots_[static_cast<std::size_t>(*spot)].object == TilingSpot::kNone) continue;
        // Those left out need one that is there, too.
        if (blocks.which == 0) blocks.spots.fill(*spot);
        blocks.which |= bit;
        blocks.spots[k] = *spot;
        blocks.off_x[place] = &columns_[static_cast<std::size_t>(block_x / kBlockSide)].off;
    }
    if (blocks.which != 0) ink::ink(blocks, spots_.data(), factor_, bands, alphas);
    return inked | blocks.which;
}

/// The one that all pixels of a block lie about, in a block of the small picture that sees a mesh;
/// nothing if there is none.
std::optional<std::int32_t> FaceTiling::one_spot(int x, int y) const {
    const std::int32_t column = one_column_[static_cast<std::size_t>(x / kBlockSide)];
    const std::int32_t row = one_row_[static_cast<std::size_t>(y / kBlockSide)];
    if (column == kSeveral || row == kSeveral) return {};
    const std::int32_t spot = column + row;
    const std::uint8_t near = near_[static_cast<std::size_t>(spot / kLanes)];
    if ((near & kSeesMesh) == 0) return {};
    if ((near & kLooksAside) != 0 && looks_aside(aside_of(x, y))) return {};
    return spot;
}

}  // namespace ink

// Lines between the faces of meshes, which are drawn from their edges (FaceEdges): what LineFinder
// keeps for that, and their crossings where other lines run or somebody wants data.

#include <algorithm>
#include <array>
#include <cmath>

#include "base/timer.h"
#include "render/line_finder.h"
#include "render/nearest_edges.h"

namespace ink {

/// Keeps how far the points of some blocks are from the borders of their faces.
void LineFinder::map_borders(std::size_t first, std::size_t count) {
    border_packets_.resize(count);
    sampler_.take_borders(first, border_packets_);
    for (std::size_t k = 0; k < count; ++k) {
        const Block& block = lattice_[first + k];
        // Those cut off at the tile's end belong to the next tile, which may be at work.
        if (block.columns < kBlockSide || block.rows < kBlockSide) continue;
        if (face_density_) {
            face_density_->add(block, hits_[first + k]);
        } else {
            add_face_density(first + k);
        }
        borders_->put(block.x, block.y, border_packets_[k], hits_[first + k].t);
    }
}

/// Keeps the triangles that the points of some blocks see, and counts their sides.
void LineFinder::map_tiling(std::size_t first, std::size_t count) {
    sides_.resize(count);
    const bool known = sampler_.take_sides(first, sides_);
    for (std::size_t k = 0; k < count; ++k) {
        const Block& block = lattice_[first + k];
        if (block.columns < kBlockSide || block.rows < kBlockSide) continue;
        const HitPacket& hits = hits_[first + k];
        if (!tiling_->put(block.x, block.y, hits, known ? &sides_[k] : nullptr)) continue;
        // Squares of a density are several points wide, so a quarter of all will do.
        constexpr std::array kPoints{2, 4, 11, 13};
        constexpr float kArea = static_cast<float>(kLanes) / static_cast<float>(kPoints.size());
        for (const int lane : kPoints) {
            const float length = tiling_->length_at(block.x, block.y, lane) * kArea;
            if (length == 0.0F) continue;
            const std::size_t style = edges_.style_of(LineType::mesh, hits.object[lane]);
            const Vec2f place{static_cast<float>(block.x + lane % kBlockSide) + 0.5F,
                              static_cast<float>(block.y + lane / kBlockSide) + 0.5F};
            density_.add(place, length, edges_.ink.styles[style].width_px);
            if (specular_) direct_density_.add(place, length, edges_.ink.styles[style].width_px);
        }
    }
}

/// Keeps what pixel centres, or the lattice points next to them, see.
void LineFinder::map_faces(const Tile& tile) {
    const Timer timer(stats_.lines_ms);
    for (std::size_t k = 0; k < lattice_.size(); ++k) {
        // Those cut off at the tile's end belong to the next tile, which may be at work.
        const bool whole = lattice_[k].columns == kBlockSide && lattice_[k].rows == kBlockSide;
        if (whole) add_face_density(k);
    }
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        for (int x = tile.x0; x < tile.x1; x += kBlockSide) map_block(x, y);
    }
}

void LineFinder::map_block(int x, int y) {
    const int q = edges_.q;
    if (q == 1) {
        const std::uint32_t block =
            lattice_.block((x - grid_.x0) / kBlockSide, (y - grid_.y0) / kBlockSide);
        if (block == LatticeBlocks::kEmpty) return faces_->put_nothing(x, y);
        return faces_->put(x, y, hits_[block]);
    }
    faces_->put_nothing(x, y);
    for (int n = 0; n < kLanes; ++n) {
        const int i = (x + n % kBlockSide) * q + q / 2 - grid_.x0;
        const int j = (y + n / kBlockSide) * q + q / 2 - grid_.y0;
        if (i >= grid_.width || j >= grid_.height) continue;  // beyond the picture
        if (lattice_.place_of(i, j).packet == LatticeBlocks::kEmpty) continue;
        const LatticeHit hit = hit_at(i, j);
        faces_->put(x + n % kBlockSide, y + n / kBlockSide, *hit.hits, hit.lane);
    }
}

/// The same for objects that may differ in the width of their lines.
void LineFinder::add_face_density(std::size_t block) {
    const Block& place = lattice_[block];
    const HitPacket& hits = hits_[block];
    const int changes = count_changes(hits.object, hits.primitive);
    if (changes == 0) return;
    const std::uint32_t object =
        *std::ranges::find_if(hits.object, [](std::uint32_t o) { return o != kNoObject; });
    if (!edges_.surfaces.is_mesh(object)) return;
    const Vec2f middle = {static_cast<float>(place.x) + 0.5F * kBlockSide,
                          static_cast<float>(place.y) + 0.5F * kBlockSide};
    const float length = face_length(changes, grid_.spacing);
    const float width = edges_.ink.styles[edges_.style_of(LineType::mesh, object)].width_px;
    density_.add(middle * grid_.spacing, length, width);
    if (specular_) direct_density_.add(middle * grid_.spacing, length, width);
}

/// Whether any line between faces must be a crossing.
bool LineFinder::crosses_faces() const {
    const bool data = edges_.pipeline.lines.drawing != nullptr;
    return (faces_ != nullptr && faces_end_) ||
           (data && (faces_ != nullptr || borders_ != nullptr));
}

/// Lines between the faces of meshes, in the cells through which other lines run, unless these
/// cover their ends: as crossings of those edges of the lattice that have none yet. Beside a crease
/// they are not searched for: there they are as visible as it is.
void LineFinder::cross_faces() {
    marks_.assign(grid_.id.size(), 0);
    marked_.clear();
    for (const Crossing& crossing : crossings_) {
        const SuspectEdge& edge = suspects_[crossing.edge];
        marks_[grid_.index(edge.i, edge.j)] |= edge.down ? kCrossedDown : kCrossedRight;
    }
    for (const Crossing& crossing : crossings_) {
        const SuspectEdge& edge = suspects_[crossing.edge];
        if (crossing.type == LineType::crease || !faces_end_) continue;
        mark(edge.i, edge.j);
        mark(edge.i - (edge.down ? 1 : 0), edge.j - (edge.down ? 0 : 1));
    }
    for (const auto [i, j] : marked_) {
        cross_faces(i, j, false);
        cross_faces(i, j + 1, false);
        cross_faces(i, j, true);
        cross_faces(i + 1, j, true);
    }
    if (edges_.pipeline.lines.drawing != nullptr) cross_all_faces();
    for (std::uint8_t& marks : marks_) marks &= kMarked;
}

/// The cells in which lines between faces are joined; empty: all, or there are none. A tile knows
/// which cells beside its own are marked only by crossings that it has itself.
std::span<const std::uint8_t> LineFinder::face_cells() const {
    const bool some = crosses_faces() && edges_.pipeline.lines.drawing == nullptr;
    return some ? std::span<const std::uint8_t>(marks_) : std::span<const std::uint8_t>();
}

/// Marks a cell of the grid, if it is one.
void LineFinder::mark(int i, int j) {
    if (i < 0 || j < 0 || i + 1 >= grid_.width || j + 1 >= grid_.height || marked(i, j)) return;
    marks_[grid_.index(i, j)] |= kMarked;
    marked_.push_back({i, j});
    faces_->mark(grid_.x0 + i, grid_.y0 + j);
}

/// Who asks for the lines as data wants them to go on from cell to cell.
void LineFinder::cross_all_faces() {
    for (int j = 0; j < grid_.height; ++j) {
        for (int i = 0; i < grid_.width; ++i) {
            if (i + 1 < grid_.width) cross_faces(i, j, false);
            if (j + 1 < grid_.height) cross_faces(i, j, true);
        }
    }
}

bool LineFinder::marked(int i, int j) const { return (marks_[grid_.index(i, j)] & kMarked) != 0; }

/// The same for one edge of the lattice.
void LineFinder::cross_faces(int i, int j, bool down) {
    constexpr GeometryId kFaceNumber = 0x80000000U;  // so that it equals no ID
    const int i_b = i + (down ? 0 : 1);
    const int j_b = j + (down ? 1 : 0);
    const std::size_t first = grid_.index(i, j);
    std::uint8_t& marks = marks_[first];
    const std::uint8_t crossed = down ? kCrossedDown : kCrossedRight;
    if ((marks & crossed) != 0) return;
    marks |= crossed;
    const std::size_t second = grid_.index(i_b, j_b);
    if (grid_.id[first] == kBackground || grid_.id[first] != grid_.id[second]) return;
    const LatticeHit a = hit_at(i, j);
    const LatticeHit b = hit_at(i_b, j_b);
    const std::uint32_t face_a = edges_.surfaces.face(*a.hits, a.lane);
    const std::uint32_t face_b = edges_.surfaces.face(*b.hits, b.lane);
    if (face_a == face_b) return;
    const Vec2f from = grid_.point(i, j);
    const Vec2f to = grid_.point(i_b, j_b);
    const float at =
        edges_.surfaces.face_crossing(edges_.viewpoint, from, *a.hits, a.lane, to, *b.hits, b.lane);
    Crossing crossing;
    crossing.point = from + (to - from) * at;
    crossing.type = LineType::mesh;
    crossing.t = grid_.t[first] + at * (grid_.t[second] - grid_.t[first]);
    crossing.edge = static_cast<std::uint32_t>(suspects_.size());
    crossing.first = kFaceNumber | face_a;
    crossing.second = kFaceNumber | face_b;
    crossing.nearer = grid_.id[first];
    crossings_.push_back(crossing);
    suspects_.push_back(
        {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), down, Suspicion::none});
}

/// Elsewhere they are drawn without being found (FaceEdges), and kept as data only.
void LineFinder::drop_unmarked_faces() {
    for (Segment& segment : segments_) {
        if (segment.type != LineType::mesh) continue;
        const Vec2f middle = (segment.a + segment.b) * (0.5F / grid_.spacing);
        const int i = static_cast<int>(std::floor(middle.x - 0.5F)) - grid_.x0;
        const int j = static_cast<int>(std::floor(middle.y - 0.5F)) - grid_.y0;
        segment.for_data =
            !marked(std::clamp(i, 0, grid_.width - 2), std::clamp(j, 0, grid_.height - 2));
    }
    if (edges_.pipeline.lines.drawing != nullptr) return;
    std::erase_if(segments_, [](const Segment& segment) { return segment.for_data; });
}

}  // namespace ink

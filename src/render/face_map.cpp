#include "render/face_map.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <variant>

#include "base/memory.h"
#include "base/multiversion.h"
#include "base/parallel.h"

namespace ink {

namespace {

/// Numbers of the triangles that a packet hit, of one object, whose first triangle has number
/// `first`. False if it hit another object, too.
INKTRACE_MULTIVERSION
bool number_one_object(const HitPacket& hits, std::uint32_t object, std::uint32_t first,
                       Lanes<std::uint32_t>& numbers) {
    std::uint32_t others = 0;
    for (int i = 0; i < kLanes; ++i) {
        const bool own = hits.object[i] == object;
        numbers[i] = own ? first + hits.primitive[i] : FaceMap::kNone;
        others |= own || hits.object[i] == kNoObject ? 0U : 1U;
    }
    return others == 0;
}

}  // namespace

FaceMap::FaceMap(const Scene& scene, Size size, int lattice)
    : size_(size),
      lattice_(lattice),
      blocks_across_((size.width + kBlockSide - 1) / kBlockSide),
      blocks_down_((size.height + kBlockSide - 1) / kBlockSide),
      triangles_(static_cast<std::size_t>(blocks_across_) * static_cast<std::size_t>(blocks_down_)),
      cells_(size.pixels() * static_cast<std::size_t>(lattice) * static_cast<std::size_t>(lattice)),
      blocks_(triangles_.size()) {
    use_large_pages(triangles_.data(), triangles_.size() * sizeof(triangles_[0]));
    std::uint32_t triangles = 0;
    for (const Object& object : scene.objects()) {
        meshes_.push_back(std::get_if<Mesh>(&object.shape));
        first_.push_back(triangles);
        if (meshes_.back() != nullptr) {
            triangles += static_cast<std::uint32_t>(meshes_.back()->triangles.size());
        }
    }
}

FaceMap::Triangle FaceMap::triangle(std::uint32_t number) const {
    const auto after = std::ranges::upper_bound(first_, number);
    const auto object = static_cast<std::uint32_t>(after - first_.begin()) - 1;
    return {object, number - first_[object]};
}

void FaceMap::put(int x, int y, const HitPacket& hits) {
    if (!has(x, y)) return;
    Lanes<std::uint32_t>& numbers = triangles_[block(x, y)];
    const std::uint32_t object = hits.object[0];
    const bool mesh = object != kNoObject && meshes_[object] != nullptr;
    if (!mesh || !number_one_object(hits, object, first_[object], numbers)) {
        for (int i = 0; i < kLanes; ++i) numbers[i] = number(hits, i);
    }
    clear_beyond(x, y);
}

/// Pixels of a block that lie beyond the picture see nothing.
void FaceMap::clear_beyond(int x, int y) {
    if (has(x + kBlockSide - 1, y + kBlockSide - 1)) return;
    Lanes<std::uint32_t>& numbers = triangles_[block(x, y)];
    for (int i = 0; i < kLanes; ++i) {
        if (!has(x + i % kBlockSide, y + i / kBlockSide)) numbers[i] = kNone;
    }
}

void FaceMap::put(int x, int y, const HitPacket& hits, int from) {
    if (has(x, y)) triangles_[block(x, y)][lane(x, y)] = number(hits, from);
}

void FaceMap::put_nothing(int x, int y) {
    if (has(x, y)) triangles_[block(x, y)].fill(kNone);
}

void FaceMap::mark(int i, int j) {
    if (i < 0 || j < 0 || i >= size_.width * lattice_ || j >= size_.height * lattice_) return;
    cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.width * lattice_) +
           static_cast<std::size_t>(i)] = 1;
    const int side = kBlockSide * lattice_;
    blocks_[static_cast<std::size_t>(j / side * blocks_across_ + i / side)] = 1;
}

bool FaceMap::marked(Vec2f at) const {
    const auto q = static_cast<float>(lattice_);
    const int i = static_cast<int>(std::floor(at.x * q - 0.5F));
    const int j = static_cast<int>(std::floor(at.y * q - 0.5F));
    if (i < 0 || j < 0 || i >= size_.width * lattice_ || j >= size_.height * lattice_) return false;
    return cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.width * lattice_) +
                  static_cast<std::size_t>(i)] != 0;
}

bool FaceMap::any_marked(int x, int y, float reach) const {
    if (blocks_.empty()) return false;
    // A cell begins half a lattice spacing after its block.
    const int blocks = (static_cast<int>(reach) + 1 + kBlockSide) / kBlockSide;
    const int left = std::max(x / kBlockSide - blocks, 0);
    const int right = std::min(x / kBlockSide + blocks, blocks_across_ - 1);
    const int top = std::max(y / kBlockSide - blocks, 0);
    const int bottom = std::min(y / kBlockSide + blocks, blocks_down_ - 1);
    for (int row = top; row <= bottom; ++row) {
        const std::uint8_t* first =
            blocks_.data() + static_cast<std::ptrdiff_t>(row) * blocks_across_ + left;
        if (std::memchr(first, 1, static_cast<std::size_t>(right - left + 1)) != nullptr) {
            return true;
        }
    }
    return false;
}

}  // namespace ink

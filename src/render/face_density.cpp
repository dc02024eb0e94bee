#include "render/face_density.h"

#include <numbers>

#include "render/nearest_edges.h"

namespace ink {

float face_length(int changes, float spacing) {
    // Of the 32 edges that hang on the block's points, 24 are compared.
    constexpr float kLength = std::numbers::pi_v<float> / 4.0F * 32.0F / 24.0F;
    return static_cast<float>(changes) * kLength * spacing;
}

FaceDensity::FaceDensity(LineDensity& density, float spacing, float width)
    : density_(density), spacing_(spacing) {
    for (int changes = 0; changes <= kMostChanges; ++changes) {
        amounts_.at(static_cast<std::size_t>(changes)) =
            LineDensity::amount(face_length(changes, spacing), width);
    }
}

void FaceDensity::enter(int x0, int y0, int width, int height) {
    constexpr float kMiddle = 0.5F * kBlockSide;
    x0_ = x0;
    y0_ = y0;
    columns_.clear();
    rows_.clear();
    for (int x = x0; x < x0 + width; x += kBlockSide) {
        columns_.push_back(density_.column_of((static_cast<float>(x) + kMiddle) * spacing_));
    }
    for (int y = y0; y < y0 + height; y += kBlockSide) {
        rows_.push_back(density_.row_of((static_cast<float>(y) + kMiddle) * spacing_));
    }
}

void FaceDensity::add(const Block& block, const HitPacket& hits) {
    const int changes = count_changes(hits.object, hits.primitive);
    if (changes == 0) return;
    density_.add(columns_[static_cast<std::size_t>((block.x - x0_) / kBlockSide)],
                 rows_[static_cast<std::size_t>((block.y - y0_) / kBlockSide)],
                 amounts_[static_cast<std::size_t>(changes)]);
}

}  // namespace ink

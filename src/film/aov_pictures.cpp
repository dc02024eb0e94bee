#include "film/aov_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <variant>

namespace ink {

namespace {

using Floats = Plane<float>;

std::uint32_t pack(float r, float g, float b) {
    const auto byte = [](float v) {
        return static_cast<std::uint32_t>(std::lround(std::clamp(v, 0.0F, 1.0F) * 255.0F));
    };
    return byte(r) | byte(g) << 8U | byte(b) << 16U | 0xFF000000U;
}

constexpr std::uint32_t kBlack = 0xFF000000U;

/// An even colour for an ID: its bits mixed (the finaliser of MurmurHash3), none too dark.
std::uint32_t hashed_color(std::uint32_t id) {
    if (id == 0) return kBlack;
    id ^= id >> 16U;
    id *= 0x85ebca6bU;
    id ^= id >> 13U;
    id *= 0xc2b2ae35U;
    id ^= id >> 16U;
    const auto channel = [&](unsigned shift) {
        return 0.25F + 0.75F * static_cast<float>((id >> shift) & 0xFFU) / 255.0F;
    };
    return pack(channel(0), channel(8), channel(16));
}

DisplayImage id_picture(Size size, const Plane<std::uint32_t>& ids) {
    DisplayImage image{size, Pixels(ids.size())};
    std::ranges::transform(ids, image.pixels.begin(), hashed_color);
    return image;
}

struct Range {
    float low = std::numeric_limits<float>::max();
    float high = std::numeric_limits<float>::lowest();
    float share(float value) const { return high > low ? (value - low) / (high - low) : 0.5F; }
};

Range finite_range(const Floats& values) {
    Range range;
    for (const float value : values) {
        if (!std::isfinite(value)) continue;
        range.low = std::min(range.low, value);
        range.high = std::max(range.high, value);
    }
    return range;
}

DisplayImage depth_picture(Size size, const Floats& depth) {
    const Range range = finite_range(depth);
    DisplayImage image{size, Pixels(depth.size())};
    std::ranges::transform(depth, image.pixels.begin(), [&](float z) {
        const float grey = 1.0F - 0.85F * range.share(z);
        return std::isfinite(z) ? pack(grey, grey, grey) : kBlack;
    });
    return image;
}

DisplayImage strength_picture(Size size, const Floats& strength) {
    DisplayImage image{size, Pixels(strength.size())};
    std::ranges::transform(strength, image.pixels.begin(),
                           [](float e) { return pack(1.0F - e, 1.0F - e, 1.0F - e); });
    return image;
}

/// Three planes as red, green, blue, each mapped from `ranges` to [0, 1].
DisplayImage vector_picture(Size size, const std::array<const Floats*, 3>& planes,
                            const std::array<Range, 3>& ranges) {
    DisplayImage image{size, Pixels(planes[0]->size())};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        std::array<float, 3> v{};
        bool zero = true;
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = ranges[k].share((*planes[k])[i]);
            zero &= (*planes[k])[i] == 0.0F;
        }
        image.pixels[i] = zero ? kBlack : pack(v[0], v[1], v[2]);
    }
    return image;
}

class PictureMaker {
  public:
    explicit PictureMaker(const ChannelImage& channels) : channels_(channels) {}

    std::vector<AovPicture> make() const {
        std::vector<AovPicture> pictures;
        for (const char* name : {"id.primitive", "id.part", "id.object"}) {
            if (const auto* ids = find<std::uint32_t>(name)) {
                pictures.push_back({name, id_picture(channels_.size, *ids)});
            }
        }
        if (const auto* depth = find<float>("Z")) {
            pictures.push_back({"depth", depth_picture(channels_.size, *depth)});
        }
        if (const auto planes = find_vector("N"); planes[0] != nullptr) {
            const Range unit{-1.0F, 1.0F};
            pictures.push_back(
                {"normal", vector_picture(channels_.size, planes, {unit, unit, unit})});
        }
        if (const auto planes = find_vector("P"); planes[0] != nullptr) {
            pictures.push_back(
                {"position", vector_picture(channels_.size, planes,
                                            {finite_range(*planes[0]), finite_range(*planes[1]),
                                             finite_range(*planes[2])})});
        }
        if (const auto* strength = find<float>("line.A")) {
            pictures.push_back({"lines", strength_picture(channels_.size, *strength)});
        }
        return pictures;
    }

  private:
    template <class T>
    const Plane<T>* find(std::string_view name) const {
        for (const Channel& channel : channels_.channels) {
            if (channel.name == name) return std::get_if<Plane<T>>(&channel.values);
        }
        return nullptr;
    }
    std::array<const Floats*, 3> find_vector(const std::string& name) const {
        return {find<float>(name + ".X"), find<float>(name + ".Y"), find<float>(name + ".Z")};
    }

    const ChannelImage& channels_;
};

}  // namespace

std::vector<AovPicture> aov_pictures(const ChannelImage& channels) {
    return PictureMaker(channels).make();
}

}  // namespace ink

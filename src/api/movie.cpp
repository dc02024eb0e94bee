#include <fmt/format.h>

#include <cstddef>
#include <vector>

#include "api/guard.h"
#include "inktrace/inktrace.h"
#include "io/movie_writer.h"

namespace inktrace {

struct Movie::Impl {
    Impl(const std::filesystem::path& file, int columns, int rows, double rate)
        : width(columns), height(rows), writer(file, columns, rows, rate) {}

    int width, height;
    ink::MovieWriter writer;
    std::vector<std::uint8_t> rgb{};
};

Movie::Movie(const std::filesystem::path& file, int width, int height, double rate) {
    ink::guard([&] { impl_ = std::make_unique<Impl>(file, width, height, rate); });
}
Movie::Movie(Movie&&) noexcept = default;
Movie& Movie::operator=(Movie&&) noexcept = default;
Movie::~Movie() = default;

void Movie::add(const Picture& picture) {
    ink::guard([&] {
        const auto rgba = picture.rgba();
        if (picture.width() != impl_->width || picture.height() != impl_->height || rgba.empty()) {
            throw ink::Error(fmt::format("a picture of {} x {} pixels does not fit into the film",
                                         picture.width(), picture.height()));
        }
        impl_->rgb.resize(rgba.size() / 4 * 3);
        for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
            const unsigned alpha = rgba[4 * i + 3];
            for (std::size_t c = 0; c < 3; ++c) {
                const unsigned over_white = rgba[4 * i + c] * alpha + 255U * (255U - alpha);
                impl_->rgb[3 * i + c] = static_cast<std::uint8_t>((over_white + 127U) / 255U);
            }
        }
        impl_->writer.add(impl_->rgb);
    });
}

void Movie::finish() {
    ink::guard([&] { impl_->writer.finish(); });
}

bool Movie::is_movie(const std::filesystem::path& file) { return ink::is_movie(file); }

}  // namespace inktrace

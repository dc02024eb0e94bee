#include "scene/colormap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/text.h"

namespace ink {

namespace {

// 52 colours each: every fifth of matplotlib's 256, so that the last is its last. Between them it
// is linear, which is at most two steps of 8 bits from matplotlib's own (cividis: five, in blue).
constexpr std::array<ColorMap, 8> kMaps{{
    {"viridis",
     "44015446085c471063481769481d6f482475472a7a46307e453781433d844142873f48893d4e8a3a538b"
     "38598c355e8d33638d31688e2e6d8e2c718e2a768e297b8e27808e25848e23898e218e8d20928c1f978b"
     "1e9c891fa18821a58524aa8328ae802eb37c35b7793dbc7446c06f50c46a5ac86465cb5e70cf577cd250"
     "89d54895d840a2da37b0dd2fbddf26cae11fd8e219e5e419f1e51dfde725"},
    {"cividis",
     "00224e002656002a5f002d68003070083370163770203a6f273e6e2e416d34456c3a486c3f4c6c444f6c"
     "49536c4e566c535a6d575d6d5c616e60646f656870696b716d6f727272747676767a7a787e7d78838179"
     "8885788d8878928c789690779b9476a09875a59c74aaa073afa471b5a86fbaac6dbfb06bc4b468c9b965"
     "cfbd62d4c15fdac65bdfca57e5cf52ead34cf0d846f6dd3ffce236fee838"},
    {"magma",
     "00000402020b0504160907200e0b2b140e361a104221114e29115a311165390f6e420f754a107952137c"
     "5a167e6219806a1c81721f81792282812581892881912b81992d80a1307eaa337db2357bba3878c23b75"
     "ca3e72d2426fd9466be04c67e75263ec5860f1605df4695cf7725cf97b5dfb8560fc8e64fd9869fea16e"
     "feaa74feb47bfebd82fec68afecf92fed89afde2a3fdebacfcf4b6fcfdbf"},
    {"inferno",
     "00000402020c0504170a072210092d160b391e0c45260c512f0a5b380962400a67490b6a510e6c59106e"
     "61136e69166e71196e781c6d801f6c88226a902568982766a02a63a82e5fb0315bb73557bf3952c63d4d"
     "cc4248d34743d94d3ddf5337e45a31e9612bed6925f1711ff47918f78212f98b0bfa9407fb9d07fca60c"
     "fcb014fbba1ffac42af8cd37f6d746f4e156f2ea69f2f27df5f992fcffa4"},
    {"plasma",
     "0d08871b068d2605912f059638049a41049d4903a05102a35901a56100a76900a87100a87801a88004a8"
     "8707a68e0ca49511a19c179ea21d9aa82296ae2892b42e8dba3388bf3984c43e7fc9447acd4a76d24f71"
     "d6556dda5b69de6164e26660e66c5ce97257ed7953f07f4ff3854bf58c46f79342f99a3efba139fca835"
     "fdaf31feb72dfebe2afdc627fcce25fbd724f8df25f6e826f3f027f0f921"},
    {"coolwarm",
     "3b4cc04155c8475dcf4d66d6536edd5977e25f7fe86687ed6d8ef17396f57a9df881a4fb88abfd8fb1fe"
     "96b7ff9dbdffa3c2feaac7fdb1cbfcb7cff9bed3f6c4d6f3cad8efd0daead5dbe5dadce0dfdcd9e5d9d2"
     "e9d6cbedd2c3f0cebcf3c9b4f5c4acf6bea4f7b89cf7b294f7ab8cf6a385f59c7df39475f08b6eed8366"
     "ea7a5fe57058e16751dc5d4ad65243d0473dca3b37c32e31bc1e2bb40426"},
    {"gray",
     "0000000505050a0a0a0f0f0f1414141919191e1e1e2323232828282d2d2d3232323737373c3c3c414141"
     "4646464b4b4b5050505555555a5a5a5f5f5f6464646969696e6e6e7373737878787d7d7d828282878787"
     "8c8c8c9191919696969b9b9ba0a0a0a5a5a5aaaaaaafafafb4b4b4b9b9b9bebebec3c3c3c8c8c8cdcdcd"
     "d2d2d2d7d7d7dcdcdce1e1e1e6e6e6ebebebf0f0f0f5f5f5fafafaffffff"},
    {"categories", ""},
}};

constexpr std::size_t kDigits = 6;  // of a colour

double channel(std::string_view colors, std::size_t color, std::size_t rgb) {
    return parse_hex_number(colors.substr(kDigits * color + 2 * rgb, 2)).value_or(0);
}

std::uint8_t to_byte(double value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

Rgb8 ColorMap::at(double x) const {
    if (std::isnan(x)) return {255, 20, 147};
    const std::size_t intervals = colors.size() / kDigits - 1;
    const double place = std::clamp(x, 0.0, 1.0) * static_cast<double>(intervals);
    const std::size_t below = std::min(static_cast<std::size_t>(place), intervals - 1);
    const double share = place - static_cast<double>(below);
    const auto mixed = [&](std::size_t rgb) {
        return to_byte(
            std::lerp(channel(colors, below, rgb), channel(colors, below + 1, rgb), share));
    };
    return {mixed(0), mixed(1), mixed(2)};
}

std::span<const ColorMap> color_maps() { return kMaps; }

const ColorMap* find_color_map(std::string_view name) {
    const auto* const found = std::ranges::find(kMaps, name, &ColorMap::name);
    return found == kMaps.end() ? nullptr : found;
}

Rgb8 category_color(std::size_t index) {
    constexpr std::array<Rgb8, 7> kOkabeIto{{{86, 180, 233},
                                             {230, 159, 0},
                                             {0, 158, 115},
                                             {204, 121, 167},
                                             {240, 228, 66},
                                             {213, 94, 0},
                                             {0, 114, 178}}};
    const Rgb8 base = kOkabeIto[index % kOkabeIto.size()];
    const std::size_t round = index / kOkabeIto.size() % 3;
    if (round == 0) return base;
    const double to = round == 1 ? 255.0 : 0.0;
    const double share = round == 1 ? 0.5 : 0.35;
    const auto shifted = [&](std::uint8_t c) {
        return to_byte(std::lerp(double{1} * c, to, share));
    };
    return {shifted(base.r), shifted(base.g), shifted(base.b)};
}

}  // namespace ink

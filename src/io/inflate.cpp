#include "io/inflate.h"

#include <zlib.h>

namespace ink {

bool inflate_exactly(std::string_view packed, std::span<char> out) {
    auto length = static_cast<uLongf>(out.size());
    const int result = uncompress(reinterpret_cast<Bytef*>(out.data()), &length,
                                  reinterpret_cast<const Bytef*>(packed.data()),
                                  static_cast<uLong>(packed.size()));
    return result == Z_OK && length == out.size();
}

}  // namespace ink

#include "io/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <new>

namespace ink {

std::string gzipped(std::string_view text) {
    constexpr int kGzip = 16;   // added to the window's size: a header of gzip, not of zlib
    constexpr int kMemory = 8;  // zlib's own choice
    z_stream stream{};
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, kMemory,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
        throw std::bad_alloc();
    }
    std::string packed(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
    // zlib counts in 32 bits.
    constexpr std::size_t kMost = std::size_t{1} << 30U;
    std::size_t made = 0;
    for (int result = Z_OK; result != Z_STREAM_END;) {
        const std::string_view next = text.substr(0, kMost);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next.data()));
        stream.avail_in = static_cast<uInt>(next.size());
        stream.next_out = reinterpret_cast<Bytef*>(packed.data() + made);
        stream.avail_out = static_cast<uInt>(std::min(packed.size() - made, kMost));
        result = deflate(&stream, next.size() == text.size() ? Z_FINISH : Z_NO_FLUSH);
        text.remove_prefix(next.size() - stream.avail_in);
        made = static_cast<std::size_t>(reinterpret_cast<char*>(stream.next_out) - packed.data());
    }
    deflateEnd(&stream);
    packed.resize(made);
    return packed;
}

}  // namespace ink

#include "base/plane_memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>
#include <new>
#include <type_traits>

namespace ink {

namespace {

constexpr std::size_t kSmallPage = std::size_t{4} << 10;
constexpr std::size_t kLargePage = std::size_t{2} << 20;
/// Less than this the heap keeps by itself.
constexpr std::size_t kLeast = std::size_t{128} << 10;
/// Of what is smaller; the rest begins on a page. A packet of lanes begins on a cache line.
constexpr std::align_val_t kAlignment{64};
/// The linear colours of 2048 x 2048 pixels.
constexpr std::size_t kMostKept = std::size_t{64} << 20;

/// From half a large page on, whole ones.
std::size_t in_pages(std::size_t bytes) {
    const std::size_t page = bytes < kLargePage / 2 ? kSmallPage : kLargePage;
    return (bytes + page - 1) / page * page;
}

/// Null if there is none.
char* map(std::size_t bytes) {
    const bool large = bytes % kLargePage == 0;
    const std::size_t spare = large ? kLargePage : 0;  // to begin on a page's border
    void* const all =
        mmap(nullptr, bytes + spare, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) return nullptr;
    char* const begin = static_cast<char*>(all);
    if (!large) return begin;
    const std::size_t before =
        (kLargePage - reinterpret_cast<std::uintptr_t>(all) % kLargePage) % kLargePage;
    if (before > 0) munmap(begin, before);
    if (before < spare) munmap(begin + before + bytes, spare - before);
#ifdef MADV_HUGEPAGE
    madvise(begin + before, bytes, MADV_HUGEPAGE);  // a wish, which may not be granted
#endif
    return begin + before;
}

/// What was given back, the oldest first. Never destroyed: a picture may outlive anything.
class KeptMemory {
  public:
    /// Null if there is none of that size.
    char* take(std::size_t bytes) {
        const std::scoped_lock lock(mutex_);
        for (std::size_t k = count_; k-- > 0;) {
            if (kept_[k].bytes == bytes) return remove(k);
        }
        return nullptr;
    }
    void give(char* begin, std::size_t bytes) {
        const std::scoped_lock lock(mutex_);
        while (count_ == kept_.size() || (count_ > 0 && bytes_ + bytes > kMostKept)) drop_oldest();
        if (bytes > kMostKept) {
            munmap(begin, bytes);
            return;
        }
        kept_[count_++] = {begin, bytes};
        bytes_ += bytes;
    }
    void clear() {
        const std::scoped_lock lock(mutex_);
        while (count_ > 0) drop_oldest();
    }

  private:
    struct Stretch {
        char* begin;
        std::size_t bytes;
    };

    char* remove(std::size_t k) {
        const Stretch stretch = kept_[k];
        std::copy(kept_.begin() + k + 1, kept_.begin() + count_, kept_.begin() + k);
        --count_;
        bytes_ -= stretch.bytes;
        return stretch.begin;
    }
    void drop_oldest() {
        const std::size_t bytes = kept_[0].bytes;
        munmap(remove(0), bytes);
    }

    std::mutex mutex_;
    std::array<Stretch, 16> kept_{};
    std::size_t count_ = 0;
    std::size_t bytes_ = 0;
};

constinit KeptMemory kept_memory;
static_assert(std::is_trivially_destructible_v<KeptMemory>);

}  // namespace

void* take_plane_memory(std::size_t bytes) {
    if (bytes < kLeast) return ::operator new(bytes, kAlignment);
    const std::size_t whole = in_pages(bytes);
    if (char* const begin = kept_memory.take(whole)) return begin;
    if (char* const begin = map(whole)) return begin;
    kept_memory.clear();  // perhaps that was what was missing
    if (char* const begin = map(whole)) return begin;
    throw std::bad_alloc();
}

void give_plane_memory(void* begin, std::size_t bytes) noexcept {
    if (bytes < kLeast) return ::operator delete(begin, kAlignment);
    kept_memory.give(static_cast<char*>(begin), in_pages(bytes));
}

}  // namespace ink

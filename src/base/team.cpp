#include "base/team.h"

#include <exception>
#include <thread>

namespace ink {

/// It may end while others still look whether it has items left.
struct Team::Loop {
    std::size_t count;
    const Body* body;
    std::atomic<std::size_t> next = 0;
    std::atomic<std::size_t> done = 0;
    std::mutex mutex;
    std::exception_ptr failure{};

    void work(std::size_t worker) {
        for (std::size_t item; (item = next++) < count; ++done) {
            try {
                (*body)(item, worker);
            } catch (...) {
                const std::scoped_lock lock(mutex);
                failure = std::current_exception();
            }
        }
    }
};

void Team::work(std::size_t k, std::size_t worker, const std::function<void()>& lead) {
    if (k == 0) {
        leader_ = worker;
        struct End {
            Team& team;
            ~End() { team.end(); }
        };
        const End at_last{*this};
        lead();
    }
    // What a thread takes to sleep and to wake up.
    constexpr int kPatience = 500;
    for (int waited = 0;;) {
        const std::uint32_t news = news_;
        if (help(worker)) {
            waited = 0;
        } else if (const std::size_t item = next_ < count_ ? next_++ : count_; item < count_) {
            beside_(item, worker);
            waited = 0;
        } else if (led_) {
            return;
        } else if (++waited < kPatience) {
            std::this_thread::yield();
        } else {
            news_.wait(news);
        }
    }
}

void Team::loop(std::size_t count, const Body& body) {
    const auto loop = std::make_shared<Loop>();
    loop->count = count;
    loop->body = &body;
    {
        const std::scoped_lock lock(mutex_);
        loop_ = loop;
    }
    has_loop_ = true;
    tell();
    loop->work(leader_);
    has_loop_ = false;
    {
        const std::scoped_lock lock(mutex_);
        loop_ = nullptr;
    }
    while (loop->done < count) std::this_thread::yield();
    if (loop->failure) std::rethrow_exception(loop->failure);
}

/// False if there is no loop.
bool Team::help(std::size_t worker) {
    if (!has_loop_) return false;
    std::shared_ptr<Loop> loop;
    {
        const std::scoped_lock lock(mutex_);
        loop = loop_;
    }
    if (!loop) return false;
    loop->work(worker);
    return true;
}

void Team::tell() {
    ++news_;
    news_.notify_all();
}

void Team::end() {
    led_ = true;
    tell();
}

}  // namespace ink

#include "session/loader.h"

#include <exception>
#include <utility>

namespace inktrace::viewer {

namespace {

LoadResult load_now(LoadRequest request) {
    LoadResult result;
    try {
        Scene scene;
        for (const std::filesystem::path& file : request.files) {
            result.infos.push_back(scene.load(file, request.settings, {.facts = true}));
        }
        result.primitives = scene.primitive_count();
        result.renderer = std::make_shared<const Renderer>(std::move(scene));
    } catch (const std::exception& error) {
        result.error = error.what();
    }
    result.request = std::move(request);
    return result;
}

}  // namespace

Loader::Loader(std::function<void()> done) : done_(std::move(done)), thread_([this] { run(); }) {}

Loader::~Loader() {
    {
        const std::scoped_lock lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void Loader::load(LoadRequest request) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_ = std::move(request);
    }
    changed_.notify_all();
}

std::optional<LoadResult> Loader::take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(result_, std::nullopt);
}

bool Loader::busy() const {
    const std::scoped_lock lock(mutex_);
    return running_ || waiting_;
}

void Loader::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return ending_ || waiting_; });
        if (ending_) return;
        LoadRequest request = *std::exchange(waiting_, std::nullopt);
        running_ = true;
        lock.unlock();
        LoadResult result = load_now(std::move(request));
        lock.lock();
        result_ = std::move(result);
        running_ = false;
        lock.unlock();
        done_();
        lock.lock();
    }
}

}  // namespace inktrace::viewer

#include "session/loader.h"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <utility>

#include "color_range.h"

namespace inktrace::viewer {

namespace {

LoadResult load_now(const LoadRequest& request) {
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
    return result;
}

}  // namespace

/// As `inktrace render` does for the frames of an animation. False if it was told to stop.
bool Loader::look_through(LoadRequest& request) {
    using Clock = std::chrono::steady_clock;
    Settings& settings = request.settings;
    Settings first = settings;
    first.set("frame", std::to_string(request.series.front()));
    if (settings.get("radius").empty() && request.files.size() == 1) {
        const auto radius = inspect(request.files.front(), first).chosen_radius;
        if (radius) settings.set("radius", fmt::format("{}", *radius));
    }
    Clock::time_point told{};
    bool whole = true;
    const auto go_on = [&](double share) {
        looked_through_ = share;
        constexpr auto kStep = std::chrono::milliseconds(200);
        if (Clock::now() - told > kStep) {
            told = Clock::now();
            done_();
        }
        const std::scoped_lock lock(mutex_);
        whole = !stop_ && !ending_ && !waiting_;
        return whole;
    };
    if (settings.get("color-by").empty() && request.files.size() == 1) {
        const std::string field =
            kinds_over(request.files.front(), request.series, settings, go_on);
        if (!field.empty()) settings.set("color-by", field).set("colormap", "categories");
        if (!field.empty() || !whole) return whole;
    }
    if (!settings.get("color-range").empty()) return true;
    const auto range = color_range_over(request.files, request.series, settings, go_on);
    if (range) settings.set("color-range", fmt::format("{}:{}", range->first, range->second));
    return whole;
}

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
        stop_ = false;
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
        LoadResult result;
        try {
            const bool whole = !request.series.empty() && look_through(request);
            result = load_now(request);
            result.looked_through = whole;
        } catch (const std::exception& error) {
            result.error = error.what();
        }
        looked_through_ = 0.0;
        result.request = std::move(request);
        lock.lock();
        result_ = std::move(result);
        running_ = false;
        lock.unlock();
        done_();
        lock.lock();
    }
}

}  // namespace inktrace::viewer

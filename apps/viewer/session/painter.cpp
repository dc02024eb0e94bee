#include "session/painter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <exception>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/text.h"
#include "session/history.h"

namespace inktrace::viewer {

namespace {

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double megapixels(const Picture& picture) { return 1e-6 * picture.width() * picture.height(); }

/// Side of the tiles that threads work on: rendering gives way between two of them. They differ in
/// cost, some are several times as dear as most.
int tile_side(double ms_per_megapixel, int threads) {
    constexpr double kTileMs = 8.0;
    const double pixels = kTileMs / std::max(ms_per_megapixel * threads, 1e-3) * 1e6;
    const auto side = static_cast<unsigned>(std::clamp(std::sqrt(pixels), 8.0, 64.0));
    return static_cast<int>(std::bit_floor(side));
}

/// How many rays the picture in full takes for each of one with `quick_settings`, about.
double ray_ratio(const Settings& settings) {
    const auto number = [&](const char* name) {
        return ink::parse_double(settings.get(name)).value_or(1.0);
    };
    const std::string aa = settings.get("aa");
    const std::size_t colon = aa.find(':');
    double ratio = number("lattice") * number("lattice");
    if (colon != std::string::npos) {
        ratio = std::max(ratio, ink::parse_double(aa.substr(colon + 1)).value_or(1.0));
    }
    if (settings.get("method") != "stencil") return ratio;
    const double sides = 2.0 * number("quality") + 1.0;
    return ratio * sides * sides / 9.0;
}

/// All that a picture costs by, but the view.
std::string cost_key(const Settings& settings) {
    std::string key;
    for (const auto& [name, value] : settings.changed()) {
        if (name == "size" || !is_of_view(name)) key += name + "=" + value + "\n";
    }
    return key;
}

}  // namespace

Settings quick_settings(const Settings& settings) {
    Settings quick = settings;
    quick.set("lattice", "1");
    if (settings.get("aa").starts_with("multisample")) quick.set("aa", "");
    if (settings.get("method") == "stencil") quick.set("quality", "1");
    return quick;
}

Painter::Painter(std::function<void()> news) : news_(std::move(news)), thread_([this] { run(); }) {}

Painter::~Painter() {
    {
        const std::scoped_lock lock(mutex_);
        ending_ = true;
        cancel_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void Painter::paint(PaintRequest request) {
    {
        const std::scoped_lock lock(mutex_);
        waiting_ = std::move(request);
        if (running_ && !cancel_.exchange(true)) {
            cancelled_at_ = Clock::now().time_since_epoch().count();
        }
    }
    changed_.notify_all();
}

std::optional<Painting> Painter::take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(painting_, std::nullopt);
}

std::optional<std::string> Painter::take_error() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(error_, std::nullopt);
}

bool Painter::busy() const {
    const std::scoped_lock lock(mutex_);
    return running_ || waiting_;
}

void Painter::finish(Painting painting) {
    {
        const std::scoped_lock lock(mutex_);
        painting_ = std::move(painting);
    }
    news_();
}

void Painter::quick(const PaintRequest& request) {
    const double scale = pace_.scale();
    const Settings settings = quick_settings(request.settings);
    const auto start = Clock::now();
    RenderOptions options;
    options.draft = scale;
    options.cancel = &ending_;
    auto picture = std::make_shared<const Picture>(request.renderer->render(settings, options));
    const double ms = ms_since(start);
    const double ms_per_megapixel = ms / (scale * scale * megapixels(*picture));
    shown_exactly_ = scale == 1.0 && settings.changed() == request.settings.changed();
    finish({.picture = std::move(picture),
            .settings = request.settings,
            .exact = shown_exactly_,
            .scale = scale,
            .frame_ms = ms,
            .latency_ms = ms_since(request.asked)});
    pace_.frame_took(scale, ms);
    guess_cost(request, ms_per_megapixel);
}

/// Until a picture in full tells.
void Painter::guess_cost(const PaintRequest& request, double quick_ms_per_megapixel) {
    std::string key = cost_key(request.settings);
    if (cost_of_.lock() == request.renderer && key == cost_key_) return;
    cost_of_ = request.renderer;
    cost_key_ = std::move(key);
    ms_per_megapixel_ = quick_ms_per_megapixel * ray_ratio(request.settings);
}

void Painter::in_full(const PaintRequest& request) {
    Settings settings = request.settings;
    const int threads = static_cast<int>(ink::parse_int(settings.get("threads")).value_or(0));
    const int side = tile_side(ms_per_megapixel_, threads > 0 ? threads : ink::hardware_threads());
    settings.set("tile", std::to_string(side));
    RenderOptions options;
    options.cancel = &cancel_;
    const auto start = Clock::now();
    double share = 0.0;
    options.progress = [&](double done, double /*megapixels*/) {
        // A few times a second are enough for a bar.
        constexpr double kStep = 0.05;
        progress_ = done;
        if (done < share + kStep || ms_since(start) < 200.0) return;
        share = done;
        news_();
    };
    auto picture = std::make_shared<const Picture>(request.renderer->render(settings, options));
    const double ms = ms_since(start);
    ms_per_megapixel_ = ms / megapixels(*picture);
    if (quick_settings(request.settings).changed() == request.settings.changed()) {
        pace_.full_took(ms);
    }
    finish({.picture = std::move(picture),
            .settings = request.settings,
            .exact = true,
            .frame_ms = ms,
            .latency_ms = ms_since(request.asked)});
}

/// What a frame without lines takes, seen like that: with lines it may take little longer.
void Painter::learn_plain(const PaintRequest& request) {
    Settings plain = quick_settings(request.settings);
    plain.set("lines", "none").set("hidden", "none").set("aa", "");
    const bool same_scene = plain_of_.lock() == request.renderer;
    if (same_scene && plain_settings_ == plain.changed()) return;
    RenderOptions options;
    options.cancel = &cancel_;
    double best = 1e9;
    for (int k = 0; k < 3; ++k) {
        const auto start = Clock::now();
        request.renderer->render(plain, options);
        best = std::min(best, ms_since(start));
        constexpr double kSlow = 50.0;  // no need to know better
        if (best > kSlow) break;
    }
    if (!same_scene || plain_size_ != plain.get("size")) pace_.forget();
    pace_.plain_took(best);
    plain_of_ = request.renderer;
    plain_size_ = plain.get("size");
    plain_settings_ = plain.changed();
}

void Painter::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return ending_ || waiting_; });
        if (ending_) return;
        const PaintRequest request = *std::exchange(waiting_, std::nullopt);
        running_ = true;
        progress_ = 0.0;
        try {
            if (request.in_motion) {
                lock.unlock();
                quick(request);
                lock.lock();
                // While a hand moves, the next request comes within a frame or two.
                constexpr auto kStill = std::chrono::milliseconds(60);
                changed_.wait_for(lock, kStill, [this] { return ending_ || waiting_; });
                if (ending_) return;
            }
            cancel_ = false;
            if (!waiting_ && !(request.in_motion && shown_exactly_)) {
                lock.unlock();
                in_full(request);
                lock.lock();
            }
            if (!waiting_ && !ending_) {
                lock.unlock();
                learn_plain(request);
                lock.lock();
            }
        } catch (const Error& error) {
            if (!lock.owns_lock()) lock.lock();
            if (error.kind() == Error::Kind::cancelled) {
                const Clock::time_point asked{Clock::duration(cancelled_at_.load())};
                give_way_ms_ = ms_since(asked);
                ++cancelled_;
                // What takes long to stop has tiles that are too large for its settings.
                if (give_way_ms_ > 15.0) {
                    ms_per_megapixel_ = std::max(ms_per_megapixel_ * 4.0, 8000.0);
                }
            } else {
                error_ = error.what();
            }
        } catch (const std::exception& error) {
            if (!lock.owns_lock()) lock.lock();
            error_ = error.what();
        }
        running_ = false;
        lock.unlock();
        news_();
        lock.lock();
    }
}

}  // namespace inktrace::viewer

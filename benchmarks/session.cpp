#include "session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <functional>
#include <stdexcept>

#include "session/keep_memory.h"
#include "session/waiting_owner.h"

namespace ink::bench {

namespace {

using inktrace::viewer::Clock;
using inktrace::viewer::Session;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// The value below which a share of them lies.
double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::ceil(share * last))];
}

std::array<double, 4> quantiles(const std::vector<double>& values) {
    return {quantile(values, 0.5), quantile(values, 0.95), quantile(values, 0.99),
            quantile(values, 1.0)};
}

/// What is done to a session by hand.
class Driver : public inktrace::viewer::WaitingOwner {
  public:
    void wait_for(const std::function<bool()>& done) {
        const auto settled = [&] { return done() || session.message().is_error; };
        if (!wait_until(settled, std::chrono::minutes(2))) {
            throw std::runtime_error("the session has stopped");
        }
        if (session.message().is_error) throw std::runtime_error(session.message().text);
    }
    void wait_for_picture() {
        wait_for([this] { return has_picture(); });
    }
    void turn(double right_deg, double down_deg) {
        session.move_camera(session.camera().turned(right_deg, down_deg));
    }
};

inktrace::Renderer load(const std::filesystem::path& file, const inktrace::Settings& settings) {
    inktrace::Scene scene;
    scene.load(file, settings);
    return inktrace::Renderer(std::move(scene));
}

/// What moves of a mouse, 125 a second, bring about; frames without lines are drawn in between, so
/// that a machine that slows down slows both.
class Turning {
  public:
    Turning(Driver& driver, const inktrace::Renderer& renderer)
        : driver_(driver), renderer_(renderer) {}

    void round(int frames) {
        turn(frames);
        inktrace::Settings plain = driver_.session.settings();
        plain.set("lines", "none").set("aa", "");
        constexpr int kPlain = 5;
        driver_.wait_for_picture();
        for (int k = 0; k < kPlain; ++k) {
            const auto start = Clock::now();
            renderer_.render(plain);
            if (k > 0) plain_ms.push_back(ms_since(start));
        }
    }

    std::vector<double> plain_ms, frame_ms, latency_ms, latency_frames;
    double share = 1.0;
    std::uint64_t most_pictures = 0;  ///< after an event, up to the first that shows it

  private:
    struct Event {
        std::string eye;
        Clock::time_point time;
        std::uint64_t pictures;  ///< that there were before it
    };

    void turn(int frames) {
        constexpr auto kBetweenEvents = std::chrono::milliseconds(8);
        std::deque<Event> events;
        std::uint64_t seen = driver_.session.picture_number();
        for (int shown = 0; shown < frames;) {
            driver_.turn(0.7, 0.2);
            events.push_back({driver_.session.settings().get("eye"), Clock::now(),
                              driver_.session.picture_number()});
            const auto next = Clock::now() + kBetweenEvents;
            while (Clock::now() < next) {
                driver_.take_news(next);
                if (driver_.session.picture_number() == seen) continue;
                seen = driver_.session.picture_number();
                ++shown;
                take(events);
            }
        }
    }

    /// A picture that shows an event shows all before it.
    void take(std::deque<Event>& events) {
        const inktrace::viewer::Painting& painting = driver_.session.painting();
        const std::string eye = painting.settings.get("eye");
        const auto shown =
            std::ranges::find_if(events, [&](const Event& event) { return event.eye == eye; });
        if (shown == events.end()) return;
        frame_ms.push_back(painting.frame_ms);
        share = painting.scale;
        const double before = last_ms_;
        last_ms_ = painting.frame_ms;
        for (auto event = events.begin(); event <= shown; ++event) {
            latency_ms.push_back(ms_since(event->time));
            const std::uint64_t pictures = driver_.session.picture_number() - event->pictures;
            const double frame = pictures > 1 ? 0.5 * (before + last_ms_) : last_ms_;
            latency_frames.push_back(latency_ms.back() / frame);
            most_pictures = std::max(most_pictures, pictures);
        }
        events.erase(events.begin(), shown + 1);
    }

    Driver& driver_;
    const inktrace::Renderer& renderer_;
    double last_ms_ = 0.0;  ///< that the last picture took
};

/// Moves the camera at different moments of pictures being refined.
std::vector<double> interrupt(Driver& driver, int moves) {
    std::vector<double> times;
    Session& session = driver.session;
    const auto shown = [&] {
        return session.painting().settings.get("eye") == session.settings().get("eye");
    };
    for (int k = 0; k < moves; ++k) {
        // At a moment between the beginning and the end that no period of the work hits.
        const double moment = std::fmod(0.5 + k * 0.618033988749895, 1.0) * 0.9;
        driver.wait_for(
            [&] { return shown() && (session.painting().exact || session.refinement() > moment); });
        const std::uint64_t before = session.cancelled();
        driver.turn(2.0, 0.0);
        driver.wait_for(shown);
        if (session.cancelled() != before) times.push_back(session.give_way_ms());
    }
    return times;
}

}  // namespace

SessionRow measure_session(const std::filesystem::path& file, int side, int rounds,
                           const std::vector<std::pair<std::string, std::string>>& flags) {
    inktrace::viewer::keep_memory();
    Driver driver;
    Session& session = driver.session;
    session.open({file}, flags);
    session.resize({side, side});
    driver.wait_for_picture();
    const inktrace::Renderer renderer = load(file, session.settings());
    SessionRow row{.what = file.filename().string()};

    Turning turning(driver, renderer);
    constexpr int kFrames = 20;
    turning.round(kFrames);  // the pace settles
    for (auto* const times :
         {&turning.plain_ms, &turning.frame_ms, &turning.latency_ms, &turning.latency_frames}) {
        times->clear();
    }
    for (int k = 0; k < rounds; ++k) turning.round(kFrames);
    row.plain_ms = quantile(turning.plain_ms, 0.5);
    row.turning_ms = quantile(turning.frame_ms, 0.5);
    row.rays_share = turning.share;
    row.latency_ms = quantiles(turning.latency_ms);
    row.latency_frames = quantiles(turning.latency_frames);
    row.latency_pictures = static_cast<int>(turning.most_pictures);

    driver.wait_for_picture();
    row.refined_ms = session.painting().frame_ms;
    row.rests_ms = session.painting().latency_ms;
    const inktrace::Picture expected = renderer.render(session.settings());
    row.exact = std::ranges::equal(session.painting().picture->rgba(), expected.rgba());

    const std::vector<double> times = interrupt(driver, 30 * rounds);
    row.moves = static_cast<int>(times.size());
    row.gives_way_ms = quantile(times, 0.5);
    row.gives_way_99_ms = quantile(times, 0.99);
    row.gives_way_most_ms = quantile(times, 1.0);
    return row;
}

void print_heading_of_sessions() {
    fmt::print("{:<26}{:>8}{:>8}{:>6}{:>6}{:>26}{:>28}{:>8}{:>7}{:>6}{:>24}\n", "", "no lines",
               "turning", "ratio", "rays", "latency, ms", "latency, frames", "refined", "rests",
               "exact", "gives way, ms");
    fmt::print("{:<26}{:>8}{:>8}{:>6}{:>6}{:>26}{:>28}{:>8}{:>7}{:>6}{:>24}\n", "", "ms", "ms", "",
               "", "median, 95, 99 %, most", "likewise, pictures", "ms", "ms", "",
               "median, 99 %, most");
    std::fflush(stdout);
}

void print(const SessionRow& row) {
    const auto& ms = row.latency_ms;
    const auto& frames = row.latency_frames;
    fmt::print("{:<26.25}{:>8.2f}{:>8.2f}{:>6.2f}{:>6.3g}", row.what, row.plain_ms, row.turning_ms,
               row.turning_ms / row.plain_ms, row.rays_share);
    fmt::print("{:>8.1f}{:>6.1f}{:>6.1f}{:>6.1f}", ms[0], ms[1], ms[2], ms[3]);
    fmt::print("{:>10.2f}{:>5.2f}{:>5.2f}{:>5.2f}{:>3}", frames[0], frames[1], frames[2], frames[3],
               row.latency_pictures);
    fmt::print("{:>8.0f}{:>7.0f}{:>6}{:>9.1f}{:>6.1f}{:>6.1f}{:>4}\n", row.refined_ms, row.rests_ms,
               row.exact ? "yes" : "NO", row.gives_way_ms, row.gives_way_99_ms,
               row.gives_way_most_ms, row.moves);
    std::fflush(stdout);
}

}  // namespace ink::bench

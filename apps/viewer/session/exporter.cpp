#include "session/exporter.h"

#include <exception>
#include <utility>

namespace inktrace::viewer {

Exporter::~Exporter() {
    cancel_ = true;
    end();
}

void Exporter::end() {
    if (thread_.joinable()) thread_.join();
}

bool Exporter::write(std::shared_ptr<const Renderer> renderer, Settings settings,
                     std::filesystem::path file) {
    if (busy_) return false;
    end();
    busy_ = true;
    progress_ = 0.0;
    thread_ = std::thread([this, renderer = std::move(renderer), settings = std::move(settings),
                           file = std::move(file)] {
        Result result{file, {}};
        try {
            RenderOptions options = options_for_output(file);
            options.cancel = &cancel_;
            double shown = 0.0;
            options.progress = [&](double share, double /*megapixels*/) {
                constexpr double kStep = 0.02;
                progress_ = share;
                if (share < shown + kStep) return;
                shown = share;
                news_();
            };
            renderer->render(settings, options).save(file);
        } catch (const std::exception& error) {
            result.error = error.what();
        }
        {
            const std::scoped_lock lock(mutex_);
            result_ = std::move(result);
        }
        busy_ = false;
        news_();
    });
    return true;
}

std::optional<Exporter::Result> Exporter::take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(result_, std::nullopt);
}

}  // namespace inktrace::viewer

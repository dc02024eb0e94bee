#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "accel/cost.h"
#include "accel/tracer.h"
#include "api/guard.h"
#include "api/impl.h"
#include "base/timer.h"
#include "camera/views.h"
#include "inktrace/inktrace.h"
#include "io/atomic_file.h"
#include "render/draft.h"
#include "render/pick.h"
#include "render/render.h"
#include "vector/legend.h"
#include "vector/line_art.h"

namespace inktrace {

const char* version() { return INKTRACE_VERSION; }

void remove_unfinished_files() noexcept { ink::AtomicFile::remove_unfinished(); }

struct Renderer::Impl {
    explicit Impl(std::vector<ink::Object> objects)
        : scene(std::move(objects)), tracer(ink::make_tracer(scene)) {}

    ink::Scene scene;
    std::unique_ptr<ink::Tracer> tracer;
    mutable ink::AmbientCache ambient;
    double build_ms = 0.0;
};

Renderer::Renderer(Scene scene) {
    ink::guard([&] {
        if (scene.primitive_count() == 0) throw ink::Error("there is nothing to draw");
        ink::check_memory(ink::cost_of(scene.impl().objects));
        const auto start = std::chrono::steady_clock::now();
        impl_ = std::make_unique<Impl>(std::move(scene.impl().objects));
        const std::chrono::duration<double, std::milli> time =
            std::chrono::steady_clock::now() - start;
        impl_->build_ms = time.count();
    });
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

double Renderer::build_ms() const { return impl_->build_ms; }

void validate(const Settings& settings, const RenderOptions& options) {
    if (!(options.draft > 0.0)) {
        throw Error(Error::Kind::usage, "a draft takes more than 0 rays along a pixel's side");
    }
    const int color_bytes = (options.display ? 4 : 0) + (options.linear ? 16 : 0);
    ink::guard([&] {
        const ink::Settings& inner = settings.impl().settings;
        ink::validate(inner, color_bytes);
        if (options.curves && inner.method != ink::Method::edges) {
            throw ink::UsageError(
                "--method: lines become curves with method edges only, which locates them; leave "
                "it out, or write a picture of pixels");
        }
    });
}

namespace {

/// The flags that make this picture again. What the picture does not depend on is left out: the
/// same picture must be the same file.
ink::Metadata metadata(const Settings& settings) {
    std::string flags;
    for (const auto& [name, value] : settings.changed()) {
        if (ink::find_setting(name).topic == "Run") continue;
        const bool quoted = value.find(' ') != std::string::npos;
        flags += (flags.empty() ? "--" : " --") + name + " " + (quoted ? "'" + value + "'" : value);
    }
    ink::Metadata entries{{"Software", std::string("Inktrace ") + version()}};
    if (!flags.empty()) entries.emplace_back("Settings", flags);
    return entries;
}

}  // namespace

namespace {

Settings with_view(const Settings& settings, const ink::ViewSettings& view) {
    Settings copy = settings;
    const auto text = [](ink::Vec3d v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    copy.set("eye", text(*view.eye)).set("look-at", text(*view.look_at)).set("up", text(*view.up));
    if (view.orthographic) copy.set("orthographic", fmt::format("{}", *view.orthographic));
    return copy;
}

/// Where the scene stays beside the legend.
ink::ViewSettings framed_view(const ink::Scene& scene, const ink::Settings& settings) {
    return ink::beside(ink::make_legend(scene, settings), settings.view, settings.size);
}

}  // namespace

Settings Renderer::with_camera(const Settings& settings) const {
    return ink::guard([&] {
        const ink::Settings& inner = settings.impl().settings;
        const ink::ViewSettings view = framed_view(impl_->scene, inner);
        const ink::Camera camera(impl_->scene, view, inner.size);
        return with_view(settings, ink::explicit_view(camera, impl_->scene, view));
    });
}

Settings Renderer::with_turned_camera(const Settings& settings, double turn_deg) const {
    return ink::guard([&] {
        const ink::Settings& inner = settings.impl().settings;
        return with_view(settings,
                         ink::turntable_view(impl_->scene, framed_view(impl_->scene, inner),
                                             inner.size, turn_deg));
    });
}

std::optional<Hit> Renderer::pick(const Settings& settings, double x, double y) const {
    return ink::guard([&]() -> std::optional<Hit> {
        ink::Settings inner = settings.impl().settings;
        inner.view = framed_view(impl_->scene, inner);
        const auto found = ink::pick(impl_->scene, *impl_->tracer, inner,
                                     {static_cast<float>(x), static_cast<float>(y)});
        if (!found) return std::nullopt;
        const auto array = [](ink::Vec3d v) { return std::array{v.x, v.y, v.z}; };
        return Hit{.object = impl_->scene.objects()[found->object].name,
                   .kind = std::string(found->kind),
                   .object_number = found->object + 1,
                   .primitive = found->primitive,
                   .position = array(found->position),
                   .center = array(found->center),
                   .facts = found->facts};
    });
}

Picture Renderer::render(const Settings& settings, const RenderOptions& options) const {
    validate(settings, options);
    return ink::guard([&] {
        ink::Settings inner = settings.impl().settings;
        ink::Legend legend = ink::make_legend(impl_->scene, inner);
        inner.view = ink::beside(legend, inner.view, inner.size);
        ink::RenderStats stats;
        std::function<void(double)> progress;
        if (options.progress) {
            const double megapixels = static_cast<double>(inner.size.pixels()) * 1e-6;
            progress = [&, megapixels](double share) { options.progress(share, megapixels); };
        }
        ink::Drawing drawing;
        const ink::RenderControl control{
            .progress = progress, .cancel = options.cancel, .ambient = &impl_->ambient};
        const auto draw = [&] {
            if (options.draft < 1.0) {
                return ink::render_draft(impl_->scene, *impl_->tracer, inner, options.draft,
                                         control, &stats);
            }
            return ink::render(
                impl_->scene, *impl_->tracer, inner,
                {.display = options.display, .linear = options.linear, .lines = options.inked},
                control, &stats, options.curves ? &drawing : nullptr);
        };
        Picture::Impl picture{.film = draw(),
                              .dpi = inner.dpi,
                              .aovs = inner.aovs,
                              .metadata = metadata(settings),
                              .stats = {.render_ms = stats.render_ms,
                                        .trace_ms = stats.trace_ms,
                                        .lines_ms = stats.lines_ms,
                                        .shade_ms = stats.shade_ms,
                                        .rays = stats.rays,
                                        .crossings = stats.crossings,
                                        .threads = stats.threads}};
        if (options.inked) ink::lay_over(legend, picture.film);
        if (options.curves) {
            const ink::Timer timer(picture.stats.curves_ms);
            picture.line_art =
                ink::make_line_art(impl_->scene, inner, drawing, picture.film.display());
            picture.line_art->metadata = picture.metadata;
            picture.line_art->legend = std::move(legend);
        }
        return Picture(std::make_unique<Picture::Impl>(std::move(picture)));
    });
}

}  // namespace inktrace

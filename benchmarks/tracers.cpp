#include "tracers.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "accel/tracer.h"
#include "io/reader.h"
#include "render/render.h"
#include "scenes.h"

namespace ink::bench {

namespace {

double median(std::vector<double> values) {
    std::ranges::nth_element(values,
                             values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

/// Embree for all rays: it does not take what is known of camera rays.
class ByEmbree final : public Tracer {
  public:
    explicit ByEmbree(const Scene& scene) : tracer_(make_embree_tracer(scene)) {}
    void intersect(std::span<const RayPacket> rays, std::span<HitPacket> hits,
                   Coherence coherence) const override {
        tracer_->intersect(rays, hits, coherence);
    }
    void occluded(std::span<const RayPacket> rays, std::span<const Lanes<float>> reach,
                  std::span<Lanes<std::int32_t>> blocked) const override {
        tracer_->occluded(rays, reach, blocked);
    }

  private:
    std::unique_ptr<Tracer> tracer_;
};

struct Variant {
    std::string name;
    Settings settings;
};

std::vector<Variant> variants(const Settings& base) {
    Settings plain = base;
    plain.lines = {};
    Settings lines = base;
    lines.lines = LineTypes::usual();
    lines.line_width.value = 2.0;
    return {{"no lines", plain}, {"edges, 2 px", lines}};
}

/// The faster of two frames.
double frame_ms(const Scene& scene, const Tracer& tracer, Settings settings, int threads) {
    settings.threads = threads;
    double best = 1e30;
    for (int i = 0; i < 2; ++i) {
        RenderStats stats;
        render(scene, tracer, settings, {}, {}, &stats);
        best = std::min(best, stats.render_ms);
    }
    return best;
}

void measure(const std::string& name, std::vector<Object> objects, const Settings& base, int rounds,
             const std::function<void(const TracerRow&)>& done) {
    const Scene scene(std::move(objects));
    const auto screen = make_tracer(scene);
    const ByEmbree embree(scene);
    for (const Variant& variant : variants(base)) {
        std::vector<double> by_screen;
        std::vector<double> by_embree;
        std::vector<double> ratios;
        std::vector<double> speed_ups;
        for (int round = 0; round <= rounds; ++round) {
            const double a = frame_ms(scene, *screen, variant.settings, 1);
            const double b = frame_ms(scene, embree, variant.settings, 1);
            const double c = frame_ms(scene, *screen, variant.settings, 2);
            if (round == 0) continue;  // builds hierarchies, warms caches
            by_screen.push_back(a);
            by_embree.push_back(b);
            ratios.push_back(a / b);
            speed_ups.push_back(a / c);
        }
        done({name, variant.name, median(by_screen), median(by_embree), median(ratios),
              median(speed_ups)});
    }
}

/// What a file holds, and other ways to draw it.
std::vector<NamedScene> read_file_in_all_ways(const std::string& file) {
    ReadOptions options;
    const std::string name = std::filesystem::path(file).filename().string();
    std::vector<NamedScene> scenes{{name, read_file(file, options).objects}};
    const auto add = [&](const char* as) {
        scenes.push_back({name + as, read_file(file, options).objects});
    };
    switch (scenes[0].objects.at(0).kind) {
        case ObjectKind::molecule:
            options.data.representation = Representation::ball_and_stick;
            add(", balls and sticks");
            options.data.representation = Representation::sticks;
            add(", sticks");
            break;
        case ObjectKind::particles:
            options.data.glyph = Glyph::box;
            add(", boxes");
            options.data.glyph = Glyph::ellipsoid;
            add(", ellipsoids");
            break;
        case ObjectKind::mesh:
        case ObjectKind::shape: break;
    }
    return scenes;
}

/// A scene that is made when it is measured: some are large.
struct BuiltIn {
    std::string name;
    std::function<NamedScene()> make;
    double fov_deg = 0.0;  ///< from where the scene, a unit cube, is seen small; 0: as usual
};

std::vector<BuiltIn> built_ins() {
    const auto million = [] { return random_spheres(1'000'000); };
    return {{"mixed shapes", mixed_shapes},
            {"boxes", [] { return random_boxes(100'000); }},
            {"bumpy sphere, 6", [] { return bumpy_sphere(6); }},
            {"bumpy sphere, 8", [] { return bumpy_sphere(8); }},
            {"million", million},
            {"million, small", million, 120.0},
            {"million, tiny", million, 170.0},
            {"ten million", [] { return random_spheres(10'000'000); }}};
}

Settings seen_from_afar(Settings settings, double fov_deg) {
    settings.view.eye = Vec3d{1.5, 1.3, 2.5};
    settings.view.look_at = Vec3d{0.5, 0.5, 0.5};
    settings.view.fov_deg = fov_deg;
    return settings;
}

}  // namespace

void measure_tracers(const std::vector<std::string>& files, const TracerPlan& plan,
                     const std::function<void(const TracerRow&)>& done) {
    Settings base;
    base.size = {plan.side, plan.side};
    base.shading.ambient = 0.0F;  // look plain
    for (const std::string& file : files) {
        for (NamedScene& scene : read_file_in_all_ways(file)) {
            measure(scene.name, std::move(scene.objects), base, plan.rounds, done);
        }
    }
    for (const BuiltIn& scene : built_ins()) {
        if (!plan.built_in) break;
        if (!plan.only.empty() && std::ranges::find(plan.only, scene.name) == plan.only.end()) {
            continue;
        }
        const Settings seen = scene.fov_deg > 0.0 ? seen_from_afar(base, scene.fov_deg) : base;
        measure(scene.name, scene.make().objects, seen, plan.rounds, done);
    }
}

}  // namespace ink::bench

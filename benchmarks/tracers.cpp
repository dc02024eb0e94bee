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

}  // namespace

void measure_tracers(const std::vector<std::string>& files, int side, int rounds,
                     const std::function<void(const TracerRow&)>& done) {
    Settings base;
    base.size = {side, side};
    for (const std::string& file : files) {
        for (NamedScene& scene : read_file_in_all_ways(file)) {
            measure(scene.name, std::move(scene.objects), base, rounds, done);
        }
    }
    for (NamedScene& scene : std::vector<NamedScene>{mixed_shapes(), random_boxes(100'000),
                                                     bumpy_sphere(6), bumpy_sphere(8)}) {
        measure(scene.name, std::move(scene.objects), base, rounds, done);
    }
    for (const double fov : {0.0, 120.0, 170.0}) {
        NamedScene scene = random_spheres(1'000'000);
        Settings seen = base;
        if (fov > 0.0) {
            // The scene is a unit cube.
            seen.view.eye = Vec3d{1.5, 1.3, 2.5};
            seen.view.look_at = Vec3d{0.5, 0.5, 0.5};
            seen.view.fov_deg = fov;
            scene.name += fov < 150.0 ? ", small" : ", tiny";
        }
        measure(scene.name, std::move(scene.objects), seen, rounds, done);
    }
    NamedScene many = random_spheres(10'000'000);
    measure(many.name, std::move(many.objects), base, rounds, done);
}

}  // namespace ink::bench

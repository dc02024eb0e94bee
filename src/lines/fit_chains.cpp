#include "lines/fit_chains.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "lines/path_points.h"

namespace ink {

std::vector<Curve> fit_chains(const ChainGraph& graph, const FitSettings& settings, int threads) {
    struct Worker {
        explicit Worker(const FitSettings& all) : fitter(all) {}
        CurveFitter fitter;
        PathPoints points;
        std::vector<Curve> curves;
    };
    std::vector<Curve> curves(graph.chains.size());
    const int count = threads > 0 ? threads : hardware_threads();
    std::vector<std::optional<Worker>> workers(static_cast<std::size_t>(count));
    constexpr std::size_t kGrain = 32;  // paths; most are short
    parallel_for((graph.paths.size() + kGrain - 1) / kGrain, count,
                 [&](std::size_t group, std::size_t index) {
                     if (!workers[index]) workers[index].emplace(settings);
                     Worker& worker = *workers[index];
                     const std::size_t end = std::min(graph.paths.size(), (group + 1) * kGrain);
                     for (std::size_t p = group * kGrain; p < end; ++p) {
                         const Path& path = graph.paths[p];
                         worker.points.take(graph, path);
                         worker.curves.clear();
                         worker.fitter.fit(worker.points.points, path.closed, worker.points.cuts,
                                           worker.points.corners, worker.curves);
                         for (std::size_t k = 0; k < path.steps.size(); ++k) {
                             const PathStep& step = path.steps[k];
                             Curve& curve = worker.curves[k];
                             curves[step.chain] =
                                 step.reversed ? reversed(curve) : std::move(curve);
                         }
                     }
                 });
    return curves;
}

}  // namespace ink

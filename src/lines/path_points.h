#pragma once

#include <cstddef>
#include <vector>

#include "base/vec.h"
#include "lines/chain.h"

namespace ink {

/// The points of a path, each once, and where its chains begin and end among them.
struct PathPoints {
    std::vector<Vec2f> points;
    std::vector<std::size_t> cuts;     ///< as CurveFitter::fit takes them
    std::vector<std::size_t> corners;  ///< those of the cuts at which chains were split

    void take(const ChainGraph& graph, const Path& path) {
        points.clear();
        corners.clear();
        cuts.assign(1, 0);
        for (const PathStep& step : path.steps) {
            if (step.at_corner) corners.push_back(cuts.back());
            const Chain& chain = graph.chains[step.chain];
            if (!points.empty()) points.pop_back();
            if (step.reversed) {
                points.insert(points.end(), chain.points.rbegin(), chain.points.rend());
            } else {
                points.insert(points.end(), chain.points.begin(), chain.points.end());
            }
            cuts.push_back(points.size() - 1);
        }
        if (!path.closed) return;
        const bool one_chain = graph.chains[path.steps.front().chain].closed;
        if (!one_chain) points.pop_back();
        cuts.back() = points.size();
    }
};

}  // namespace ink

#include "lines/mesh_locator.h"

#include <algorithm>
#include <cmath>

#include "lines/sample_pairs.h"

namespace ink {

void MeshLocator::locate(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                         std::span<const MeshEdge> edges, std::vector<Crossing>& crossings,
                         std::vector<std::uint32_t>& left) {
    constexpr int kMostFolds = 4;
    doubted_.clear();
    slits_.clear();
    start(grid, suspects, edges);
    for (int fold = 0; fold < kMostFolds && !open_.empty(); ++fold) {
        look(grid.spacing, crossings, left);
        check(grid.spacing, crossings, left);
    }
    for (const Search& search : open_) left.push_back(search.edge);
    if (!doubted_.empty()) drop_slits(grid, left);
}

void MeshLocator::start(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                        std::span<const MeshEdge> edges) {
    open_.clear();
    pairs_.clear();
    for (const MeshEdge& edge : edges) {
        const SuspectEdge& suspect = suspects[edge.edge];
        const int i = suspect.i + (suspect.down ? 0 : 1);
        const int j = suspect.j + (suspect.down ? 1 : 0);
        const std::size_t a = grid.index(suspect.i, suspect.j);
        const std::size_t b = grid.index(i, j);
        open_.push_back({edge.edge, static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                         grid.id[a], grid.id[b], grid.t[a] <= grid.t[b]});
        const Vec2f from = grid.point(suspect.i, suspect.j);
        const Vec2f to = grid.point(i, j);
        pairs_.push_back({from, to, edge.first, edge.second, checks_on(to - from, grid.spacing)});
    }
}

MeshChecks MeshLocator::checks_on(Vec2f way, float spacing) const {
    const float size = spacing / length(way);
    return {settings_.check_offset * size, settings_.slit_width * size};
}

/// At the meshes. What they settle is done with, of the rest `checked_` says what a ray must tell.
void MeshLocator::look(float spacing, std::vector<Crossing>& crossings,
                       std::vector<std::uint32_t>& left) {
    expected_.clear();
    checked_.clear();
    points_.clear();
    found_.resize(pairs_.size());
    ask_.cross(pairs_, found_, expected_);
    for (std::uint32_t n = 0; n < pairs_.size(); ++n) {
        const Search& search = open_[n];
        const SeenPair& pair = pairs_[n];
        const MeshCrossing& mesh = found_[n];
        Crossing crossing;
        crossing.edge = search.edge;
        crossing.first = search.first;
        crossing.second = search.second;
        crossing.first_in_front = search.first_in_front;
        crossing.point = pair.from + (pair.to - pair.from) * static_cast<float>(mesh.at);
        switch (classify(spacing, mesh, crossing)) {
            case Verdict::nothing: break;
            case Verdict::unsettled: left.push_back(search.edge); break;
            case Verdict::line:
                if (!mesh.needs_check) {
                    crossings.push_back(crossing);
                    break;
                }
                checked_.push_back({n, crossing});
                points_.push_back(mesh.checked);
        }
    }
}

/// What the rays tell; what must be looked at again stays open.
void MeshLocator::check(float spacing, std::vector<Crossing>& crossings,
                        std::vector<std::uint32_t>& left) {
    seen_.resize(points_.size());
    ask_.identify(points_, seen_);
    std::size_t open = 0;
    for (std::size_t n = 0; n < checked_.size(); ++n) {
        const auto& [number, crossing] = checked_[n];
        const MeshCrossing& mesh = found_[number];
        const Search search = open_[number];
        if (is_confirmed(mesh, seen_[n])) {
            crossings.push_back(crossing);
        } else if (goes_on(mesh, crossing, seen_[n])) {
            SeenPair pair = pairs_[number];
            (crossing.first_in_front ? pair.from : pair.to) = points_[n];
            (crossing.first_in_front ? pair.first : pair.second) = seen_[n];
            pair.checks = checks_on(pair.to - pair.from, spacing);
            pairs_[open] = pair;
            open_[open] = search;
            open_[open].first_in_front = crossing.first_in_front;
            ++open;
        } else if (mesh.in_slit != MeshCrossing::InSlit::none) {
            doubted_.push_back({search, mesh.in_slit == MeshCrossing::InSlit::first, mesh.checked});
        } else {
            left.push_back(search.edge);
        }
    }
    open_.resize(open);
    pairs_.resize(open);
}

/// Where the surface on the far side of the line goes on past the near end, that end looked into a
/// slit.
void MeshLocator::drop_slits(const SampleGrid& grid, std::vector<std::uint32_t>& left) {
    const auto seen_at = [&](std::size_t point) {
        Sample seen = grid.sample(point);
        ask_.describe(point, seen);
        return seen;
    };
    points_.clear();
    for (const Doubt& doubt : doubted_) points_.push_back(doubt.past);
    samples_.resize(points_.size());
    ask_.sample(points_, samples_);
    for (std::size_t n = 0; n < doubted_.size(); ++n) {
        const auto& [search, first, past] = doubted_[n];
        const Sample before = seen_at(first ? search.at_second : search.at_first);
        const Sample within = seen_at(first ? search.at_first : search.at_second);
        if (!is_slit(viewpoint_, before, within, samples_[n], least_turn(settings_))) {
            left.push_back(search.edge);
        } else if (first) {
            slits_.push_back(search.edge);
        }
    }
}

/// What kind of line a crossing belongs to, if to any.
MeshLocator::Verdict MeshLocator::classify(float spacing, const MeshCrossing& mesh,
                                           Crossing& crossing) const {
    using Kind = MeshCrossing::Kind;
    const Kind kind = mesh.kind;
    const bool same_id = crossing.first == crossing.second;
    if (kind == Kind::first_contour || kind == Kind::second_contour) {
        crossing.first_in_front = kind == Kind::first_contour;
    }
    crossing.nearer = crossing.first_in_front ? crossing.first : crossing.second;
    crossing.t = mesh.t;
    switch (kind) {
        case Kind::unknown: return Verdict::unsettled;
        case Kind::smooth: return same_id ? Verdict::nothing : Verdict::unsettled;
        case Kind::crease:
            if (!same_id) return Verdict::unsettled;
            crossing.type = LineType::crease;
            crossing.strength =
                crease_strength(settings_, 2.0F * std::asin(std::min(0.5F * mesh.turn, 1.0F)));
            return crossing.strength > 0.0F ? Verdict::line : Verdict::nothing;
        case Kind::first_contour:
        case Kind::second_contour: return classify_contour(spacing, mesh, crossing);
        case Kind::seam:
            crossing.type = LineType::intersection;
            return same_id ? Verdict::unsettled : Verdict::line;
    }
    return Verdict::unsettled;
}

/// A contour that touches what is behind it bounds an intersection.
MeshLocator::Verdict MeshLocator::classify_contour(float spacing, const MeshCrossing& mesh,
                                                   Crossing& crossing) const {
    const bool same_id = crossing.first == crossing.second;
    const float interval = std::ldexp(spacing, -settings_.steps);
    const bool touches = mesh.gap <= kPositionRounding + interval * mesh.footprint;
    if (touches && same_id) return Verdict::unsettled;
    crossing.type = touches       ? LineType::intersection
                    : mesh.at_rim ? LineType::boundary
                    : same_id     ? LineType::self_occlusion
                                  : LineType::silhouette;
    return Verdict::line;
}

bool MeshLocator::is_confirmed(const MeshCrossing& mesh, SurfaceKey seen) const {
    if (mesh.unless_object != SurfaceKey::kNothing && seen.object != mesh.unless_object) {
        return true;
    }
    const auto expected = std::span(expected_).subspan(mesh.first_expected, mesh.expected);
    return std::ranges::find(expected, seen) != expected.end();
}

/// At an outline, what ends may only be one of several folds of a surface; the last one counts.
/// What lies before the fold that was seen is cut off.
bool MeshLocator::goes_on(const MeshCrossing& mesh, const Crossing& crossing,
                          SurfaceKey seen) const {
    const bool within = mesh.checked_at > 0.0F && mesh.checked_at < 1.0F;
    return within && crossing.type != LineType::intersection && crossing.first != crossing.second &&
           seen.object != SurfaceKey::kNothing && ask_.id_of(seen) == crossing.nearer;
}

}  // namespace ink

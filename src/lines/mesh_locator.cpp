#include "lines/mesh_locator.h"

#include <algorithm>
#include <cmath>

#include "lines/sample_pairs.h"

namespace ink {

void MeshLocator::locate(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                         std::span<const MeshEdge> edges, const IdentifyFunction& identify,
                         const SampleFunction& sample, std::vector<Crossing>& crossings,
                         std::vector<std::uint32_t>& left) {
    constexpr int kMostFolds = 4;
    doubted_.clear();
    slits_.clear();
    start(grid, suspects, edges);
    for (int fold = 0; fold < kMostFolds && !open_.empty(); ++fold) {
        look(grid.spacing, crossings, left);
        check(identify, crossings, left);
    }
    for (const Search& search : open_) left.push_back(search.crossing.edge);
    if (!doubted_.empty()) drop_slits(grid, sample, left);
}

void MeshLocator::start(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                        std::span<const MeshEdge> edges) {
    open_.clear();
    for (const MeshEdge& edge : edges) {
        const SuspectEdge& suspect = suspects[edge.edge];
        const int i = suspect.i + (suspect.down ? 0 : 1);
        const int j = suspect.j + (suspect.down ? 1 : 0);
        Search& search = open_.emplace_back();
        search.a = grid.point(suspect.i, suspect.j);
        search.b = grid.point(i, j);
        search.first = edge.first;
        search.second = edge.second;
        const std::size_t a = grid.index(suspect.i, suspect.j);
        const std::size_t b = grid.index(i, j);
        search.crossing.edge = edge.edge;
        search.at_first = a;
        search.at_second = b;
        search.crossing.first = grid.id[a];
        search.crossing.second = grid.id[b];
        search.crossing.first_in_front = grid.t[a] <= grid.t[b];
    }
}

/// At the meshes. What they settle is done with, of the rest `checked_` says what a ray must tell.
void MeshLocator::look(float spacing, std::vector<Crossing>& crossings,
                       std::vector<std::uint32_t>& left) {
    expected_.clear();
    checked_.clear();
    points_.clear();
    for (Search& search : open_) {
        const Vec2f way = search.b - search.a;
        const float size = spacing / length(way);
        search.mesh =
            cross_(search.a, search.first, search.b, search.second,
                   {settings_.check_offset * size, settings_.slit_width * size}, expected_);
        search.crossing.point = search.a + way * static_cast<float>(search.mesh.at);
        switch (classify(spacing, search)) {
            case Verdict::nothing: break;
            case Verdict::unsettled: left.push_back(search.crossing.edge); break;
            case Verdict::line:
                if (!search.mesh.needs_check) {
                    crossings.push_back(search.crossing);
                    break;
                }
                checked_.push_back(search);
                points_.push_back(search.mesh.checked);
        }
    }
    open_.clear();
}

void MeshLocator::check(const IdentifyFunction& identify, std::vector<Crossing>& crossings,
                        std::vector<std::uint32_t>& left) {
    seen_.resize(points_.size());
    identify(points_, seen_);
    for (std::size_t n = 0; n < checked_.size(); ++n) {
        Search& search = checked_[n];
        if (is_confirmed(search.mesh, seen_[n])) {
            crossings.push_back(search.crossing);
        } else if (goes_on(search, points_[n], seen_[n])) {
            open_.push_back(search);
        } else if (search.mesh.in_slit != MeshCrossing::InSlit::none) {
            doubted_.push_back(search);
        } else {
            left.push_back(search.crossing.edge);
        }
    }
}

/// Where the surface on the far side of the line goes on past the near end, that end looked into a
/// slit.
void MeshLocator::drop_slits(const SampleGrid& grid, const SampleFunction& sample,
                             std::vector<std::uint32_t>& left) {
    points_.clear();
    for (const Search& search : doubted_) points_.push_back(search.mesh.checked);
    samples_.resize(points_.size());
    sample(points_, samples_);
    for (std::size_t n = 0; n < doubted_.size(); ++n) {
        const Search& search = doubted_[n];
        const bool first = search.mesh.in_slit == MeshCrossing::InSlit::first;
        const Sample before = grid.sample(first ? search.at_second : search.at_first);
        const Sample within = grid.sample(first ? search.at_first : search.at_second);
        if (!is_slit(viewpoint_, before, within, samples_[n], least_turn(settings_))) {
            left.push_back(search.crossing.edge);
        } else if (first) {
            slits_.push_back(search.crossing.edge);
        }
    }
}

/// What kind of line a crossing belongs to, if to any.
MeshLocator::Verdict MeshLocator::classify(float spacing, Search& search) const {
    using Kind = MeshCrossing::Kind;
    Crossing& crossing = search.crossing;
    const Kind kind = search.mesh.kind;
    const bool same_id = crossing.first == crossing.second;
    if (kind == Kind::first_limb || kind == Kind::second_limb) {
        crossing.first_in_front = kind == Kind::first_limb;
    }
    crossing.nearer = crossing.first_in_front ? crossing.first : crossing.second;
    crossing.t = search.mesh.t;
    switch (kind) {
        case Kind::unknown: return Verdict::unsettled;
        case Kind::smooth: return same_id ? Verdict::nothing : Verdict::unsettled;
        case Kind::crease:
            if (!same_id) return Verdict::unsettled;
            crossing.type = LineType::crease;
            crossing.strength = crease_strength(
                settings_, 2.0F * std::asin(std::min(0.5F * search.mesh.turn, 1.0F)));
            return crossing.strength > 0.0F ? Verdict::line : Verdict::nothing;
        case Kind::first_limb:
        case Kind::second_limb: return classify_limb(spacing, search);
        case Kind::seam:
            crossing.type = LineType::intersection;
            return same_id ? Verdict::unsettled : Verdict::line;
    }
    return Verdict::unsettled;
}

/// A limb that touches what is behind it bounds an intersection.
MeshLocator::Verdict MeshLocator::classify_limb(float spacing, Search& search) const {
    const MeshCrossing& mesh = search.mesh;
    const bool same_id = search.crossing.first == search.crossing.second;
    const float interval = std::ldexp(spacing, -settings_.steps);
    const bool touches = mesh.gap <= kPositionRounding + interval * mesh.footprint;
    if (touches && same_id) return Verdict::unsettled;
    search.crossing.type = touches       ? LineType::intersection
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
/// Cuts off what lies before the fold that was seen.
bool MeshLocator::goes_on(Search& search, Vec2f checked, SurfaceKey seen) const {
    const Crossing& crossing = search.crossing;
    const bool within = search.mesh.checked_at > 0.0F && search.mesh.checked_at < 1.0F;
    if (!within || crossing.type == LineType::intersection || crossing.first == crossing.second ||
        seen.object == SurfaceKey::kNothing || id_of_(seen) != crossing.nearer) {
        return false;
    }
    (crossing.first_in_front ? search.a : search.b) = checked;
    (crossing.first_in_front ? search.first : search.second) = seen;
    return true;
}

}  // namespace ink

#include "render/specular_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace ink {

namespace {

constexpr std::uint32_t kNoBlock = 0xFFFFFFFFU;

/// What a path leaves the scene to see is taken to lie this far away, in a scene of size 1: a
/// surface like any other, with a normal and a depth.
constexpr float kSkyDistance = 100.0F;

/// Two crossings of a lattice edge are one line if they are no farther apart, in lattice spacings:
/// three last intervals of the bisection.
constexpr float kSamePlace = 3.0F / 64.0F;

Vec3f direction(const RayPacket& rays, int lane) {
    return {rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]};
}

std::uint64_t bits(Vec2f point) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(point.y)} << 32U |
           std::bit_cast<std::uint32_t>(point.x);
}

std::uint32_t edge_key(const SuspectEdge& edge) {
    return static_cast<std::uint32_t>(edge.j) << 16U | static_cast<std::uint32_t>(edge.i) << 1U |
           (edge.down ? 1U : 0U);
}

}  // namespace

SpecularSearch::SpecularSearch(const EdgesPlan& edges)
    : edges_(edges),
      sampler_(*edges.pipeline.frame, edges.pipeline.camera),
      paths_(edges.pipeline),
      locator_(edges.viewpoint, edges.locate) {}

void SpecularSearch::follow(const SampleGrid& lattice, const LatticeHits& hits,
                            std::span<ColorPacket> colors) {
    grid_.x0 = lattice.x0;
    grid_.y0 = lattice.y0;
    grid_.spacing = lattice.spacing;
    grid_.resize(lattice.width, lattice.height);
    blocks_.assign(hits.blocks.begin(), hits.blocks.end());
    blocks_across_ = (grid_.width + kBlockSide - 1) / kBlockSide;
    const int blocks_down = (grid_.height + kBlockSide - 1) / kBlockSide;
    block_at_.assign(static_cast<std::size_t>(blocks_across_ * blocks_down), kNoBlock);
    table_.clear();
    legs_.clear();
    first_leg_.clear();
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
        first_leg_.push_back(static_cast<std::uint32_t>(legs_.size()));
        const int i = (blocks_[k].x - grid_.x0) / kBlockSide;
        const int j = (blocks_[k].y - grid_.y0) / kBlockSide;
        block_at_[static_cast<std::size_t>(j * blocks_across_ + i)] = static_cast<std::uint32_t>(k);
        if (!paths_.goes_on(hits.hits[k])) continue;
        paths_.follow(hits.rays[k], hits.points[k], hits.hits[k], hits.normals[k], table_, legs_,
                      colors[k]);
    }
    first_leg_.push_back(static_cast<std::uint32_t>(legs_.size()));
}

const PathLeg* SpecularSearch::leg_of(std::size_t block, int level) const {
    const std::uint32_t leg = first_leg_[block] + static_cast<std::uint32_t>(level - 1);
    return leg < first_leg_[block + 1] ? &legs_[leg] : nullptr;
}

SpecularSearch::LegLane SpecularSearch::leg_at(std::size_t point, int level) const {
    const auto width = static_cast<std::size_t>(grid_.width);
    const int i = static_cast<int>(point % width);
    const int j = static_cast<int>(point / width);
    const std::uint32_t block =
        block_at_[static_cast<std::size_t>(j / kBlockSide * blocks_across_ + i / kBlockSide)];
    const PathLeg* leg = block == kNoBlock ? nullptr : leg_of(block, level);
    return {leg, j % kBlockSide * kBlockSide + i % kBlockSide};
}

void SpecularSearch::search(std::span<const SuspectEdge> suspects, std::span<const Crossing> direct,
                            std::vector<Segment>& segments) {
    crossed_.clear();
    if (legs_.empty()) return;
    remember(suspects, direct);
    for (int level = 1; level <= edges_.pipeline.settings.specular_depth; ++level) {
        fill_grid(level);
        detect(grid_, edges_.detect, suspects_);
        std::erase_if(suspects_, [&](const SuspectEdge& edge) { return is_smooth(edge, level); });
        if (suspects_.empty()) continue;
        locator_.locate(
            grid_, suspects_,
            [&](std::size_t point, Sample& sample) {
                const LegLane at = leg_at(point, level);
                if (sample.id != kBackground) complete(*at.leg, at.lane, sample);
            },
            [&](std::span<const Vec2f> points, std::span<Sample> out) {
                sample(level, points, out);
            },
            crossings_);
        connector_.connect(grid_, suspects_, crossings_, found_);
        crossing_count_ += crossings_.size();
        find_repeated();
        take(level, segments);
        remember(suspects_, crossings_);
    }
}

/// What lattice points see at a level, by numbers of the table; background where paths are shorter.
void SpecularSearch::fill_grid(int level) {
    std::ranges::fill(grid_.id, kBackground);
    const Shader& shader = edges_.pipeline.shader;
    NormalPacket normals;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
        const PathLeg* leg = leg_of(k, level);
        if (leg == nullptr) continue;
        shader.line_normals(leg->hits, normals);
        for (int lane = 0; lane < kLanes; ++lane) {
            const int i = lane % kBlockSide;
            const int j = lane / kBlockSide;
            if (i >= blocks_[k].columns || j >= blocks_[k].rows) continue;
            const Sample sample = sample_of(*leg, normals, lane);
            if (sample.id == kBackground) continue;
            const std::size_t n =
                grid_.index(blocks_[k].x - grid_.x0 + i, blocks_[k].y - grid_.y0 + j);
            grid_.id[n] = sample.id;
            grid_.px[n] = sample.position.x;
            grid_.py[n] = sample.position.y;
            grid_.pz[n] = sample.position.z;
            grid_.nx[n] = sample.normal.x;
            grid_.ny[n] = sample.normal.y;
            grid_.nz[n] = sample.normal.z;
            grid_.t[n] = sample.t;
        }
    }
}

/// Without what `complete` adds.
Sample SpecularSearch::sample_of(const PathLeg& leg, const NormalPacket& normals, int lane) {
    Sample sample;
    if (leg.rays.active[lane] == 0) return sample;
    const bool sky = leg.hits.object[lane] == kNoObject;
    const GeometryId id =
        sky ? kBackground
            : edges_.pipeline.ids.resolve(leg.hits.object[lane], leg.hits.primitive[lane]);
    const Vec3f dir = direction(leg.rays, lane);
    const float t = sky ? kSkyDistance : leg.hits.t[lane];
    sample.id = table_.seen(leg.path[lane], id);
    sample.position =
        Vec3f{leg.rays.origin_x[lane], leg.rays.origin_y[lane], leg.rays.origin_z[lane]} + dir * t;
    sample.normal = sky ? -dir : Vec3f{normals.x[lane], normals.y[lane], normals.z[lane]};
    sample.t = leg.before[lane] + t;
    return sample;
}

/// Adds what a grid does not keep. That a hit lies on a ball is left out: its outline has a closed
/// form only where it is seen directly.
void SpecularSearch::complete(const PathLeg& leg, int lane, Sample& sample) const {
    edges_.surfaces.describe(leg.hits, lane, sample);
    sample.ball = {};
    sample.ray = direction(leg.rays, lane);
}

/// Whether what was seen rules out a line that the samples alone let suspect.
bool SpecularSearch::is_smooth(const SuspectEdge& edge, int level) const {
    if (edge.suspicion == Suspicion::id) return false;
    const LegLane a = leg_at(grid_.index(edge.i, edge.j), level);
    const LegLane b = leg_at(
        edge.down ? grid_.index(edge.i, edge.j + 1) : grid_.index(edge.i + 1, edge.j), level);
    if (a.leg->hits.object[a.lane] == kNoObject) return true;
    return edges_.surfaces.smooth_between(a.leg->hits, a.lane, b.leg->hits, b.lane);
}

/// More samples, for the bisection.
void SpecularSearch::sample(int level, std::span<const Vec2f> points, std::span<Sample> out) {
    if (points.empty()) return;
    const Shader& shader = edges_.pipeline.shader;
    sampler_.trace_points(points, point_hits_);
    NormalPacket normals;
    for (std::size_t k = 0; k < point_hits_.size(); ++k) {
        shader.smooth(point_hits_[k], normals);
        point_legs_.clear();
        paths_.follow(sampler_.packets()[k], point_hits_[k], normals, level, table_, point_legs_);
        const bool reached = point_legs_.size() == static_cast<std::size_t>(level);
        if (reached) shader.line_normals(point_legs_.back().hits, normals);
        const std::size_t first = k * kLanes;
        const std::size_t count = std::min<std::size_t>(kLanes, points.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
            Sample& sample = out[sampler_.order()[first + n]];
            sample = {};
            if (!reached) continue;
            const auto lane = static_cast<int>(n);
            sample = sample_of(point_legs_.back(), normals, lane);
            if (sample.id != kBackground) complete(point_legs_.back(), lane, sample);
        }
    }
}

/// Which crossings of this level are lines of a lower one: where a mirror ends or has an edge, what
/// is seen in it jumps, too.
void SpecularSearch::find_repeated() {
    repeated_.clear();
    const float most = kSamePlace * grid_.spacing;
    for (const Crossing& crossing : crossings_) {
        const auto [begin, end] = crossed_.equal_range(edge_key(suspects_[crossing.edge]));
        const bool known = std::any_of(begin, end, [&](const auto& lower) {
            const Vec2f d = lower.second - crossing.point;
            return std::max(std::abs(d.x), std::abs(d.y)) <= most;
        });
        if (known) repeated_.insert(bits(crossing.point));
    }
}

void SpecularSearch::remember(std::span<const SuspectEdge> suspects,
                              std::span<const Crossing> crossings) {
    for (const Crossing& crossing : crossings) {
        crossed_.emplace(edge_key(suspects[crossing.edge]), crossing.point);
    }
}

/// Whether a segment is a line of this level: between what is seen by one path, and not the place
/// of a line of a lower level.
bool SpecularSearch::belongs(const Segment& segment) const {
    const auto one_path = [&](GeometryId left, GeometryId right) {
        return left != kBackground && right != kBackground &&
               table_.path(left) == table_.path(right);
    };
    if (!one_path(segment.left, segment.right)) return false;
    const bool repeats_b = !segment.spans_cell || repeated_.contains(bits(segment.b));
    return !repeated_.contains(bits(segment.a)) || !repeats_b;
}

void SpecularSearch::take(int level, std::vector<Segment>& segments) {
    for (Segment& segment : found_) {
        if (!belongs(segment)) continue;
        for (GeometryId* id : {&segment.left, &segment.right, &segment.left_at_b,
                               &segment.right_at_b, &segment.owner}) {
            *id = table_.geometry(*id);
        }
        segment.level = static_cast<std::uint8_t>(level);
        segments.push_back(segment);
    }
}

}  // namespace ink

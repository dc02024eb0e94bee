#include "lines/connect.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/multiversion.h"

namespace ink {

namespace {

// Sides of a cell, clockwise.
constexpr int kTop = 0;
constexpr int kRight = 1;
constexpr int kBottom = 2;
constexpr int kLeft = 3;

float distance_squared(Vec2f a, Vec2f b) {
    const Vec2f d = b - a;
    return d.x * d.x + d.y * d.y;
}

/// Not quite the ends: where a line ends on another one, that one goes on to both sides.
Vec2f nearest_within(Vec2f p, Vec2f a, Vec2f b) {
    const Vec2f d = b - a;
    const float squared = d.x * d.x + d.y * d.y;
    if (squared == 0.0F) return a;
    const float s = ((p.x - a.x) * d.x + (p.y - a.y) * d.y) / squared;
    return a + d * std::clamp(s, 0.02F, 0.98F);
}

}  // namespace

/// Of a crossing on a side of cell (i, j): `corners` are the samples at the cell's corners,
/// clockwise from its upper left one, which lies at `corner` on the screen.
INKTRACE_INLINE Connector::Port Connector::make_port(const Corners& corners, Vec2f corner,
                                                     float per_spacing, int side,
                                                     const Crossing& crossing) {
    Port port{0.0F,
              &crossing,
              crossing.first,
              crossing.second,
              corners[static_cast<std::size_t>(side)],
              corners[static_cast<std::size_t>(side + 1) % 4],
              crossing.first_in_front};
    const Vec2f inside = (crossing.point - corner) * per_spacing;
    switch (side) {
        case kTop: port.way = inside.x; break;
        case kRight: port.way = 1.0F + inside.y; break;
        case kBottom: port.way = 3.0F - inside.x; break;
        default: port.way = 4.0F - inside.y; break;
    }
    if (side == kBottom || side == kLeft) {  // walked from the edge's second end to its first
        std::swap(port.before, port.after);
        port.before_in_front = !port.before_in_front;
    }
    return port;
}

/// Whether a line can run between two neighbouring ports without cutting another.
INKTRACE_INLINE bool Connector::one_line(const Port& p, const Port& q) {
    return p.before == q.after && p.after == q.before &&
           (p.before != p.after || p.crossing->type == q.crossing->type);
}

INKTRACE_INLINE Segment& Connector::add_segment(const Port& from, Vec2f to,
                                                std::vector<Segment>& segments) {
    const Crossing& p = *from.crossing;
    Segment& segment = segments.emplace_back();
    segment.a = p.point;
    segment.b = to;
    segment.type = segment.type_at_b = p.type;
    segment.strength = p.strength;
    segment.t = p.t;
    segment.owner = p.nearer;
    // Lines between faces are told apart by the faces, and lie within one geometry.
    const bool mesh = p.type == LineType::mesh;
    segment.left = segment.left_at_b = mesh ? p.nearer : from.after;
    segment.right = segment.right_at_b = mesh ? p.nearer : from.before;
    segment.left_in_front = segment.left_in_front_at_b = !from.before_in_front;
    segment.left_sample = from.after_sample;
    segment.right_sample = from.before_sample;
    return segment;
}

/// Going clockwise round the cell, a line that enters it at `from` has what comes after that port
/// on its left (y points down).
INKTRACE_INLINE void Connector::add_segment(const Port& from, const Port& to,
                                            std::vector<Segment>& segments) {
    const Crossing& p = *from.crossing;
    const Crossing& q = *to.crossing;
    Segment& segment = add_segment(from, q.point, segments);
    segment.spans_cell = true;
    segment.strength = 0.5F * (p.strength + q.strength);
    segment.t = 0.5F * (p.t + q.t);
    segment.type_at_b = q.type;
    const bool mesh = q.type == LineType::mesh;
    segment.left_at_b = mesh ? q.nearer : to.before;
    segment.right_at_b = mesh ? q.nearer : to.after;
    segment.left_in_front_at_b = to.before_in_front;
}

void Connector::connect(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                        std::span<const Crossing> crossings, std::vector<Segment>& segments,
                        std::span<const std::uint8_t> face_cells) {
    segments.clear();
    if (crossings.empty()) return;
    count_members(grid, edges, crossings, face_cells);
    segments.reserve(crossings.size());
    // Most cells have none, or one, which there is nothing to join with: eight at a time.
    constexpr std::uint64_t kTwoOrMore = 0x0202020202020202U;
    for (int j = 0; j < grid.height - 1; ++j) {
        const std::uint8_t* const row = counts_.data() + static_cast<std::size_t>(j) * stride_;
        for (std::size_t first = 0; first < stride_; first += 8) {
            std::uint64_t eight = 0;
            std::memcpy(&eight, row + first, 8);
            for (eight &= kTwoOrMore; eight != 0; eight &= eight - 1) {
                const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(eight)) / 8;
                connect_cell(grid, crossings, static_cast<int>(i), j, segments);
            }
        }
    }
}

void Connector::count_members(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                              std::span<const Crossing> crossings,
                              std::span<const std::uint8_t> face_cells) {
    const int across = grid.width - 1;
    const int down = grid.height - 1;
    stride_ = static_cast<std::size_t>(across + 7) / 8 * 8;
    const std::size_t cells = stride_ * static_cast<std::size_t>(down);
    counts_.assign(cells, 0);
    members_.resize(cells);
    more_.clear();
    const auto add = [&](int i, int j, int side, std::size_t crossing) {
        if (i < 0 || j < 0 || i >= across || j >= down) return;
        if (!face_cells.empty() && crossings[crossing].type == LineType::mesh &&
            face_cells[grid.index(i, j)] == 0) {
            return;
        }
        const std::size_t cell =
            static_cast<std::size_t>(j) * stride_ + static_cast<std::size_t>(i);
        const Member member = static_cast<Member>(side) << 30U | static_cast<Member>(crossing);
        if (counts_[cell] < 2) {
            members_[cell][counts_[cell]++] = member;
        } else {
            counts_[cell] = 3;
            more_.emplace_back(cell, member);
        }
    };
    for (std::size_t k = 0; k < crossings.size(); ++k) {
        const SuspectEdge& edge = edges[crossings[k].edge];
        add(edge.i, edge.j, edge.down ? kLeft : kTop, k);
        add(edge.down ? edge.i - 1 : edge.i, edge.down ? edge.j : edge.j - 1,
            edge.down ? kRight : kBottom, k);
    }
    std::ranges::sort(more_);
}

void Connector::connect_cell(const SampleGrid& grid, std::span<const Crossing> crossings, int i,
                             int j, std::vector<Segment>& segments) {
    const std::size_t cell = static_cast<std::size_t>(j) * stride_ + static_cast<std::size_t>(i);
    const auto upper = static_cast<std::uint32_t>(grid.index(i, j));
    const auto lower = static_cast<std::uint32_t>(grid.index(i, j + 1));
    const Corners corners{upper, upper + 1, lower + 1, lower};
    const Vec2f corner = grid.point(i, j);
    const float per_spacing = 1.0F / grid.spacing;
    const auto port = [&](Member member) {
        return make_port(corners, corner, per_spacing, static_cast<int>(member >> 30U),
                         crossings[member & 0x3FFFFFFFU]);
    };
    Port p = port(members_[cell][0]);
    Port q = port(members_[cell][1]);
    if (counts_[cell] == 2) {
        if (q.way < p.way) std::swap(p, q);
        if (one_line(p, q)) {
            add_segment(p, q, segments);
            return;
        }
    }
    // In an order that does not depend on that of the crossings.
    cell_members_.assign(members_[cell].begin(), members_[cell].end());
    auto more = std::ranges::lower_bound(more_, cell, {}, &std::pair<std::size_t, Member>::first);
    for (; more != more_.end() && more->first == cell; ++more)
        cell_members_.push_back(more->second);
    std::ranges::sort(cell_members_);
    ports_.clear();
    for (const Member member : cell_members_) ports_.push_back(port(member));
    first_segment_ = segments.size();
    join_ports(segments);
}

void Connector::join_ports(std::vector<Segment>& segments) {
    std::ranges::sort(ports_, {}, &Port::way);
    while (ports_.size() >= 2 && join_best_pair(segments)) {
    }
    if (!ports_.empty()) join_junction(segments);
}

/// Joins the two neighbouring ports, if any, between which a line can run without cutting another:
/// the ID before the first is the ID after the second, and both are of one type. Prefers short
/// ways, and ports on different sides: a wire is to be followed, not cut off.
bool Connector::join_best_pair(std::vector<Segment>& segments) {
    const std::size_t count = ports_.size();
    std::size_t best = count;
    float best_cost = std::numeric_limits<float>::max();
    for (std::size_t k = 0; k < count; ++k) {
        const Port& p = ports_[k];
        const Port& q = ports_[(k + 1) % count];
        if (!one_line(p, q) || (count == 2 && k == 1)) continue;
        const bool same_side = std::floor(p.way) == std::floor(q.way);
        const float cost =
            distance_squared(p.crossing->point, q.crossing->point) + (same_side ? 1e6F : 0.0F);
        if (cost < best_cost) {
            best = k;
            best_cost = cost;
        }
    }
    if (best == count) return false;
    add_segment(ports_[best], ports_[(best + 1) % count], segments);
    const std::size_t second = (best + 1) % count;
    ports_.erase(ports_.begin() + static_cast<std::ptrdiff_t>(std::max(best, second)));
    ports_.erase(ports_.begin() + static_cast<std::ptrdiff_t>(std::min(best, second)));
    return true;
}

/// Joins what no pair was found for. If one geometry is in front at exactly two ports, its outline
/// goes through and the others end on it; else all meet in the middle.
void Connector::join_junction(std::vector<Segment>& segments) {
    if (ports_.size() == 1) {
        // A crease or a jump that ends on another line, or fades out.
        if (segments.size() == first_segment_) return;
        const Vec2f from = ports_[0].crossing->point;
        Vec2f end;
        float least = std::numeric_limits<float>::max();
        for (std::size_t k = first_segment_; k < segments.size(); ++k) {
            const Vec2f foot = nearest_within(from, segments[k].a, segments[k].b);
            if (distance_squared(from, foot) >= least) continue;
            least = distance_squared(from, foot);
            end = foot;
        }
        add_segment(ports_[0], end, segments);
        return;
    }
    const auto is_line = [](const Port& p) { return p.crossing->nearer != kNobody; };
    if (ports_.size() == 3 && std::ranges::count_if(ports_, is_line) == 2) {
        std::ranges::stable_partition(ports_, is_line);
        return end_last_on_others(segments);
    }
    for (const Port& owner : ports_) {
        const GeometryId front = owner.crossing->nearer;
        const auto owned = [&](const Port& p) {
            return p.crossing->nearer == front && p.crossing->first != p.crossing->second;
        };
        if (ports_.size() != 3 || std::ranges::count_if(ports_, owned) != 2) continue;
        std::ranges::stable_partition(ports_, owned);
        return end_last_on_others(segments);
    }
    Vec2f middle;
    for (const Port& port : ports_) middle = middle + port.crossing->point;
    middle = middle * (1.0F / static_cast<float>(ports_.size()));
    for (const Port& port : ports_) add_segment(port, middle, segments);
}

/// Of three ports: the first two are one line, on which the third ends.
void Connector::end_last_on_others(std::vector<Segment>& segments) {
    add_segment(ports_[0], ports_[1], segments);
    const Segment through = segments.back();
    add_segment(ports_[2], nearest_within(ports_[2].crossing->point, through.a, through.b),
                segments);
}

}  // namespace ink

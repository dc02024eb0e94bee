#include "lines/connect.h"

#include <algorithm>
#include <bit>
#include <cmath>
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

/// The samples at a cell's corners, clockwise from its upper left one.
INKTRACE_INLINE Connector::Corners Connector::corners_of(const SampleGrid& grid, int i, int j) {
    const auto upper = static_cast<std::uint32_t>(grid.index(i, j));
    const auto lower = static_cast<std::uint32_t>(grid.index(i, j + 1));
    return {upper, upper + 1, lower + 1, lower};
}

/// Of a crossing on a side of a cell, but for its way.
INKTRACE_INLINE Connector::Port Connector::make_port(const Corners& corners, int side,
                                                     const Crossing& crossing) {
    const std::uint32_t before = corners[static_cast<std::size_t>(side)];
    const std::uint32_t after = corners[static_cast<std::size_t>(side + 1) % 4];
    // Some sides are walked from the edge's second end to its first.
    const bool back = side == kBottom || side == kLeft;
    return {0.0F,
            &crossing,
            back ? crossing.second : crossing.first,
            back ? crossing.first : crossing.second,
            before,
            after,
            crossing.first_in_front != back};
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
    place(grid, edges, crossings);
    segments.reserve(crossings.size());
    // Most cells have no crossing, or one, which there is nothing to join with: 64 at a time.
    for (int j = 0; j < grid.height - 1; ++j) {
        const EdgeBits* const row = edge_bits_.data() + static_cast<std::size_t>(j) * words_;
        for (std::size_t word = 0; word < words_; ++word) {
            const EdgeBits& here = row[word];
            const EdgeBits& below = row[word + words_];
            const EdgeBits& next = row[word + 1];  // its first point is the right end of the last
            const std::uint64_t on_right = here.down >> 1U | next.down << 63U;
            const std::uint64_t several = here.several_right | here.several_down |
                                          below.several_right | here.several_down >> 1U |
                                          next.several_down << 63U;
            const std::uint64_t one_across = here.right ^ below.right;
            const std::uint64_t two_across = here.right & below.right;
            const std::uint64_t one_along = here.down ^ on_right;
            const std::uint64_t two_along = here.down & on_right;
            const std::uint64_t two =
                (one_across & one_along) | ((two_across ^ two_along) & ~(one_across | one_along));
            const int cells = grid.width - 1 - static_cast<int>(word * 64);
            std::uint64_t rest = two | two_across | two_along | several;
            if (cells < 64) rest &= (std::uint64_t{1} << static_cast<unsigned>(cells)) - 1;
            for (; rest != 0; rest &= rest - 1) {
                const int k = std::countr_zero(rest);
                const auto side = [&](std::uint64_t bits, int number) {
                    return static_cast<std::uint32_t>(bits >> k & 1U) << number;
                };
                const std::uint32_t sides = side(here.right, kTop) | side(on_right, kRight) |
                                            side(below.right, kBottom) | side(here.down, kLeft);
                const int i = static_cast<int>(word * 64) + k;
                const bool plain = face_cells.empty() && ((two & ~several) >> k & 1U) != 0;
                if (plain && connect_two(grid, crossings, i, j, sides, segments)) continue;
                const bool with_faces = face_cells.empty() || face_cells[grid.index(i, j)] != 0;
                connect_cell(grid, crossings, i, j, sides, with_faces, segments);
            }
        }
    }
}

/// Finds out where crossings are.
void Connector::place(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                      std::span<const Crossing> crossings) {
    words_ = static_cast<std::size_t>(grid.width + 63) / 64;
    // One more, as the right neighbour of the last.
    edge_bits_.assign(words_ * static_cast<std::size_t>(grid.height) + 1, {});
    const std::size_t points =
        static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
    if (first_.size() < 2 * points) first_.resize(2 * points);
    more_.clear();
    for (std::size_t k = 0; k < crossings.size(); ++k) {
        const SuspectEdge& edge = edges[crossings[k].edge];
        const std::size_t number = 2 * grid.index(edge.i, edge.j) + (edge.down ? 1 : 0);
        const std::uint64_t bit = std::uint64_t{1} << edge.i % 64U;
        EdgeBits& some = edge_bits_[edge.j * words_ + edge.i / 64U];
        std::uint64_t& has_one = edge.down ? some.down : some.right;
        if ((has_one & bit) == 0) {
            has_one |= bit;
            first_[number] = static_cast<std::uint32_t>(k);
        } else {
            (edge.down ? some.several_down : some.several_right) |= bit;
            more_.emplace_back(number, static_cast<std::uint32_t>(k));
        }
    }
    std::ranges::sort(more_);
}

namespace {

/// Of the edge on a side of cell (i, j).
INKTRACE_INLINE std::size_t edge_number(const SampleGrid& grid, int i, int j, int side) {
    const std::array<std::size_t, 4> from_first{0, 3, 2 * static_cast<std::size_t>(grid.width), 1};
    return 2 * grid.index(i, j) + from_first[static_cast<std::size_t>(side)];
}

}  // namespace

/// The common case, of one crossing on each of two sides. False if they are not one line's.
INKTRACE_INLINE bool Connector::connect_two(const SampleGrid& grid,
                                            std::span<const Crossing> crossings, int i, int j,
                                            std::uint32_t sides,
                                            std::vector<Segment>& segments) const {
    const Corners corners = corners_of(grid, i, j);
    const auto port = [&](std::uint32_t bits) {
        const int side = std::countr_zero(bits);
        return make_port(corners, side, crossings[first_[edge_number(grid, i, j, side)]]);
    };
    const Port p = port(sides);
    const Port q = port(sides & (sides - 1));
    if (!one_line(p, q)) return false;
    add_segment(p, q, segments);
    return true;
}

void Connector::connect_cell(const SampleGrid& grid, std::span<const Crossing> crossings, int i,
                             int j, std::uint32_t sides, bool with_faces,
                             std::vector<Segment>& segments) {
    // In an order that does not depend on that of the crossings.
    cell_members_.clear();
    for (; sides != 0; sides &= sides - 1) {
        const int side = std::countr_zero(sides);
        const auto add = [&](std::uint32_t crossing) {
            if (!with_faces && crossings[crossing].type == LineType::mesh) return;
            cell_members_.push_back(static_cast<Member>(side) << 30U | crossing);
        };
        const std::size_t edge = edge_number(grid, i, j, side);
        add(first_[edge]);
        auto more = std::ranges::lower_bound(more_, edge, {}, &decltype(more_)::value_type::first);
        for (; more != more_.end() && more->first == edge; ++more) add(more->second);
    }
    const Corners corners = corners_of(grid, i, j);
    const Vec2f corner = grid.point(i, j);
    const float per_spacing = 1.0F / grid.spacing;
    ports_.clear();
    for (const Member member : cell_members_) {
        const auto side = static_cast<int>(member >> 30U);
        const Crossing& crossing = crossings[member & 0x3FFFFFFFU];
        Port& port = ports_.emplace_back(make_port(corners, side, crossing));
        const Vec2f inside = (crossing.point - corner) * per_spacing;
        switch (side) {
            case kTop: port.way = inside.x; break;
            case kRight: port.way = 1.0F + inside.y; break;
            case kBottom: port.way = 3.0F - inside.x; break;
            default: port.way = 4.0F - inside.y; break;
        }
    }
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

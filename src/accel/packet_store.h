#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "accel/cluster_bands.h"
#include "accel/screen_borders.h"
#include "accel/screen_kernels.h"
#include "accel/screen_packets.h"

namespace ink {

/// What a thread has turned into screen form. Neighbouring parts of the screen share clusters, so
/// those of the last few tiles are kept, where the clusters are few enough to be looked up.
class PacketStore {
  public:
    PacketStore(const Clusters& clusters, const Basis& basis) : clusters_(clusters), basis_(basis) {
        if (clusters.clusters.size() > ClusterBands::kMost) return;
        place_of_.assign(clusters.clusters.size(), kNone);
        packets_.reserve(std::min(kKept, clusters.clusters.size()));
    }

    /// Packets that are asked for from now on keep their places until the next call.
    void enter() {
        ++area_;
        if (place_of_.empty()) next_ = 0;
    }

    bool has(std::uint32_t cluster) const {
        return !place_of_.empty() && place_of_[cluster] != kNone;
    }

    /// The place of a cluster's packet, which is made unless it is there.
    std::uint32_t get(std::uint32_t cluster) {
        if (has(cluster)) {
            owners_[place_of_[cluster]].area = area_;
            return place_of_[cluster];
        }
        const std::uint32_t place = take_place();
        owners_[place] = {cluster, area_};
        if (!place_of_.empty()) place_of_[cluster] = place;
        if (wants_shades_) shades_.resize(packets_.size());
        prepare(basis_, clusters_, clusters_.clusters[cluster], packets_[place],
                wants_shades_ ? &shades_[place] : nullptr);
        set_union(packets_[place].bounds, wholes_[place / kLanes],
                  static_cast<int>(place % kLanes));
        if (wants_sides_ && packets_[place].kind == ClusterKind::triangles) {
            sides_.resize(packets_.size());
            find_sides(packets_[place], sides_[place]);
        }
        return place;
    }

    const ScreenPacket* packets() const { return packets_.data(); }

    /// Copies the bounds of all that a packet has.
    void copy_bounds(std::uint32_t place, BoundsPacket& to, int lane) const {
        wholes_[place / kLanes].copy(static_cast<int>(place % kLanes), to, lane);
    }

    /// Makes sure that a packet has what hits need.
    void complete(std::uint32_t place) {
        ScreenPacket& packet = packets_[place];
        if (packet.has_hit_numbers) return;
        const Cluster& cluster = clusters_.clusters[owners_[place].cluster];
        record_hits(clusters_.triangles[cluster.packet], packet);
        packet.has_hit_numbers = true;
    }

    void prefetch(std::uint32_t cluster) const {
        if (!has(cluster)) ink::prefetch(clusters_, cluster, wants_shades_);
    }

    /// To be called before the first `get`: the sides of triangles are found as well.
    void want_sides() { wants_sides_ = true; }
    const PacketSides* sides() const { return sides_.data(); }
    /// Likewise what shading needs of them.
    void want_shades() { wants_shades_ = true; }
    /// Neither is found any more.
    void want_points_only() { wants_sides_ = wants_shades_ = false; }
    bool wants_shades() const { return wants_shades_; }
    const PacketShades* shades() const { return shades_.data(); }

  private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
    /// Packets that are kept from area to area: those of a row of tiles, 1 MB. More would leave the
    /// second level of cache.
    static constexpr std::size_t kKept = 384;

    struct Owner {
        std::uint32_t cluster = kNone;
        std::uint32_t area = 0;  ///< that last asked for it
    };

    /// A place that this area has not asked for.
    std::uint32_t take_place() {
        if (place_of_.empty()) {
            if (next_ == packets_.size()) add_place();
            return next_++;
        }
        // A new one while there are few, then the one that was made first.
        for (std::size_t n = 0; packets_.size() >= kKept && n < packets_.size(); ++n) {
            const std::uint32_t place = next_;
            next_ = place + 1 == packets_.size() ? 0 : place + 1;
            if (owners_[place].area == area_) continue;
            place_of_[owners_[place].cluster] = kNone;
            return place;
        }
        return add_place();
    }

    std::uint32_t add_place() {
        packets_.emplace_back();
        owners_.emplace_back();
        wholes_.resize((packets_.size() + kLanes - 1) / kLanes);
        return static_cast<std::uint32_t>(packets_.size() - 1);
    }

    const Clusters& clusters_;
    const Basis& basis_;
    std::vector<ScreenPacket> packets_;
    std::vector<BoundsPacket> wholes_;  ///< bounds of sixteen packets each
    bool wants_sides_ = false;
    std::vector<PacketSides> sides_;  ///< of each packet of triangles
    bool wants_shades_ = false;
    std::vector<PacketShades> shades_;     ///< likewise
    std::vector<Owner> owners_;            ///< a packet
    std::vector<std::uint32_t> place_of_;  ///< a cluster: its packet, or kNone; empty: none is kept
    std::uint32_t area_ = 0;
    std::uint32_t next_ = 0;  ///< the place to be taken next
};

}  // namespace ink

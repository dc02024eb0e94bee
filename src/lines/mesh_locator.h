#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "lines/detect.h"
#include "lines/locate.h"
#include "sampling/mesh_crossing.h"
#include "sampling/samples.h"
#include "sampling/surface_key.h"

namespace ink {

/// A suspect edge each of whose ends sees a mesh or the background.
struct MeshEdge {
    std::uint32_t edge;  ///< index of the suspect edge
    SurfaceKey first, second;
};

/// The geometry that a surface belongs to.
using GeometryFunction = std::function<GeometryId(SurfaceKey)>;

/// What MeshLocator asks of the scene. Like all that `lines` is given, it may be an invented one.
struct MeshQueries {
    MeshCrossingFunction cross;
    GeometryFunction id_of;
    IdentifyFunction identify;
    SurfaceFunction describe;
    SampleFunction sample;
};

/// Locates what Locator would between meshes whose edges know their triangles, without bisection:
/// the crossing follows from the mesh, and one ray beside it is asked what it hits. If that is
/// another fold of the surface that ends, the search goes on from there; if it tells that an end
/// looked into a slit, there is no line. What that does not settle is left to Locator.
class MeshLocator {
  public:
    MeshLocator(const Viewpoint& viewpoint, const LocateSettings& settings, MeshQueries ask)
        : viewpoint_(viewpoint), settings_(settings), ask_(std::move(ask)) {}

    /// Adds crossings, and to `left` the suspect edges that are left.
    void locate(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
                std::span<const MeshEdge> edges, std::vector<Crossing>& crossings,
                std::vector<std::uint32_t>& left);

    /// Suspect edges of the last call whose first end looks into a slit, and their second beside
    /// it.
    std::span<const std::uint32_t> slits() const { return slits_; }

  private:
    /// A lattice edge, or a part of it, that is looked at.
    struct Search {
        std::uint32_t edge;                 ///< index of the suspect edge
        std::uint32_t at_first, at_second;  ///< points of the grid
        GeometryId first, second;           ///< seen there
        bool first_in_front;
    };
    /// One with a line, where a ray must confirm it.
    struct Checked {
        std::uint32_t number;  ///< of the search
        Crossing crossing;
    };
    /// One whose end may look into a slit.
    struct Doubt {
        Search search;
        bool first;
        Vec2f past;  ///< that end
    };
    enum class Verdict : std::uint8_t { nothing, line, unsettled };

    void start(const SampleGrid& grid, std::span<const SuspectEdge> suspects,
               std::span<const MeshEdge> edges);
    MeshChecks checks_on(Vec2f way, float spacing) const;
    void look(float spacing, std::vector<Crossing>& crossings, std::vector<std::uint32_t>& left);
    void check(float spacing, std::vector<Crossing>& crossings, std::vector<std::uint32_t>& left);
    void drop_slits(const SampleGrid& grid, std::vector<std::uint32_t>& left);
    Verdict classify(float spacing, const MeshCrossing& mesh, Crossing& crossing) const;
    Verdict classify_contour(float spacing, const MeshCrossing& mesh, Crossing& crossing) const;
    bool is_confirmed(const MeshCrossing& mesh, SurfaceKey seen) const;
    bool goes_on(const MeshCrossing& mesh, const Crossing& crossing, SurfaceKey seen) const;

    Viewpoint viewpoint_;
    LocateSettings settings_;
    MeshQueries ask_;
    std::vector<Search> open_;
    std::vector<SeenPair> pairs_;      ///< of each search: the ends of what is looked at
    std::vector<MeshCrossing> found_;  ///< what was found there
    std::vector<Checked> checked_;
    std::vector<Doubt> doubted_;
    std::vector<std::uint32_t> slits_;
    std::vector<Vec2f> points_;
    std::vector<SurfaceKey> expected_, seen_;
    std::vector<Sample> samples_;
};

}  // namespace ink

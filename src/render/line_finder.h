#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lines/ball_locator.h"
#include "lines/connect.h"
#include "lines/density.h"
#include "lines/detect_blocks.h"
#include "lines/locate.h"
#include "lines/mesh_locator.h"
#include "lines/segment.h"
#include "lines/tones.h"
#include "render/border_map.h"
#include "render/edges_plan.h"
#include "render/face_density.h"
#include "render/face_map.h"
#include "render/face_tiling.h"
#include "render/lattice_blocks.h"
#include "render/ridge_search.h"
#include "render/specular_search.h"
#include "render/tiles.h"
#include "sampling/mesh_crosser.h"
#include "sampling/sampler.h"
#include "sampling/samples.h"
#include "shading/shading.h"

namespace ink {

/// Where to put what lines between faces are drawn from: one of them, or none.
struct FaceMaps {
    FaceMap* faces = nullptr;
    BorderMap* borders = nullptr;
    FaceTiling* tiling = nullptr;
};

/// Finds the lines of one tile after another. Arrays over blocks have one entry a block that is
/// near the scene.
class LineFinder {
  public:
    /// `ridges`: what keeps the samples that ridges are found from; null if there are none.
    explicit LineFinder(const EdgesPlan& edges, const FaceMaps& maps = {},
                        RidgeSearch* ridges = nullptr)
        : LineFinder(edges, *edges.pipeline.frame, true, maps, ridges) {}

    /// On other surfaces than the nearest ones: what lies behind them is not shaded.
    LineFinder(const EdgesPlan& edges, const FrameTracer& behind)
        : LineFinder(edges, behind, false, {}, nullptr) {}

    /// Traces the lattice, detects, locates and connects; shades the tile's pixels on the way.
    TileLines search(const Tile& tile);

    /// More samples, anywhere; faster in the part of the screen that was entered last.
    const SampleFunction& more_samples() const { return sample_; }
    void enter(const ScreenBox& area) { sampler_.enter(area); }
    /// Says that no more tiles are searched: samples alone are wanted from now on.
    void end_search() { sampler_.want_points_only(); }

    /// Whether any ray of the last tile's lattice hit anything.
    bool saw_anything() const { return saw_anything_; }
    /// Of the last tile: where lines cross the edges of the lattice. They name these edges by their
    /// index.
    std::span<const Crossing> crossings() const { return crossings_; }
    std::span<const SuspectEdge> crossed_edges() const { return suspects_; }

    /// Of the last tile: its lines seen directly, with light and shade told apart (ToneConnector).
    std::vector<Segment> take_toned() { return std::move(toned_); }

    /// Of the lines found so far that are to be drawn.
    const LineDensity& density() const { return density_; }
    /// Of those that are seen directly; unset without mirrors and glass.
    const LineDensity& direct_density() const { return direct_density_; }

    RenderStats stats() const {
        RenderStats result = stats_;
        result.rays = sampler_.rays();
        if (specular_) {
            result.rays += specular_->rays();
            result.crossings += specular_->crossings();
        }
        return result;
    }

  private:
    LineFinder(const EdgesPlan& edges, const FrameTracer& frame, bool front, const FaceMaps& maps,
               RidgeSearch* ridges)
        : edges_(edges),
          front_(front),
          ids_only_(front && edges.balls_only),
          faces_(maps.faces),
          borders_(maps.borders),
          tiling_(maps.tiling),
          faces_end_(faces_ != nullptr && !edges.outlines_cover_faces()),
          ridges_(ridges),
          sampler_(frame, edges.pipeline.camera, edges.q),
          pixel_sampler_(frame, edges.pipeline.camera),
          locator_(edges.viewpoint, edges.locate,
                   [&edges](const Sample& sample, Vec2f from, Vec2f to) {
                       return edges.surfaces.way_out(edges.viewpoint, sample, from, to);
                   }),
          sample_([this](std::span<const Vec2f> points, std::span<Sample> out) {
              sample(points, out);
          }),
          ball_locator_(edges.viewpoint, edges.locate),
          identify_([this](std::span<const Vec2f> points, std::span<SurfaceKey> out) {
              identify(points, out);
          }),
          describe_([this](std::size_t point, Sample& sample) { describe(point, sample); }),
          mesh_crosser_(edges.mesh_walk),
          mesh_locator_(edges.viewpoint, edges.locate, mesh_queries()),
          smoothing_(edges.q),
          smooths_(front && edges.smooth_shading &&
                   edges.pipeline.settings.compose != Compose::lines),
          keeps_segments_(!front || edges.keeps_segments()),
          density_(edges.no_lines),
          direct_density_(edges.no_lines) {
        if (front && edges.pipeline.goes_on()) specular_.emplace(edges);
        if (borders_ != nullptr) {
            sampler_.want_borders();
            if (!specular_) {
                const std::size_t style = edges.style_of(LineType::mesh, 0);
                face_density_.emplace(density_, 1.0F, edges.ink.styles[style].width_px);
            }
        }
        takes_shades_ = front && can_take_shades() && sampler_.want_shades();
        fills_grid_ = !takes_shades_ || !edges.has_meshes || crosses_faces();
    }

    MeshQueries mesh_queries();
    bool can_take_shades() const;
    void trace_lattice(const Tile& tile);
    void make_room();
    bool lays_strips() const;
    void take(std::size_t first, std::size_t count);
    void fill_grid(std::size_t block);
    template <class T>
    void copy_to_grid(std::size_t block, const T* from, T* plane) const;
    void name_samples(std::size_t first, std::size_t count);
    SampleBlocks sample_blocks();
    std::uint32_t cut_strip(std::uint32_t strip, int first);
    void put_ends();
    void put_end(int i, int j);
    void keep_for_ridges(const Tile& tile);
    void shade(std::size_t first, std::size_t count);
    void put_pixels(const Tile& tile);
    void gather_row(int x0, int x1, int y);
    const ColorPacket* mixed_block(int x, int y);
    void keep_fringe(const Tile& tile);
    void put_aovs(Block block);
    void find_lines();
    void measure_brightness();
    void find_tones();
    void keep();
    void keep_stroke(const Segment& segment);
    float gap_behind(const Segment& segment) const;
    void smooth();
    void count(const InkStroke& stroke);
    void add_specular();
    void sample(std::span<const Vec2f> points, std::span<Sample> out);
    struct LatticeHit {
        const HitPacket* hits;
        int lane;
    };
    /// What a point of the grid hit; it must not be background.
    LatticeHit hit_at(int i, int j) const {
        const auto [k, lane] = lattice_.place_of(i, j);
        return {&hits_[k], lane};
    }
    void drop_smooth();
    bool is_smooth(const SuspectEdge& edge) const;
    void describe(std::size_t point, Sample& sample) const;
    void locate();
    void close_slits();
    bool see_ball(int i, int j, BallHit& hit) const;
    bool see_mesh(int i, int j, SurfaceKey& key) const;
    void identify(std::span<const Vec2f> points, std::span<SurfaceKey> out);
    void map_borders(std::size_t first, std::size_t count);
    void map_tiling(std::size_t first, std::size_t count);
    void map_faces(const Tile& tile);
    void map_block(int x, int y);
    void add_face_density(std::size_t block);
    bool crosses_faces() const;
    void cross_faces();
    void cross_faces(int i, int j, bool down);
    void drop_unmarked_faces();
    void mark(int i, int j);
    void cross_all_faces();
    std::span<const std::uint8_t> face_cells() const;
    bool marked(int i, int j) const;
    /// A lattice point that looks into a slit, and the colour that it takes.
    struct ClosedPoint {
        LatticeBlocks::Place place;
        bool down;  ///< the slit's far side is the point below
        PixelColor color;
    };
    PixelColor color_at(int i, int j) const;
    PixelColor pixel_color(int x, int y) const;

    static constexpr std::uint8_t kCrossedRight = 1, kCrossedDown = 2, kMarked = 4;

    const EdgesPlan& edges_;
    bool front_;
    /// Whether lines depend on IDs alone: the grid keeps nothing else.
    bool ids_only_;
    bool saw_anything_ = false;
    FaceMap* faces_;
    BorderMap* borders_;
    FaceTiling* tiling_;
    bool faces_end_;  ///< lines between faces end where another line is in front
    RidgeSearch* ridges_;
    Sampler sampler_;
    bool takes_shades_ = false;  ///< normals to shade by come with the hits, and places
    /// Whether the grid has all samples, or only the ends of suspect edges.
    bool fills_grid_ = true;
    Sampler pixel_sampler_;
    Locator locator_;
    SampleFunction sample_;
    BallLocator ball_locator_;
    IdentifyFunction identify_;
    SurfaceFunction describe_;
    MeshCrosser mesh_crosser_;
    MeshLocator mesh_locator_;
    std::optional<SpecularSearch> specular_;
    Connector connector_;
    SampleGrid grid_;
    LatticeBlocks lattice_;  ///< what follows has an entry for each of its packets
    std::vector<HitPacket> hits_;
    std::vector<BorderPacket> border_packets_;
    std::vector<SidesPacket> sides_;
    std::vector<NormalPacket> normals_;
    std::vector<ColorPacket> colors_;
    // Where the grid is not filled, and then of strips cut into blocks, too:
    std::vector<PlacePacket> places_;
    std::vector<Lanes<GeometryId>> ids_;
    std::vector<Lanes<std::uint32_t>> surfaces_;
    std::size_t cut_ = 0;                         ///< strips cut into blocks, and blocks before
    std::vector<std::uint32_t> sample_block_at_;  ///< of all blocks, row by row
    std::vector<std::uint8_t> seen_;
    std::vector<const ColorPacket*> block_row_;  ///< of pixels, on their way to the film
    std::vector<ColorPacket> mixed_;             ///< those of them that differ from the lattice's
    std::vector<ClosedPoint> closed_;
    std::vector<HitPacket> point_hits_;
    std::vector<SuspectEdge> suspects_;
    /// Of suspects, what their ends hit, and the smooth edge between them.
    std::vector<std::uint32_t> first_numbers_, second_numbers_, smooth_edges_;
    std::vector<MeshEdge> mesh_edges_;
    std::vector<std::uint32_t> others_;  ///< suspects between anything else
    std::vector<Crossing> crossings_;
    /// A point of the grid: kCrossedRight, kCrossedDown if its edge in that direction has a
    /// crossing; kMarked if lines between faces are searched for in its cell.
    std::vector<std::uint8_t> marks_;
    struct Cell {
        int i, j;
    };
    std::vector<Cell> marked_;
    std::vector<Segment> segments_;
    ToneConnector tone_connector_;
    std::vector<float> brightness_;  ///< of the grid's points, if tones are told apart
    std::vector<Segment> toned_;
    TileLines found_;
    ScreenBox inner_{};               ///< what lies within it inks no pixel of another tile
    std::vector<InkStroke> strokes_;  ///< within it
    std::vector<InkStroke> outer_strokes_;
    EdgeSmoothing smoothing_;
    bool smooths_;         ///< the shading along lines
    bool keeps_segments_;  ///< and not only their strokes
    LineDensity density_, direct_density_;
    std::optional<FaceDensity> face_density_;  ///< of borders, if they are of one width
    RenderStats stats_;
};

}  // namespace ink

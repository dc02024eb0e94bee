#include "gallery_figures.h"

namespace inktrace::cli {

namespace {

using Values = std::vector<std::pair<std::string, std::string>>;

/// The paper's method in good quality; figures that are about quality name their own.
const Values kPaper{{"method", "stencil"}, {"quality", "2"},     {"metric", "power:10"},
                    {"line-width", "3px"}, {"shade", "lambert"}, {"aa", "multisample:9"}};

Values with(Values settings, const Values& more) {
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
}

Panel kind_of_line(const std::string& letter, const std::string& scene,
                   const std::string& caption) {
    return {"figure2-" + letter, scene, caption, kPaper};
}

Panel particles(const std::string& letter, const std::string& glyph, const std::string& caption) {
    return {"figure8-" + letter, "figure8-" + glyph + ".json", caption,
            with(kPaper, {{"view", "front"}, {"line-width", "2px"}, {"size", "480x400"}})};
}

Panel effect(const std::string& letter, const std::string& caption, const std::string& aa,
             const std::string& width) {
    return {"figure10-" + letter,
            "figure1.json",
            caption,
            {{"method", "stencil"},
             {"quality", "1"},
             {"metric", "linear"},
             {"shade", "lambert"},
             {"line-width", width},
             {"aa", aa}}};
}

Figure figure1() {
    return {"Figure 1: a molecule",
            "Acetaminophen as a space-filling model. Lines run where the atoms of a bond intersect "
            "and around the outside of the molecule.",
            {{"figure1-shaded", "figure1.json", "Lambertian shading.",
              with(kPaper, {{"compose", "shaded"}})},
             {"figure1-lines", "figure1.json", "The lines.", with(kPaper, {{"compose", "lines"}})},
             {"figure1-both", "figure1.json", "Both.", kPaper}}};
}

Figure figure2() {
    return {
        "Figure 2: the types of lines",
        "In the paper a sketch; here each type from a scene of its own.",
        {kind_of_line("a", "figure2-silhouette.json",
                      "(a) Silhouette: the edge of an object against a more distant one, or "
                      "against the background."),
         kind_of_line("b", "figure2-self-occlusion.json",
                      "(b) Self-occluding silhouette: an edge of an object against a farther "
                      "part of itself, as at the crests of this sheet."),
         kind_of_line("c", "figure2-intersection.json",
                      "(c) Intersection: two objects run into each other."),
         kind_of_line("d", "figure2-crease.json", "(d) Crease: the normal of an object jumps.")}};
}

Figure figure3() {
    return {
        "Figure 3: creases and self-occluding silhouettes",
        "Lines within one object, where all rays of a stencil strike the same geometry.",
        {{"figure3-a", "figure3-box.json", "(a) Creases on every visible edge of a box.", kPaper},
         {"figure3-b", "figure3-torus.json",
          "(b) The self-occluding silhouette that extends from a torus' hollow.", kPaper},
         {"figure3-c", "figure3-gaussian.json",
          "(c) A Gaussian function, whose peak hides what lies behind it.", kPaper}}};
}

Figure figure4() {
    const auto diagram = [](const std::string& letter, const std::string& caption) {
        return Panel{"figure4-" + letter, "", caption, {}, true};
    };
    return {"Figure 4: ray stencils",
            "How the method looks about each sample. These are computed, as the renderer does it.",
            {diagram("a",
                     "(a) The stencil of N = 2 rings: 8 rays on the first, 16 on the second. The "
                     "red ones are for the normal's gradient."),
             diagram("b",
                     "(b) A stencil across an edge: of M = 24 rays, m = 9 strike the other "
                     "primitive, so the linear strength is 1 - |9 - 12| / 12 = 75 %. (The paper's "
                     "caption says 62.5 %, which is not what its equation 2 gives.)"),
             diagram("c",
                     "(c) A disc crosses an edge: the share of its area beyond the edge grows to a "
                     "half, changes sides with the centre, and falls again. Below, the strength "
                     "that follows from it, for linear and exponential metrics.")}};
}

Figure figure5() {
    return {"Figure 5: what the method searches",
            "Jumps in the IDs and depths, and jumps of the normals, are the feature lines.",
            {{"figure5", "figure5.json", "(a) The scene.",
              with(kPaper, {{"aov", "id,normal,depth"}, {"compose", "shaded"}})},
             {"figure5.id.primitive", "", "(b) Geometry IDs, as colours.", {}},
             {"figure5.normal", "", "(c) Normals, as colours.", {}},
             {"figure5.depth", "", "(d) Depths: near is bright.", {}},
             {"figure5-lines", "figure5.json", "And the lines that follow from them.", kPaper}}};
}

Figure figure6() {
    const Values wide{{"line-width", "8px"}};
    return {"Figure 6: edge strength metrics",
            "The same scene with two metrics, nine samples a pixel.",
            {{"figure6-a", "figure1.json", "(a) Linear (equation 2).",
              with(with(kPaper, wide), {{"metric", "linear"}})},
             {"figure6-b", "figure1.json",
              "(b) Exponential (equation 3): bolder, with a faster change from clear to black.",
              with(kPaper, wide)}}};
}

Figure figure7() {
    return {"Figure 7: mesh visualization",
            "The geometry ID of a hit is the triangle, or the whole mesh.",
            {{"figure7-faces", kMesh,
              "Triangles as geometry IDs: the lines between them show the mesh.",
              with(kPaper, {{"ids", "primitive"}, {"line-width", "1.5px"}, {"size", "480x480"}})},
             {"figure7-object", kMesh,
              "The mesh as one object: its silhouettes. Normals are interpolated, so that there "
              "are no creases between triangles (the paper's footnote 2).",
              with(kPaper, {{"ids", "object"},
                            {"normals", "shading"},
                            {"lines", "silhouette,self-occlusion"},
                            {"depth-jump", "0.03"},
                            {"line-width", "2px"},
                            {"size", "480x480"}})},
             {"figure7-edges",
              kMesh,
              "Both by method edges, which thins lines out where triangles are finer than the "
              "lines are wide.",
              {{"shade", "lambert"},
               {"lines", "silhouette,self-occlusion,boundary,mesh"},
               {"line", "mesh:width=1px"},
               {"line-width", "2px"},
               {"size", "480x480"}}}}};
}

Figure figure8() {
    return {"Figure 8: particle data",
            "Two elastic bodies after a collision, by the Material Point Method "
            "(examples/mpm_collision). Lines where particles intersect show how they lie.",
            {particles("a", "spheres",
                       "(a) As spheres: intersection lines show where each overlaps its "
                       "neighbours."),
             particles("b", "boxes",
                       "(b) As hexahedra under each particle's deformation gradient, with creases. "
                       "Where boundaries are not straight, glyphs intersect."),
             particles("c", "ellipsoids", "As ellipsoids under the deformation gradient.")}};
}

Figure figure9() {
    return {"Figure 9: apparent ridges",
            "A rounded cube, in truth a superellipsoid: it has no creases.",
            {{"figure9", "figure9.json", "Apparent ridges by ray stencils.",
              with(kPaper, {{"aa", "multisample:4"}})},
             {"figure9-edges",
              "figure9.json",
              "By method edges: lines of exact width.",
              {{"shade", "lambert"}, {"line-width", "3px"}}}}};
}

Figure figure10() {
    return {
        "Figure 10: anti-aliasing and width",
        "One ring and the linear metric. On the right, lines are twice as thick.",
        {effect("a", "(a) No anti-aliasing.", "none", "3px"),
         effect("b", "(b) Doubly thick lines with no anti-aliasing.", "none", "6px"),
         effect("c", "(c) Ray stencil anti-aliasing.", "stencil", "3px"),
         effect("d", "(d) Doubly thick lines with ray stencil anti-aliasing.", "stencil", "6px"),
         effect("e", "(e) Multisampling, nine samples a pixel.", "multisample:9", "3px"),
         effect("f", "(f) Doubly thick lines with multisampling.", "multisample:9", "6px")}};
}

}  // namespace

std::vector<Figure> gallery_figures() {
    return {figure1(), figure2(), figure3(), figure4(), figure5(),
            figure6(), figure7(), figure8(), figure9(), figure10()};
}

}  // namespace inktrace::cli

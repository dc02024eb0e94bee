#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "inktrace/inktrace.h"
#include "messages.h"
#include "scenes_dir.h"

namespace inktrace::cli {

namespace {

namespace fs = std::filesystem;
using Values = std::vector<std::pair<std::string, std::string>>;

/// One picture of a figure: a scene, and settings over those of its file.
struct Panel {
    std::string name;     ///< of the picture, without extension
    std::string scene;    ///< file among the scenes; empty: the mesh of Figure 7
    std::string caption;  ///< one sentence
    Values settings;
};

struct Figure {
    std::string title;
    std::string text;  ///< what to see
    std::vector<Panel> panels;
};

/// The paper's method in good quality; figures that are about quality name their own.
const Values kPaper{{"method", "stencil"},
                    {"quality", "2"},
                    {"metric", "power:10"},
                    {"line-width", "3px"},
                    {"aa", "multisample:9"}};

Values with(Values settings, const Values& more) {
    settings.insert(settings.end(), more.begin(), more.end());
    return settings;
}

Panel effect(const std::string& name, const std::string& caption, const std::string& aa,
             const std::string& width) {
    return {name,
            "figure1.json",
            caption,
            {{"method", "stencil"}, {"quality", "1"}, {"line-width", width}, {"aa", aa}}};
}

std::vector<Figure> figures() {
    return {
        {"Figure 1",
         "A space-filling model, its lines, and both. Lines run where atoms intersect and around "
         "the molecule.",
         {{"figure1-shaded", "figure1.json", "Lambertian shading.",
           with(kPaper, {{"compose", "shaded"}})},
          {"figure1-lines", "figure1.json", "The lines.", with(kPaper, {{"compose", "lines"}})},
          {"figure1-both", "figure1.json", "Both.", kPaper}}},
        {"Figure 3",
         "Creases and self-occluding silhouettes.",
         {{"figure3-box", "figure3-box.json", "Creases on every visible edge of a box.", kPaper},
          {"figure3-torus", "figure3-torus.json",
           "The self-occluding silhouette around a torus' hollow.", kPaper},
          {"figure3-gaussian", "figure3-gaussian.json",
           "The peak of a Gaussian hides its own foot.", kPaper}}},
        {"Figure 5",
         "What the method searches for jumps and turns: geometry IDs, normals and depths.",
         {{"figure5", "figure5.json", "The scene.", with(kPaper, {{"aov", "id,normal,depth"}})},
          {"figure5.id.primitive", "", "Geometry IDs, as colours.", {}},
          {"figure5.normal", "", "Normals, as colours.", {}},
          {"figure5.depth", "", "Depths.", {}}}},
        {"Figure 6",
         "The same scene with two metrics, nine samples a pixel.",
         {{"figure6-linear", "figure1.json", "Linear (equation 2).",
           with(kPaper, {{"metric", "linear"}, {"line-width", "8px"}})},
          {"figure6-power", "figure1.json", "Exponential (equation 3): bolder, with harder edges.",
           with(kPaper, {{"metric", "power:10"}, {"line-width", "8px"}})}}},
        {"Figure 7",
         "Mesh visualization: the geometry ID is the whole mesh, or the triangle.",
         {{"figure7-object", "mesh", "One object: its silhouettes.",
           with(kPaper, {{"ids", "object"},
                         {"lines", "silhouette,self-occlusion"},
                         {"depth-jump", "0.03"},
                         {"line-width", "2px"},
                         {"size", "480x400"}})},
          {"figure7-faces", "mesh", "Triangles: the lines between them as well.",
           with(kPaper, {{"ids", "primitive"}, {"line-width", "1.5px"}, {"size", "480x400"}})}}},
        {"Figure 8",
         "Two elastic bodies after a collision, by the Material Point Method. Intersection lines "
         "show where particles overlap.",
         {{"figure8-spheres", "figure8-spheres.json", "Particles as spheres.",
           with(kPaper, {{"view", "front"}, {"line-width", "2px"}, {"size", "480x400"}})},
          {"figure8-boxes", "figure8-boxes.json",
           "As boxes under each particle's deformation gradient, with creases.",
           with(kPaper, {{"view", "front"}, {"line-width", "2px"}, {"size", "480x400"}})},
          {"figure8-ellipsoids", "figure8-ellipsoids.json", "As ellipsoids under it.",
           with(kPaper, {{"view", "front"}, {"line-width", "2px"}, {"size", "480x400"}})}}},
        {"Figure 9",
         "Apparent ridges on a rounded cube, which has no creases.",
         {{"figure9", "figure9.json", "By ray stencils.", with(kPaper, {{"aa", "stencil"}})},
          {"figure9-edges", "figure9.json", "By method edges, of exact width.", {}}}},
        {"Figure 10",
         "Anti-aliasing and width, with one ring and the linear metric: on the right, lines of "
         "twice the width.",
         {effect("figure10-a", "No anti-aliasing.", "none", "3px"),
          effect("figure10-b", "No anti-aliasing, doubly thick.", "none", "6px"),
          effect("figure10-c", "Ray stencil anti-aliasing.", "stencil", "3px"),
          effect("figure10-d", "Ray stencil anti-aliasing, doubly thick.", "stencil", "6px"),
          effect("figure10-e", "Nine samples a pixel.", "multisample:9", "3px"),
          effect("figure10-f", "Nine samples a pixel, doubly thick.", "multisample:9", "6px")}}};
}

/// A tube along a (2, 3) torus knot, in triangles: a mesh to look at where none was named.
void add_knot(Scene& scene) {
    constexpr std::uint32_t kAround = 110;
    constexpr std::uint32_t kSides = 14;
    constexpr double kTurn = 2.0 * std::numbers::pi;
    struct Point {
        double x, y, z;
    };
    const auto knot = [](double s) {
        const double r = 2.0 + std::cos(3.0 * s);
        return Point{r * std::cos(2.0 * s), r * std::sin(2.0 * s), std::sin(3.0 * s)};
    };
    const auto unit = [](Point p) {
        const double size = std::hypot(p.x, p.y, p.z);
        return Point{p.x / size, p.y / size, p.z / size};
    };
    const auto cross = [](Point a, Point b) {
        return Point{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    };
    std::vector<float> vertices;
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t i = 0; i < kAround; ++i) {
        const double s = kTurn * i / kAround;
        const Point at = knot(s);
        const Point ahead = knot(s + 1e-4);
        const Point along = unit({ahead.x - at.x, ahead.y - at.y, ahead.z - at.z});
        const Point side = unit(cross(along, {at.x, at.y, 0.0}));
        const Point up = cross(side, along);
        for (std::uint32_t j = 0; j < kSides; ++j) {
            const double c = 0.42 * std::cos(kTurn * j / kSides);
            const double d = 0.42 * std::sin(kTurn * j / kSides);
            vertices.insert(vertices.end(), {static_cast<float>(at.x + c * side.x + d * up.x),
                                             static_cast<float>(at.y + c * side.y + d * up.y),
                                             static_cast<float>(at.z + c * side.z + d * up.z)});
            const std::uint32_t next = (i + 1) % kAround * kSides;
            const std::uint32_t a = i * kSides + j;
            const std::uint32_t b = i * kSides + (j + 1) % kSides;
            triangles.insert(triangles.end(),
                             {a, next + j, b, b, next + j, next + (j + 1) % kSides});
        }
    }
    scene.add_mesh("knot", vertices, triangles, {154, 182, 216});
}

struct GalleryArguments {
    std::string output;
    std::string scenes = scenes_dir();
    std::string mesh;
    int threads = 0;
    bool quiet = false;
};

void draw(const Panel& panel, const GalleryArguments& arguments) {
    Scene scene;
    Settings settings;
    if (panel.scene == "mesh") {
        if (arguments.mesh.empty()) {
            add_knot(scene);
        } else {
            scene.load(arguments.mesh);
        }
    } else {
        const fs::path file = fs::path(arguments.scenes) / panel.scene;
        for (const auto& [name, value] : scene_file_settings(file)) settings.set(name, value);
        scene.load(file, settings);
    }
    for (const auto& [name, value] : panel.settings) settings.set(name, value);
    settings.set("threads", std::to_string(arguments.threads));
    const Renderer renderer(std::move(scene));
    renderer.render(settings).save(fs::path(arguments.output) / (panel.name + ".png"));
    if (!arguments.quiet) say(fmt::format("{}.png\n", panel.name));
}

std::string page(const std::vector<Figure>& all) {
    std::string html =
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
        "<title>Ray Tracing NPR-Style Feature Lines, remade by Inktrace</title>\n"
        "<style>body{font:16px/1.5 sans-serif;max-width:1500px;margin:2em auto;padding:0 1em}"
        ".row{display:flex;flex-wrap:wrap;gap:1em}figure{margin:0;max-width:480px}"
        "img{max-width:100%;border:1px solid #ddd}figcaption{color:#444}</style>\n"
        "<h1>Ray Tracing NPR-Style Feature Lines, remade</h1>\n"
        "<p>The figures of Choudhury and Parker (NPAR 2009), drawn by <code>inktrace "
        "gallery</code> "
        "with the paper's ray stencils unless a caption says otherwise.</p>\n";
    for (const Figure& figure : all) {
        html +=
            fmt::format("<h2>{}</h2>\n<p>{}</p>\n<div class=\"row\">\n", figure.title, figure.text);
        for (const Panel& panel : figure.panels) {
            html += fmt::format(
                "<figure><img src=\"{0}.png\" alt=\"{1}\"><figcaption>{1}</figcaption></figure>\n",
                panel.name, panel.caption);
        }
        html += "</div>\n";
    }
    return html + "</html>\n";
}

void run(const GalleryArguments& arguments) {
    std::error_code failure;
    fs::create_directories(arguments.output, failure);
    const std::vector<Figure> all = figures();
    for (const Figure& figure : all) {
        for (const Panel& panel : figure.panels) {
            if (!panel.scene.empty()) draw(panel, arguments);  // others are AOVs of the one before
        }
    }
    const fs::path file = fs::path(arguments.output) / "index.html";
    std::ofstream out(file);
    out << page(all);
    out.close();
    if (!out) {
        throw Error(Error::Kind::input,
                    fmt::format("{}: cannot be written; check the folder", file.string()));
    }
    if (!arguments.quiet) say(fmt::format("{}\n", file.string()));
}

}  // namespace

void add_gallery_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("gallery", "Draw the paper's figures and a page of them");
    const auto arguments = std::make_shared<GalleryArguments>();
    command->add_option("-o,--output", arguments->output, "Folder to write into")
        ->type_name("DIR")
        ->required();
    command->add_option("--scenes", arguments->scenes, "Folder of the scene files")
        ->type_name("DIR");
    command->add_option("--mesh", arguments->mesh, "Mesh of Figure 7; else a knot is made")
        ->type_name("FILE");
    command->add_option("--threads", arguments->threads, "Threads to use; 0 for all [0]")
        ->type_name("T")
        ->check(CLI::Range(0, 1024).description(""));
    command->add_flag("--quiet", arguments->quiet, "Say nothing");
    command->callback([arguments] { run(*arguments); });
}

}  // namespace inktrace::cli

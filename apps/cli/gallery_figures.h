#pragma once

#include <string>
#include <utility>
#include <vector>

namespace inktrace::cli {

/// One picture of a figure: a scene, and settings over those of its file.
struct Panel {
    std::string name;     ///< of the picture, without extension
    std::string scene;    ///< file among the scenes; kMesh; empty: an AOV of the panel before
    std::string caption;  ///< one sentence
    std::vector<std::pair<std::string, std::string>> settings;
    bool is_diagram = false;  ///< drawn by `diagram`, as SVG, not from a scene
};

/// In place of a scene: the mesh of Figure 7.
inline constexpr const char* kMesh = "mesh";

struct Figure {
    std::string title;
    std::string text;  ///< what to see
    std::vector<Panel> panels;
};

/// The paper's figures, with what each shows.
std::vector<Figure> gallery_figures();

}  // namespace inktrace::cli

#pragma once

#include <string>
#include <vector>

#include "base/color.h"
#include "film/film.h"
#include "lines/curve.h"
#include "render/settings.h"
#include "scene/scene.h"

typedef struct _cairo cairo_t;

namespace ink {

/// A filled area of a legend: a field of colour, or words as outlines.
struct LegendShape {
    std::vector<Curve> outlines;  ///< closed; what they wind round is filled
    Rgb8 color;
    /// The words, which stand out from what is below by a rim of the legend's paper; empty for a
    /// field.
    std::string text{};
    double x = 0.0, y = 0.0;  ///< where their base line begins
    double size = 0.0;        ///< of the font

    bool is_text() const { return !text.empty(); }
};

/// What the colours of a picture mean: scales of numbers and lists of kinds, in a corner. In pixels
/// of the picture.
struct Legend {
    std::vector<LegendShape> shapes;  ///< from the bottom up
    Rgb8 paper;
    double rim_px = 0.0;  ///< of the paper, on each side of text

    bool empty() const { return shapes.empty(); }
};

/// The legend that the settings ask for; empty where there is nothing to tell. Text is in DejaVu
/// Sans, or what the system has in its place.
Legend make_legend(const Scene& scene, const Settings& settings);

/// The view, with the scene beside the legend, where the camera is free to choose its place.
ViewSettings beside(const Legend& legend, ViewSettings view, Size size);

/// How words are drawn: as outlines, or as text, which documents keep with its font.
enum class Words { outlines, text };
void draw(const Legend& legend, cairo_t* cr, Words words = Words::outlines);
void lay_over(const Legend& legend, Film& film);

}  // namespace ink

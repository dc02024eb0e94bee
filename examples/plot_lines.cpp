// Draws a file's lines with a pen plotter: plot_lines acetaminophen.xyz picture.hpgl
//
// The lines of a picture are polylines with a type, names and depths; here each becomes one stroke
// of the pen, outlines with pen 1 and all others with pen 2.

#include <inktrace/inktrace.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iostream>

namespace {

constexpr int kSide = 1024;         // pixels
constexpr double kPaperMm = 180.0;  // side of the drawing
constexpr double kUnitsPerMm = 40.0;

/// HPGL counts from the lower left corner.
std::array<long, 2> place(std::array<float, 2> point) {
    const double scale = kPaperMm * kUnitsPerMm / kSide;
    return {std::lround(point[0] * scale), std::lround((kSide - point[1]) * scale)};
}

void plot(const inktrace::Polyline& line, std::ostream& out) {
    const auto [x, y] = place(line.points.front());
    out << "PU" << x << ',' << y << ";PD";
    for (std::size_t k = 1; k <= line.points.size(); ++k) {
        if (k == line.points.size() && !line.closed) break;
        const auto [to_x, to_y] = place(line.points[k % line.points.size()]);
        out << (k > 1 ? "," : "") << to_x << ',' << to_y;
    }
    out << ";\n";
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::cerr << "usage: plot_lines INPUT OUTPUT.hpgl\n";
        return 2;
    }
    inktrace::Scene scene;
    scene.load(argv[1]);
    inktrace::Settings settings;
    settings.set("size", "1024x1024").set("compose", "lines");

    inktrace::RenderOptions options;
    options.curves = true;  // keep the lines
    options.inked = false;  // there is no need to draw them on pixels
    const inktrace::Renderer renderer(std::move(scene));
    const std::vector<inktrace::Polyline> lines = renderer.render(settings, options).lines();

    std::ofstream out(argv[2]);
    out << "IN;\n";
    for (const int pen : {1, 2}) {
        out << "SP" << pen << ";\n";
        for (const inktrace::Polyline& line : lines) {
            const bool outline = line.type == "silhouette" || line.type == "boundary";
            if (outline == (pen == 1)) plot(line, out);
        }
    }
    out << "PU;SP0;\n";
    out.close();
    if (!out) {
        std::cerr << argv[2] << ": cannot be written\n";
        return 1;
    }
    std::cout << argv[2] << ": " << lines.size() << " lines\n";
    return 0;
} catch (const inktrace::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
}

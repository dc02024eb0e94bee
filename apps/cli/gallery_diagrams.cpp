#include "gallery_diagrams.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace inktrace::cli {

namespace {

using std::numbers::pi;

struct Point {
    double x, y;
};

/// The paper's D_h^N: ring r of N has 8 r rays, from the x axis on.
std::vector<Point> ring_stencil(int rings, double radius) {
    std::vector<Point> points;
    for (int r = 1; r <= rings; ++r) {
        for (int k = 0; k < 8 * r; ++k) {
            const double angle = 2.0 * pi * k / (8.0 * r);
            points.push_back(
                {radius * r / rings * std::cos(angle), radius * r / rings * std::sin(angle)});
        }
    }
    return points;
}

std::string svg(double width, double height, const std::string& body) {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" font-family=\"sans-serif\" font-size=\"15\">\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n{2}</svg>\n",
        width, height, body);
}

std::string circle(Point at, double radius, const std::string& paint) {
    return fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" {}/>\n", at.x, at.y,
                       radius, paint);
}

constexpr const char* kDark = "fill=\"#333333\"";
constexpr const char* kLight = "fill=\"#9a9a9a\"";
constexpr const char* kRed = "fill=\"#d03030\"";
constexpr const char* kRing = "fill=\"none\" stroke=\"#c8c8c8\"";

constexpr double kSide = 320.0;
constexpr Point kCentre{160.0, 150.0};
constexpr double kRadius = 115.0;

std::string rings_about_centre() {
    return circle(kCentre, kRadius, kRing) + circle(kCentre, 0.5 * kRadius, kRing);
}

std::string stencil() {
    std::string body = rings_about_centre();
    const std::vector<Point> points = ring_stencil(2, kRadius);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const bool outer = k >= 8;
        const bool gradient = outer && (k - 8) % 4 == 0;
        body += circle({kCentre.x + points[k].x, kCentre.y + points[k].y}, 6.0,
                       gradient ? kRed
                       : outer  ? kLight
                                : kDark);
    }
    body += circle(kCentre, 6.0, "fill=\"#000000\"");
    body += fmt::format(
        "<path d=\"M{0} {1}h{2}\" stroke=\"#000000\"/>\n"
        "<text x=\"{3}\" y=\"{4}\" font-style=\"italic\">h</text>\n"
        "<text x=\"{5}\" y=\"{6}\" font-style=\"italic\">s</text>\n",
        kCentre.x, kCentre.y, kRadius, kCentre.x + 0.74 * kRadius, kCentre.y - 8.0,
        kCentre.x - 18.0, kCentre.y - 8.0);
    return svg(kSide, 300.0, body);
}

/// The edge is level and lies where nine of the stencil's rays are above it.
std::string stencil_across_edge() {
    const std::vector<Point> points = ring_stencil(2, kRadius);
    std::vector<double> heights;
    for (const Point& p : points) heights.push_back(p.y);
    std::ranges::sort(heights);
    const double edge = 0.5 * (heights[8] + heights[9]);
    std::string body = fmt::format(
        "<rect width=\"{0}\" height=\"{1}\" fill=\"#dfe9f6\"/>\n"
        "<path d=\"M0 {1}H{0}\" stroke=\"#000000\" stroke-width=\"2\"/>\n",
        kSide, kCentre.y + edge);
    body += rings_about_centre();
    for (const Point& p : points) {
        body += circle({kCentre.x + p.x, kCentre.y + p.y}, 6.0,
                       p.y < edge ? "fill=\"#2f6fb5\"" : kLight);
    }
    body += circle(kCentre, 6.0, "fill=\"#000000\"");
    const auto foreign = std::ranges::count_if(heights, [&](double y) { return y < edge; });
    body += fmt::format(
        "<text x=\"160\" y=\"290\" text-anchor=\"middle\"><tspan font-style=\"italic\">M</tspan> = "
        "{}, <tspan font-style=\"italic\">m</tspan> = {}</text>\n",
        points.size(), foreign);
    return svg(kSide, 300.0, body);
}

/// Share of a disc of radius 1 beyond a line at a distance of u.
double share_beyond(double u) { return (std::acos(u) - u * std::sqrt(1.0 - u * u)) / pi; }

/// The part of a disc on one side of the upright line through x.
std::string cut_disc(Point at, double radius, double line) {
    const double u = std::clamp((line - at.x) / radius, -1.0, 1.0);
    const double half = std::sqrt(1.0 - u * u) * radius;
    const bool right = u >= 0.0;  // what lies beyond the line from the centre
    std::string body = circle(at, radius, "fill=\"#ffffff\" stroke=\"#333333\"");
    if (half > 0.0) {
        body += fmt::format(
            "<path d=\"M{0:.2f} {1:.2f}A{3} {3} 0 0 {4} {0:.2f} {2:.2f}Z\" fill=\"#333333\"/>\n",
            line, at.y - half, at.y + half, radius, right ? 1 : 0);
    }
    return body + circle(at, 2.5, "fill=\"#d03030\"");
}

std::string crossing_disc() {
    constexpr double kEdge = 240.0;
    constexpr double kFrame = 80.0;
    constexpr double kDisc = 30.0;
    // Six places of the centre, from h before the edge to h behind it.
    constexpr std::array<double, 6> kPlaces{-0.95, -0.5, -0.02, 0.02, 0.5, 0.95};
    std::string body;
    for (std::size_t k = 0; k < kPlaces.size(); ++k) {
        const double left = kFrame * static_cast<double>(k);
        const double line = left + 0.5 * kFrame;
        body += fmt::format(
            "<rect x=\"{0}\" width=\"40\" height=\"120\" fill=\"#f6e9d8\"/>"
            "<rect x=\"{1}\" width=\"40\" height=\"120\" fill=\"#dfe9f6\"/>\n"
            "<path d=\"M{1} 0V120\" stroke=\"#000000\" stroke-width=\"1.5\"/>\n",
            left, line);
        body += cut_disc({line + 0.66 * kDisc * kPlaces[k], 75.0}, 0.66 * kDisc, line);
        if (k > 0)
            body += fmt::format("<path d=\"M{} 0V120\" stroke=\"#ffffff\" stroke-width=\"6\"/>\n",
                                left);
    }
    for (const auto& [x, index] : {std::pair{12, 1}, {56, 2}}) {
        body += fmt::format(
            "<text x=\"{}\" y=\"22\" font-style=\"italic\">g<tspan baseline-shift=\"sub\" "
            "font-size=\"11\">{}</tspan></text>\n",
            x, index);
    }
    // Strength over the centre's place.
    const auto curve = [&](const char* color, auto strength) {
        std::string path;
        for (int k = 0; k <= 120; ++k) {
            const double x = -1.2 + 2.4 * k / 120.0;
            const double e = std::abs(x) < 1.0 ? strength(share_beyond(std::abs(x))) : 0.0;
            path += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", kEdge + 160.0 * x,
                                285.0 - 135.0 * e);
        }
        body += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.5\"/>\n",
                            path, color);
    };
    body += "<path d=\"M40 285H440\" stroke=\"#999999\"/>\n";
    curve("#333333", [](double a) { return 2.0 * a; });
    curve("#d03030", [](double a) { return 1.0 - std::pow(1.0 - 2.0 * a, 10.0); });
    body +=
        "<text x=\"80\" y=\"303\" text-anchor=\"middle\" font-style=\"italic\">-h</text>"
        "<text x=\"400\" y=\"303\" text-anchor=\"middle\" font-style=\"italic\">h</text>"
        "<text x=\"470\" y=\"165\" text-anchor=\"end\" fill=\"#d03030\">equation 3</text>"
        "<text x=\"470\" y=\"185\" text-anchor=\"end\" fill=\"#333333\">equation 2</text>\n";
    return svg(2.0 * kEdge, 310.0, body);
}

}  // namespace

std::string stencil_diagram(char part) {
    return part == 'a' ? stencil() : part == 'b' ? stencil_across_edge() : crossing_disc();
}

}  // namespace inktrace::cli

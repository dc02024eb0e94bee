#include "gallery_page.h"

#include <fmt/format.h>

namespace inktrace::cli {

namespace {

constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Ray Tracing NPR-Style Feature Lines, remade by Inktrace</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 1500px; margin: 2.5em auto; padding: 0 1.5em }
h1 { font-weight: 600 } h2 { margin: 2.2em 0 .2em; font-weight: 600 }
p { max-width: 46em; margin: .3em 0 1em } nav a { margin-right: .9em }
.row { display: flex; flex-wrap: wrap; gap: 1.2em }
.pairs { display: grid; grid-template-columns: repeat(2, max-content); gap: 1.2em }
figure { margin: 0; max-width: 480px } img { display: block; max-width: 100%; border: 1px solid #ddd }
figcaption { margin-top: .4em; color: #444; font-size: 15px }
details { font-size: 13px; color: #777 } code { font-size: 90% }
table { border-collapse: collapse; margin: .5em 0 1.5em } caption { text-align: left; font-weight: 600; padding-bottom: .4em }
th, td { padding: .25em 1em; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap }
th:first-child { text-align: left } td small { color: #777 }
</style>
<h1>Ray Tracing NPR-Style Feature Lines, remade</h1>
<p>Every figure and table of A.N.M. Imroz Choudhury and Steven G. Parker, <cite>Ray Tracing NPR-Style
Feature Lines</cite>, NPAR 2009, drawn by <code>inktrace gallery</code>. Lines are the paper's ray
stencils unless a caption says otherwise; scenes and data are our own.</p>
)";

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    return result;
}

/// What draws a panel alone.
std::string command(const Panel& panel) {
    std::string words = panel.scene == kMesh
                            ? "inktrace render MESH"
                            : fmt::format("inktrace render scenes/{}", panel.scene);
    for (const auto& [name, value] : panel.settings) words += fmt::format(" --{} {}", name, value);
    return words + fmt::format(" -o {}.png", panel.name);
}

std::string figure_of(const Panel& panel) {
    std::string html = fmt::format(R"(<figure><img src="{}.{}" alt="{}"><figcaption>{})",
                                   panel.name, panel.is_diagram ? "svg" : "png",
                                   escaped(panel.caption), escaped(panel.caption));
    if (!panel.scene.empty()) {
        html += fmt::format("<details><summary>command</summary><code>{}</code></details>",
                            escaped(command(panel)));
    }
    return html + "</figcaption></figure>\n";
}

std::string cell(const GalleryTable& table, std::size_t row, std::size_t column) {
    const double paper = table.paper[row][column];
    if (paper == 0.0) return "<td>N/A</td>";
    if (table.rows.empty()) return fmt::format("<td>{:g}</td>", paper);
    const double plain = table.rows[0].cells[0]->frames_per_second;
    const double here = table.rows[row].cells[column]->frames_per_second;
    return fmt::format("<td>{} <small>1/{} &nbsp; paper {:g}, 1/{}</small></td>",
                       short_number(here), short_number(plain / here), paper,
                       short_number(table.paper[0][0] / paper));
}

std::string html_of(const GalleryTable& table) {
    std::string html = fmt::format("<table><caption>{}</caption>\n<tr><th></th>", table.title);
    for (const char* column : kBenchColumns) html += fmt::format("<th>{}</th>", column);
    html += "</tr>\n";
    for (std::size_t row = 0; row < kBenchRows.size(); ++row) {
        html += fmt::format("<tr><th>{}</th>", kBenchRows[row]);
        for (std::size_t column = 0; column < kBenchColumns.size(); ++column) {
            html += cell(table, row, column);
        }
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

std::string number_of(const Figure& figure) {
    return figure.title.substr(0, figure.title.find(':'));
}

}  // namespace

std::string gallery_page(const std::vector<Figure>& figures,
                         const std::vector<GalleryTable>& tables) {
    std::string html = kHead;
    html += "<nav>";
    for (const Figure& figure : figures) {
        html += fmt::format("<a href=\"#{0}\">{0}</a>", number_of(figure));
    }
    html += "<a href=\"#Tables\">Tables 1 and 2</a></nav>\n";
    for (const Figure& figure : figures) {
        const bool pairs = number_of(figure) == "Figure 10";
        html +=
            fmt::format("<h2 id=\"{}\">{}</h2>\n<p>{}</p>\n<div class=\"{}\">\n", number_of(figure),
                        figure.title, escaped(figure.text), pairs ? "pairs" : "row");
        for (const Panel& panel : figure.panels) html += figure_of(panel);
        html += "</div>\n";
    }
    const bool measured = !tables.empty() && !tables[0].rows.empty();
    html += fmt::format(
        "<h2 id=\"Tables\">Tables 1 and 2: frame rates</h2>\n<p>Frames a second for the scene of "
        "Figure 1. {}</p>\n",
        measured
            ? "Measured here at 512 x 512 pixels; small, the share of the rate without lines "
              "and the paper's numbers."
            : "These are the paper's; <code>inktrace gallery --tables</code> and <code>inktrace "
              "bench</code> measure ours beside them.");
    for (const GalleryTable& table : tables) html += html_of(table);
    return html + "</html>\n";
}

}  // namespace inktrace::cli

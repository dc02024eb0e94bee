#!/usr/bin/env python3
"""Draws the results of inktrace-curves as SVG: plot_curves.py curves.json docs/images/"""

import json
import math
import pathlib
import sys

WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 460, 320, 62, 46, 34, 14
INK = {"stencil": "#c8553d", "edges": "#1f5c99"}


class LogLog:
    """A diagram with logarithmic axes."""

    def __init__(self, title, x_label, y_label, points, x0=0):
        self.x0 = x0
        self.range = [self._decades([p[axis] for p in points]) for axis in (0, 1)]
        self.parts = []
        self._text(x0 + WIDTH / 2, 18, title, "middle", 13)
        self._text(x0 + (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, x_label, "middle")
        self._text(x0 + 14, HEIGHT / 2, y_label, "middle", turn=True)
        for axis in (0, 1):
            low, high = self.range[axis]
            for decade in range(math.floor(low), math.ceil(high) + 1):
                for step in (1, 2, 5):
                    value = step * 10.0**decade
                    if low - 1e-9 <= math.log10(value) <= high + 1e-9:
                        self._grid(axis, value, step == 1)

    @staticmethod
    def _decades(values):
        low, high = math.log10(min(values)), math.log10(max(values))
        pad = max(0.08 * (high - low), 0.05)
        return low - pad, high + 2 * pad  # room for labels

    def place(self, x, y):
        share = [(math.log10(v) - r[0]) / (r[1] - r[0]) for v, r in zip((x, y), self.range)]
        return (
            self.x0 + LEFT + share[0] * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM - share[1] * (HEIGHT - BOTTOM - TOP),
        )

    def _grid(self, axis, value, strong):
        low = [10 ** r[0] for r in self.range]
        high = [10 ** r[1] for r in self.range]
        ends = [(value, low[1]), (value, high[1])] if axis == 0 else [(low[0], value), (high[0], value)]
        (xa, ya), (xb, yb) = (self.place(*end) for end in ends)
        color = "#bbb" if strong else "#e6e6e6"
        self.parts.append(f'<path d="M{xa:.1f} {ya:.1f}L{xb:.1f} {yb:.1f}" stroke="{color}"/>')
        if not strong and self.range[axis][1] - self.range[axis][0] > 3.5:
            return  # no room for its label
        label = f"{value:g}" if value < 1e6 else f"{value / 1e6:g} M"
        if axis == 0:
            self._text(xa, HEIGHT - BOTTOM + 14, label, "middle", 10)
        else:
            self._text(self.x0 + LEFT - 5, ya + 3.5, label, "end", 10)

    def _text(self, x, y, text, anchor, size=11, turn=False):
        turned = f' transform="rotate(-90 {x} {y})"' if turn else ""
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}"{turned}>{text}</text>'
        )

    def dot(self, x, y, color, label=""):
        px, py = self.place(x, y)
        self.parts.append(f'<circle cx="{px:.1f}" cy="{py:.1f}" r="3.5" fill="{color}"/>')
        if label:
            self._text(px + 6, py - 5, label, "start", 9)

    def line(self, points, color):
        path = "L".join(f"{px:.1f} {py:.1f}" for px, py in (self.place(*p) for p in points))
        self.parts.append(f'<path d="M{path}" fill="none" stroke="{color}" stroke-width="1.5"/>')


def write(file, diagrams):
    width = WIDTH * len(diagrams)
    body = "\n".join(part for diagram in diagrams for part in diagram.parts)
    file.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{HEIGHT}" '
        f'viewBox="0 0 {width} {HEIGHT}" font-family="sans-serif">\n'
        f'<rect width="{width}" height="{HEIGHT}" fill="#fff"/>\n{body}\n</svg>\n'
    )
    print(file)


def frontier(rows):
    diagrams = []
    titles = {"linear": "Shading and soft lines, acetaminophen", "solid": "Solid line, one sphere"}
    for k, profile in enumerate(titles):
        # Solid lines are the same whether colours are averaged over the stencil or not.
        chosen = [
            row
            for row in rows
            if row["profile"] == profile and not (profile == "solid" and row["way"].endswith(" stencil"))
        ]
        points = [(row["ms"], row["rmse"]) for row in chosen]
        diagram = LogLog(titles[profile], "time, ms", "error (RMSE)", points, k * WIDTH)
        for row in chosen:
            name = row["way"].replace("stencil N", "N").replace("edges ", "")
            name = name.replace("multisample:", "ms ").replace(" none", "")
            diagram.dot(row["ms"], row["rmse"], INK[row["method"]], name)
        diagrams.append(diagram)
    return diagrams


def growth(rows):
    diagrams = []
    titles = {"spheres": "number of spheres", "side": "side of the picture, pixels", "width": "width of lines, pixels"}
    for k, along in enumerate(titles):
        chosen = sorted((row for row in rows if row["along"] == along), key=lambda row: row["at"])
        if len(chosen) < 2:
            continue
        curves = {
            "with lines": ([(row["at"], row["ms"]) for row in chosen], INK["edges"]),
            "without": ([(row["at"], row["plain_ms"]) for row in chosen], "#888"),
        }
        points = [point for curve, _ in curves.values() for point in curve]
        diagram = LogLog("", titles[along], "time, ms", points, k * WIDTH)
        for name, (curve, color) in curves.items():
            diagram.line(curve, color)
            for point in curve:
                diagram.dot(*point, color, name if point == curve[1] else "")
        diagrams.append(diagram)
    return diagrams


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    results = json.loads(pathlib.Path(sys.argv[1]).read_text())
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    if results["frontier"]:
        write(folder / "frontier.svg", frontier(results["frontier"]))
    if results["growth"]:
        write(folder / "growth.svg", growth(results["growth"]))


if __name__ == "__main__":
    main()

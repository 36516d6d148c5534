"""Draws the convergence of shells by the tables of docs/validation.md. Usage: convergence.py

The page has the shares of published deflections on four meshes of each problem. The picture docs/images/shell_convergence.svg shows
them over the number of nodes along a side of the mesh (of LE3 along a side of a block), so elements with mid-side nodes count twice their
cells.
"""

import math
import pathlib
import re

DOCS = pathlib.Path(__file__).parent.parent / "docs"
PROBLEMS = [
    ("Cook's membrane", "Cook's membrane"),
    ("roof", "Scordelis and Lo's roof"),
    ("hemisphere", "Hemisphere with an opening"),
    ("twisted beam in its plane", "Twisted beam, in its plane"),
    ("twisted beam across", "Twisted beam, across"),
    ("thin twisted beam in its plane", "Thin twisted beam, in its plane"),
    ("thin twisted beam across", "Thin twisted beam, across"),
    ("LE3, hemisphere", "NAFEMS LE3"),
]
NAMES = ["quadrilateral", "triangle", "triangle with drilling", "eight nodes", "six nodes"]
COLORS = ["#0b62a4", "#c1440e", "#5b8c2a", "#0b62a4", "#c1440e"]
DASHED = [False, False, False, True, True]
WIDE, HIGH, LEFT, TOP = 210, 150, 46, 40
FROM, TO = 0.0, 1.15


Line = tuple[list[int], list[float]]


def rows(page: str) -> dict[str, list[Line]]:
    """For each problem the lines of its elements in the order of their names: nodes along the longest side, and shares."""
    found: dict[tuple[str, bool], list[Line]] = {}
    last: dict[bool, list[int]] = {}
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        name = next((known for known, _ in PROBLEMS if re.match(re.escape(known) + r"(,|$)", cells[0])), None)
        if name is None or len(cells) not in {3, 4}:
            continue
        quadratic = len(cells) == 3
        # the last line of a beam names no meshes: it has those of the line above
        cuts = cells[0][len(name) :]
        counts = re.findall(r"(\d+)²" if "²" in cuts else r"(\d+) × \d+", cuts)
        meshes = last[quadratic] = [int(count) for count in counts] or last[quadratic]
        nodes = [count * (2 if quadratic else 1) + 1 for count in meshes]
        shares = [[float(share) for share in re.findall(r"\d+\.\d+", cell)] for cell in cells[1:]]
        found[name, quadratic] = [(nodes, own) for own in shares]
    return {name: found[name, False] + found[name, True] for name, _ in PROBLEMS}


def panel(title: str, lines: list[Line], x0: float, y0: float) -> list[str]:
    """The picture of a problem with its top left corner."""
    most = max(max(nodes) for nodes, _ in lines)
    least = min(min(nodes) for nodes, _ in lines)

    def x(nodes: float) -> float:
        return x0 + WIDE * math.log(nodes / least) / math.log(most / least)

    def y(share: float) -> float:
        return y0 + HIGH * (1 - (share - FROM) / (TO - FROM))

    out = [f'<text x="{x0}" y="{y0 - 8}" font-weight="bold">{title}</text>']
    for share in (0, 0.25, 0.5, 0.75, 1):
        line = "#444" if share == 1 else "#ddd"
        out.append(f'<path d="M{x0} {y(share):.1f}h{WIDE}" stroke="{line}"/>')
        out.append(f'<text x="{x0 - 6}" y="{y(share) + 4:.1f}" text-anchor="end">{share:g}</text>')
    ticks = sorted({nodes for places, _ in lines for nodes in places})
    shown = 0.0
    for nodes in ticks:
        if x(nodes) - shown > 22 or nodes == least:
            out.append(f'<text x="{x(nodes):.1f}" y="{y0 + HIGH + 16}" text-anchor="middle">{nodes:g}</text>')
            shown = x(nodes)
    for (places, shares), color, dashed in zip(lines, COLORS, DASHED):
        points = [(x(nodes), y(share)) for nodes, share in zip(places, shares, strict=True)]
        path = "L".join(f"{a:.1f} {b:.1f}" for a, b in points)
        dash = ' stroke-dasharray="5 3"' if dashed else ""
        out.append(f'<path d="M{path}" fill="none" stroke="{color}" stroke-width="1.6"{dash}/>')
        out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="2.4" fill="{color}"/>' for a, b in points]
    return out


def main() -> None:
    """Writes the picture."""
    found = rows((DOCS / "validation.md").read_text())
    width, height = 4 * (WIDE + LEFT) + 24, 2 * (HIGH + TOP + 30) + 40
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for place, (name, title) in enumerate(PROBLEMS):
        lines = found[name]
        assert len(lines) == len(NAMES), (name, len(lines))
        row, column = divmod(place, 4)
        out += panel(title, lines, LEFT + column * (WIDE + LEFT), TOP + row * (HIGH + TOP + 30))
    x = float(LEFT)
    for name, color, dashed in zip(NAMES, COLORS, DASHED):
        dash = ' stroke-dasharray="5 3"' if dashed else ""
        out.append(f'<path d="M{x} {height - 24}h26" stroke="{color}" stroke-width="1.6"{dash}/>')
        out.append(f'<text x="{x + 32}" y="{height - 20}">{name}</text>')
        x += 32 + 7 * len(name) + 24
    (DOCS / "images/shell_convergence.svg").write_text("\n".join([*out, "</svg>", ""]))


if __name__ == "__main__":
    main()

"""Makes bar.bdf and bar_loose.bdf: a steel bar of 20 x 20 x 200 mm along z of eight CHEXA of 20 nodes, in mm, tonne, s.

bar_loose.bdf has a cube beside the bar that nothing holds, and a spring that is not read.
"""

from pathlib import Path

# corners, then edges of a CHEXA: bottom, upright, top (Nastran's order), in halves of the element
CORNERS = [(0, 0), (2, 0), (2, 2), (0, 2)]
EDGES = [(1, 0), (2, 1), (1, 2), (0, 1)]
SHAPE = (
    [(x, y, 0) for x, y in CORNERS]
    + [(x, y, 2) for x, y in CORNERS]
    + [(x, y, 0) for x, y in EDGES]
    + [(x, y, 1) for x, y in CORNERS]
    + [(x, y, 2) for x, y in EDGES]
)
LONG = 8


def fields(*values):
    return "".join(f"{v:<8}" for v in values)


def write(path, nodes, hexas, extra=()):
    lines = ["$ made by make_bar.py", "BEGIN BULK", fields("MAT1", 1, "210000.", "", "0.3", "7.85-9"), fields("PSOLID", 1, 1)]
    lines += [fields("GRID", n, "", *(f"{c:.3f}" for c in p)) for n, p in nodes.items()]
    for e, corners in enumerate(hexas, 1):
        lines.append(fields("CHEXA", e, 1, *corners[:6]))
        for k in range(6, len(corners), 8):
            lines.append(fields("", *corners[k : k + 8]))
    Path(path).write_text("\n".join([*lines, *extra, "ENDDATA"]) + "\n")


nodes, hexas, numbers = {}, [], {}
for k in range(LONG):
    element = []
    for x, y, z in SHAPE:
        place = (10.0 * x - 10.0, 10.0 * y - 10.0, (k + z / 2) * 200.0 / LONG)
        number = numbers.setdefault(place, len(numbers) + 1)
        nodes[number] = place
        element.append(number)
    hexas.append(element)
here = Path(__file__).parent
write(here / "bar.bdf", nodes, hexas)
cube = {1000 + i: (100.0 + 5 * x, 5.0 * y, 5.0 * z) for i, (x, y, z) in enumerate([(*c, 0) for c in CORNERS] + [(*c, 2) for c in CORNERS])}
write(here / "bar_loose.bdf", nodes | cube, [*hexas, list(cube)], [fields("CGAP", 9000, 1, 1, 2)])

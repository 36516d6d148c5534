"""Makes shell.inp: a ring of 20-node hexahedra around a bearing of radius 27 mm and width 24 mm, 13 mm thick, in m, kg, s.

The set FOOT has the nodes of the outer surface within 30 degrees of -y. The modulus is a tenth of that of steel, so that the ring
yields by a good part of a clearance.
"""

from math import cos, pi, sin
from pathlib import Path

AROUND, WALL, ALONG = 24, 1, 2
INNER, OUTER, WIDTH = 0.027, 0.040, 0.024


def number(i, j, k):
    return 1 + i % (2 * AROUND) + 2 * AROUND * (j + (2 * WALL + 1) * k)


lines = ["** made by make_shell.py", "*NODE"]
foot = []
for k in range(2 * ALONG + 1):
    for j in range(2 * WALL + 1):
        for i in range(2 * AROUND):
            if i % 2 + j % 2 + k % 2 > 1:
                continue
            angle, radius = pi * i / AROUND, INNER + (OUTER - INNER) * j / (2 * WALL)
            x, y, z = radius * cos(angle), radius * sin(angle), WIDTH * (k / (2 * ALONG) - 0.5)
            lines.append(f"{number(i, j, k)}, {x:.10f}, {y:.10f}, {z:.10f}")
            if j == 2 * WALL and abs(angle - 1.5 * pi) < pi / 6 + 1e-9:
                foot.append(number(i, j, k))
lines.append("*ELEMENT, TYPE=C3D20, ELSET=ALL")
corners, middles = [(0, 0), (0, 2), (2, 2), (2, 0)], [(0, 1), (1, 2), (2, 1), (1, 0)]
element = 0
for k in range(0, 2 * ALONG, 2):
    for j in range(0, 2 * WALL, 2):
        for i in range(0, 2 * AROUND, 2):
            element += 1
            levels = [(corners, 0), (corners, 2), (middles, 0), (middles, 2), (corners, 1)]
            nodes = [number(i + a, j + b, k + up) for places, up in levels for a, b in places]
            lines.append(", ".join(map(str, [element, *nodes[:10]])) + ",")
            lines.append(", ".join(map(str, nodes[10:])))
lines.append("*NSET, NSET=FOOT")
lines += [", ".join(map(str, foot[n : n + 12])) for n in range(0, len(foot), 12)]
lines += ["*MATERIAL, NAME=SOFT", "*ELASTIC", "2.1e10, 0.3", "*DENSITY", "7850.", "*SOLID SECTION, ELSET=ALL, MATERIAL=SOFT"]
Path(__file__).with_name("shell.inp").write_text("\n".join(lines) + "\n")

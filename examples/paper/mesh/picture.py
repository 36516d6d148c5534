"""Draws both meshes as make.py builds them: meshes.png in the folder given, else here.

    python picture.py [FOLDER]
"""

import sys
from pathlib import Path

import make
import matplotlib
import numpy as np
import parts
import solids
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402

COLOURS = {
    "MAIN": "#d95f02",
    "PIN": "#1b9e77",
    "BORE": "#7570b3",
    "MOUNT": "#e7298a",
    "DECK": "#66a61e",
    "FLANGE": "#a6761d",
    "SNOUT": "#a6761d",
}


def draw(axes, part, azimuth, elevation, title):
    """The surface as seen from a side: azimuth about x (up) from y towards z, elevation above the y-z plane; degrees."""
    faces = parts.skin(part.elements)
    a, e = np.radians(azimuth), np.radians(elevation)
    away = np.array([np.sin(e), np.cos(e) * np.cos(a), np.cos(e) * np.sin(a)])  # towards the eye
    right = np.array([0, -np.sin(a), np.cos(a)])
    up = np.cross(away, right)
    corners = part.nodes[faces[:, :3]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    seen = normal @ away > 0
    faces, corners, normal = faces[seen], corners[seen], normal[seen]
    light = np.array([0.5, 0.35, 0.2]) @ np.stack([up, right, away]) + 0.5 * away
    shade = 0.45 + 0.55 * np.abs(normal @ (light / np.linalg.norm(light)))
    base = np.tile(np.array(matplotlib.colors.to_rgb("#b8bec6")), (len(faces), 1))
    for name, chosen in part.sets.items():
        inside = np.zeros(len(part.nodes), dtype=bool)
        inside[chosen] = True
        base[np.all(inside[faces], axis=1)] = matplotlib.colors.to_rgb(COLOURS[name.rstrip("0123456789")])
    order = np.argsort(corners.mean(axis=1) @ away)
    # the six nodes in order round the face
    ring = part.nodes[faces[:, [0, 3, 1, 4, 2, 5]]]
    outline = np.stack([ring @ right, ring @ up], axis=-1)
    colours = (base * shade[:, None])[order]
    axes.add_collection(PolyCollection(outline[order], facecolors=colours, edgecolors=(0, 0, 0, 0.3), linewidths=0.2))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_title(title, fontsize=9)


def main(folder):
    """Both parts, each from above and from below."""
    figure, axes = plt.subplots(2, 2, figsize=(11, 8.2), dpi=100)
    for row, part in zip(axes, make.build()):
        draw(row[0], part, -35, 30, f"{part.name}: {len(part.nodes)} nodes, {len(part.elements)} elements")
        draw(row[1], part, -35, -40, "from below")
    figure.tight_layout()
    figure.canvas.draw()
    seen = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    seen.quantize(48, dither=Image.Dither.NONE).save(folder / "meshes.png", optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)

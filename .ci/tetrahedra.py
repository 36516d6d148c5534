"""Free frequencies of cranks of tetrahedra, for comparison with stacked sections. Usage: tetrahedra.py CCX CRANK SIZE EDGE

CCX is CalculiX' command, CRANK is paper, three or split. Gmsh (pip install gmsh) makes the solid by a Boolean union of cylinders and prisms,
and fills it with ten-node tetrahedra. Their edges have SIZE mm, and EDGE mm where sections meet: there are no fillets, so stresses grow
without limit at these corners. CalculiX computes the free body. The script prints the volume, the numbers of nodes and elements, and twelve
frequencies (Hz) above the rigid motions. `tests/stacks.rs` has such frequencies, of Gmsh 4.15.2 and CalculiX 2.20.
"""

import pathlib
import re
import subprocess
import sys
import tempfile
from math import cos, radians, sin

import gmsh

DENSITY = 7.85e-9  # t/mm³
RIGID = 1e6  # (rad/s)², above the eigenvalues of rigid motions and below all others


class Solid:
    """Prisms, one on another along z."""

    def __init__(self, begin: float):
        self.at = begin
        self.parts: list[tuple[int, int]] = []

    def disc(self, radius: float, length: float, center=(0.0, 0.0)) -> None:
        """A cylinder on what is there."""
        self.parts.append((3, gmsh.model.occ.addCylinder(*center, self.at, 0, 0, length, radius)))
        self.at += length

    def outline(self, path: list, length: float) -> None:
        """A closed path of points and arcs: (x, y) begins a line to the next point, (x, y, (cx, cy), (mx, my)) an arc about c over m."""
        occ = gmsh.model.occ
        ends = [occ.addPoint(*corner[:2], self.at) for corner in path]
        curves = []
        for corner, first, second in zip(path, ends, ends[1:] + ends[:1]):
            if len(corner) == 2:
                curves.append(occ.addLine(first, second))
            else:
                center = occ.addPoint(*corner[2], self.at)
                middle = occ.addPoint(*corner[3], self.at)
                curves += [occ.addCircleArc(first, center, middle), occ.addCircleArc(middle, center, second)]
        face = occ.addPlaneSurface([occ.addCurveLoop(curves)])
        self.parts += [part for part in occ.extrude([(2, face)], 0, 0, length) if part[0] == 3]
        self.at += length



def turned(point, angle):
    """A point turned about the crank's axis."""
    return (cos(angle) * point[0] - sin(angle) * point[1], sin(angle) * point[0] + cos(angle) * point[1])


def web(solid, angle, throw, thickness, pin_radius, waist, weight_radius, weight_angle) -> None:
    """An arc of 200 degrees about the pin, lines over the waist to a sector about the crank's axis."""

    def pin(at):
        return turned((throw + pin_radius * cos(radians(at)), pin_radius * sin(radians(at))), angle)

    def weight(at):
        return turned((weight_radius * cos(radians(at)), weight_radius * sin(radians(at))), angle)

    path = [
        (*pin(-100), turned((throw, 0), angle), pin(0)),
        pin(100),
        turned(waist, angle),
        (*weight(weight_angle), (0.0, 0.0), weight(180)),
        weight(-weight_angle),
        turned((waist[0], -waist[1]), angle),
    ]
    solid.outline(path, thickness)


def link(solid, radius, thickness, first, second) -> None:
    """Two discs of one radius and all between them."""
    apart = (second[0] - first[0], second[1] - first[1])
    reach = (apart[0] ** 2 + apart[1] ** 2) ** 0.5
    along = (apart[0] * radius / reach, apart[1] * radius / reach)
    side = (along[1], -along[0])
    path = [
        (first[0] + side[0], first[1] + side[1]),
        (second[0] + side[0], second[1] + side[1], second, (second[0] + along[0], second[1] + along[1])),
        (second[0] - side[0], second[1] - side[1]),
        (first[0] - side[0], first[1] - side[1], first, (first[0] - along[0], first[1] - along[1])),
    ]
    solid.outline(path, thickness)


def three() -> Solid:
    """Three throws of 46 mm, journals of 44 and 38 mm that do not overlap (a gap of 5 mm)."""
    solid = Solid(0.0)
    solid.disc(18, 30)
    for turn in (0, 240, 120):
        angle = radians(turn)
        solid.disc(22, 24)
        web(solid, angle, 46, 18, 29, (3, 32), 66, 106)
        solid.disc(19, 26, turned((46, 0), angle))
        web(solid, angle, 46, 18, 29, (3, 32), 66, 106)
    solid.disc(22, 24)
    solid.disc(36, 12)
    return solid


def split() -> Solid:
    """A V6: three throws of 40 mm with two pins each, 30 degrees apart, journals of 64 and 54 mm."""
    solid = Solid(0.0)
    solid.disc(20, 40)
    for turn in (0, 120, 240):
        first, second = radians(turn + 15), radians(turn - 15)
        pins = [turned((40, 0), first), turned((40, 0), second)]
        solid.disc(32, 24)
        web(solid, first, 40, 16, 36, (5, 40), 70, 104)
        solid.disc(27, 20, pins[0])
        link(solid, 36, 8, *pins)
        solid.disc(27, 20, pins[1])
        web(solid, second, 40, 16, 36, (5, 40), 70, 104)
    solid.disc(32, 24)
    solid.disc(45, 12)
    return solid


def paper() -> Solid:
    """The crank of examples/paper/mesh/make.py."""
    solid = Solid(-230.0)
    solid.disc(40, 10)
    solid.disc(23, 24)
    for turn in (0, 180, 180, 0):
        angle = radians(turn)
        solid.disc(27, 24)
        web(solid, angle, 43, 20, 34, (4, 37), 73, 106)
        solid.disc(24, 28, turned((43, 0), angle))
        web(solid, angle, 43, 20, 34, (4, 37), 73, 106)
    solid.disc(27, 24)
    solid.disc(23, 24)
    solid.disc(40, 10)
    return solid


CRANKS = {"paper": paper, "three": three, "split": split}
YOUNG, POISSON = {"paper": 206e3, "three": 210e3, "split": 210e3}, {"paper": 0.29, "three": 0.3, "split": 0.3}


def meshed(name: str, size: float, edge: float):
    """Numbers and places of the nodes of a crank, numbers and nodes of its elements."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    solid = CRANKS[name]()
    gmsh.model.occ.fuse(solid.parts[:1], solid.parts[1:])
    gmsh.model.occ.synchronize()
    assert len(gmsh.model.getEntities(3)) == 1
    print(f"  volume {gmsh.model.occ.getMass(3, gmsh.model.getEntities(3)[0][1]):.1f} mm³")
    edges = []
    for dimension, curve in gmsh.model.getEntities(1):
        box = gmsh.model.getBoundingBox(dimension, curve)
        if box[5] - box[2] < 1e-3:  # in a plane between two sections
            edges.append(curve)
    field = gmsh.model.mesh.field
    near = field.add("Distance")
    field.setNumbers(near, "CurvesList", edges)
    field.setNumber(near, "Sampling", 60)
    graded = field.add("MathEval")
    field.setString(graded, "F", f"Min({size}, {edge} + 0.5*F{near})")
    field.setAsBackgroundMesh(graded)
    for option in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
    gmsh.option.setNumber("Mesh.Algorithm3D", 10)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 2)
    gmsh.model.mesh.generate(3)
    tags, places, _ = gmsh.model.mesh.getNodes()
    kinds, elements, nodes = gmsh.model.mesh.getElements(3)
    assert list(kinds) == [11]
    quality = gmsh.model.mesh.getElementQualities(elements[0], "minDetJac")
    assert min(quality) > 0, min(quality)
    result = tags, places.reshape(-1, 3), elements[0], nodes[0].reshape(-1, 10)
    gmsh.finalize()
    return result


def main() -> None:
    """Prints the frequencies of one crank."""
    ccx, name, size, edge = sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
    tags, places, elements, nodes = meshed(name, size, edge)
    used = set(nodes.ravel().tolist())
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{tag},{x:.9g},{y:.9g},{z:.9g}" for tag, (x, y, z) in zip(tags, places) if int(tag) in used]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=ALL"]
    # Gmsh has the last two mid-side nodes in the other order
    lines += [",".join(map(str, [tag, *row[:8], row[9], row[8]])) for tag, row in zip(elements, nodes)]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG[name]},{POISSON[name]}", "*DENSITY", str(DENSITY)]
    lines += ["*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL", "*STEP", "*FREQUENCY", "18", "*END STEP", ""]
    print(f"{name}, {size:g} mm, {edge:g} mm at the edges: {len(used)} nodes, {len(elements)} elements", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "crank.inp"
        deck.write_text("\n".join(lines))
        run = subprocess.run([ccx, "crank"], cwd=folder, capture_output=True, text=True)
        result = deck.with_suffix(".dat")
        assert result.exists(), run.stdout[-2000:]
        table = result.read_text().split("P A R T I C I P A T I O N")[0]
    rows = re.findall(r"^\s+\d+\s+(-?\d\S*)\s+(\d\S*)\s+(\d\S*)\s+(\d\S*)\s*$", table, re.M)
    found = [float(row[2]) for row in rows if float(row[0]) > RIGID]
    print(" ", ", ".join(f"{frequency:.4f}" for frequency in found[:12]))


if __name__ == "__main__":
    main()

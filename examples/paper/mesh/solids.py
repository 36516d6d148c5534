"""The solids of the two parts (a quarter each: y > 0, z < 0), and the definitions of their sets; gmsh's OpenCASCADE kernel, mm."""

from dataclasses import dataclass
from math import cos, radians, sin

import gmsh

occ = gmsh.model.occ


@dataclass(frozen=True)
class Ring:
    """Surface nodes on a cylinder: radius about the axis through `center`, half of `width` to either side along it."""

    center: tuple
    axis: int  # 0, 1, 2: x, y, z
    radius: float
    width: float


@dataclass(frozen=True)
class Patch:
    """Surface nodes in a plane, within a box."""

    axis: int
    at: float
    low: tuple
    high: tuple


def quarter(volumes):
    """The part of the volumes in y > 0, z < 0, as one volume."""
    fused = occ.fuse(volumes[:1], volumes[1:])[0] if len(volumes) > 1 else volumes
    box = [(3, occ.addBox(-500, 0, -500, 1000, 500, 500))]
    kept = occ.intersect(fused, box)[0]
    if len(kept) != 1:
        raise SystemExit(f"the part is in {len(kept)} pieces")
    return kept


def outline(points_and_arcs, z, thickness):
    """A prism. Items: ("to", x, y) or ("arc", cx, cy, x, y); closed by a line to the start."""
    start = occ.addPoint(*points_and_arcs[0][1:3], z)
    last, curves = start, []
    for kind, *figures in points_and_arcs[1:]:
        if kind == "to":
            point = occ.addPoint(*figures, z)
            curves.append(occ.addLine(last, point))
        else:
            center, point = occ.addPoint(*figures[:2], z), occ.addPoint(*figures[2:], z)
            curves.append(occ.addCircleArc(last, center, point))
        last = point
    curves.append(occ.addLine(last, start))
    face = occ.addPlaneSurface([occ.addCurveLoop(curves)])
    return next(e for e in occ.extrude([(2, face)], 0, 0, thickness) if e[0] == 3)


def crank(e, c):
    """Builds the crank's quarter; gives the sizes of its elements."""
    if abs(c.main_width_mm + c.pin_width_mm + 2 * c.web_mm - e.spacing_mm) > 1e-9:
        raise SystemExit("main, pin and two webs don't add up to the spacing")
    volumes = []

    def cylinder(x, low, length, diameter):
        volumes.append((3, occ.addCylinder(x, 0, low, 0, 0, length, diameter / 2)))

    for j in (1, 2, 3):
        cylinder(0, (j - 3) * e.spacing_mm - c.main_width_mm / 2, c.main_width_mm, e.main_diameter_mm)
    for i, side in ((1, 1), (2, -1)):
        middle, half = (i - 2.5) * e.spacing_mm, c.pin_width_mm / 2
        cylinder(side * e.throw_mm, middle - half, c.pin_width_mm, c.pin_diameter_mm)
        for z in (middle - half - c.web_mm, middle + half):
            volumes.append(web(e, c, side, z))
    cylinder(0, -c.end_mm, c.end_mm - 2 * e.spacing_mm - c.main_width_mm / 2, c.neck_diameter_mm)
    cylinder(0, -c.end_mm, c.flange_mm, c.flange_diameter_mm)
    quarter(volumes)
    occ.synchronize()
    journals = on_rings(crank_sets(e, c).values())
    return {"size": c.size_mm, "near": [(journals, c.journal_size_mm, 1.0, 20.0)]}


def cylinders():
    """Surfaces that are part of a cylinder."""
    return [s for _, s in gmsh.model.getEntities(2) if gmsh.model.getType(2, s) == "Cylinder"]


def on_rings(rings):
    """Those of them that lie on one of the rings."""
    found = []
    for surface in cylinders():
        box = gmsh.model.getBoundingBox(2, surface)
        for ring in rings:
            reach = [ring.width / 2 if k == ring.axis else ring.radius for k in range(3)]
            low = all(box[k] > ring.center[k] - reach[k] - 1e-3 for k in range(3))
            high = all(box[3 + k] < ring.center[k] + reach[k] + 1e-3 for k in range(3))
            wide = max(box[3 + k] - box[k] for k in range(3) if k != ring.axis) > ring.radius
            if low and high and wide:
                found.append(surface)
                break
    return found


def web(e, c, side, z):
    """A web with its counterweight; `side`: where its pin is along x."""
    angle, start = radians(c.web_pin_angle_deg), radians(c.counterweight_angle_deg)
    r, weight, throw = c.web_pin_radius_mm, c.counterweight_radius_mm, e.throw_mm
    along, half = c.web_waist_mm
    shape = [
        ("to", side * (throw + r), 0),
        ("arc", side * throw, 0, side * (throw + r * cos(angle)), r * sin(angle)),
        ("to", side * along, half),
        ("to", side * weight * cos(start), weight * sin(start)),
        ("arc", 0, 0, -side * weight, 0),
    ]
    return outline(shape, z, c.web_mm)


def crank_sets(e, c):
    """Sets of the crank by name."""
    sets = {}
    for j in range(1, 6):
        sets[f"MAIN{j}"] = Ring((0, 0, (j - 3) * e.spacing_mm), 2, e.main_diameter_mm / 2, c.main_width_mm)
    for i, side in enumerate((1, -1, -1, 1), 1):
        center = (side * e.throw_mm, 0, (i - 2.5) * e.spacing_mm)
        sets[f"PIN{i}"] = Ring(center, 2, c.pin_diameter_mm / 2, c.pin_width_mm)
    for name, z in (("FLANGE", c.end_mm), ("SNOUT", -c.end_mm)):
        # the rim, from its centre on the outer face
        sets[name] = Ring((0, 0, z), 2, c.flange_diameter_mm / 2, 2 * c.flange_mm)
    return sets


def extent(surface, axis):
    """Length of a surface along an axis."""
    box = gmsh.model.getBoundingBox(2, surface)
    return box[3 + axis] - box[axis]


def block(e, b):
    """Builds the block's quarter; gives the sizes of its elements."""
    end, deck, foot = b.end_mm, e.deck_height_mm, b.barrel_foot_mm
    outside = b.crankcase_half_mm + b.crankcase_mm
    jacket = b.jacket_half_mm
    volumes = []

    def box(x, y, z):
        volumes.append((3, occ.addBox(x[0], y[0], z[0], x[1] - x[0], y[1] - y[0], z[1] - z[0])))

    # cylinders in their water jacket
    box((deck - b.deck_mm, deck), (-jacket, jacket), (-end, 0))
    box((foot, foot + b.floor_mm), (-jacket, jacket), (-end, 0))
    box((foot, deck), (jacket - b.jacket_mm, jacket), (-end, 0))
    box((foot, deck), (-jacket, jacket), (-end, -end + b.jacket_mm))
    across, along = b.boss_mm
    for j in (1, 2, 3):
        z = max((j - 3) * e.spacing_mm, -end + along / 2)
        box((foot, deck), (jacket - across, jacket), (z - along / 2, z + along / 2))
    centers = [(i - 2.5) * e.spacing_mm for i in (1, 2)]
    for z in centers:
        volumes.append((3, occ.addCylinder(foot, 0, z, deck - foot, 0, 0, e.bore_mm / 2 + b.barrel_mm)))

    # crankcase: skirts with the pan rail, bearing walls, caps
    low, top = -b.skirt_mm, foot + b.floor_mm
    outer = [("to", top, 0), ("to", top, jacket), ("to", b.shoulder_mm, outside), ("to", low, outside), ("to", low, 0)]
    inside = b.crankcase_half_mm
    inner = [("to", foot, 0), ("to", foot, jacket - b.crankcase_mm), ("to", b.shoulder_mm, inside), ("to", low, inside), ("to", low, 0)]
    case = occ.cut([outline(outer, -end, end)], [outline(inner, -end, end)])[0]
    volumes.extend(case)
    box((low, low + b.rail_mm[1]), (inside, outside + b.rail_mm[0]), (-end, 0))
    for j in (1, 2, 3):
        z = (j - 3) * e.spacing_mm
        near = -end if j == 1 else z - b.wall_mm / 2
        far = z + b.wall_mm / 2
        plate = [("to", foot, 0), ("to", foot, jacket - b.crankcase_mm), ("to", b.shoulder_mm, inside), ("to", 0, inside), ("to", 0, 0)]
        volumes.append(outline(plate, near, far - near))
        box((-b.cap_mm[1], 0), (0, b.cap_mm[0]), (near, far))

    # lugs
    wide, long, high = b.mount_mm
    mount = -b.mount_at_mm
    box((b.mount_up_mm, b.mount_up_mm + high), (inside + b.crankcase_mm / 2, outside + wide), (mount - long / 2, mount + long / 2))

    fused = occ.fuse(volumes[:1], volumes[1:])[0]
    holes = [(3, occ.addCylinder(foot, 0, z, deck - foot, 0, 0, e.bore_mm / 2)) for z in centers]
    holes.append((3, occ.addCylinder(0, 0, -end - 1, 0, 0, end + 1, b.housing_diameter_mm / 2)))
    shell = 2 * e.spacing_mm + e.shell_width_mm / 2
    holes.append((3, occ.addCylinder(0, 0, -end - 1, 0, 0, end + 1 - shell, b.recess_diameter_mm / 2)))
    body = occ.cut(fused, holes)[0]
    # prints the pad into the lug's lower face
    edge = outside + wide - b.mount_pad_mm
    pad = occ.addBox(b.mount_up_mm - 5, edge, mount - long / 2 - 5, 5, b.mount_pad_mm + 5, long + 10)
    body = quarter(body)
    body = occ.cut(body, [(3, pad)])[0]
    occ.synchronize()
    barrels = [s for s in cylinders() if extent(s, 0) > 0.8 * (e.deck_height_mm - foot)]
    bearings = [s for s in cylinders() if s not in barrels]
    return {
        "size": b.size_mm,
        "near": [(bearings, b.bearing_size_mm, 2.0, 25.0), (barrels, b.barrel_size_mm, 1.0, 30.0)],
        "in": [
            # half of the bridge between bores 2 and 3, 3 mm thick at y = 0
            ((foot, 0, -8), (deck, 10, 0), b.bridge_size_mm, 14.0),
            # a lug
            ((b.mount_up_mm, inside, mount - long / 2), (b.mount_up_mm + high, outside + wide, mount + long / 2), b.mount_size_mm, 30.0),
        ],
    }


def block_sets(e, b):
    """Sets of the block by name."""
    sets = {}
    for j in range(1, 6):
        sets[f"MAIN{j}"] = Ring((0, 0, (j - 3) * e.spacing_mm), 2, b.housing_diameter_mm / 2, e.shell_width_mm)
    length = e.deck_height_mm - b.barrel_foot_mm
    for i in range(1, 5):
        center = (b.barrel_foot_mm + length / 2, 0, (i - 2.5) * e.spacing_mm)
        sets[f"BORE{i}"] = Ring(center, 0, e.bore_mm / 2, length)
    edge = b.crankcase_half_mm + b.crankcase_mm + b.mount_mm[0]
    for k, (y, z) in enumerate(((1, -1), (-1, -1), (1, 1), (-1, 1)), 1):
        ys = sorted((y * edge, y * (edge - b.mount_pad_mm)))
        zs = sorted(z * b.mount_at_mm + s * b.mount_mm[1] / 2 for s in (-1, 1))
        sets[f"MOUNT{k}"] = Patch(0, b.mount_up_mm, (b.mount_up_mm, ys[0], zs[0]), (b.mount_up_mm, ys[1], zs[1]))
    sets["DECK"] = Patch(0, e.deck_height_mm, (e.deck_height_mm, -500, -500), (e.deck_height_mm, 500, 500))
    return sets

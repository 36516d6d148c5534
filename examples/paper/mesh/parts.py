"""From a quarter's solid to the whole mesh of 10-node tetrahedra: mirrored, its sets found, its quality measured."""

from dataclasses import dataclass

import gmsh
import numpy as np
from solids import Ring

# Corners and edges of a 10-node tetrahedron, Nastran's and Abaqus' order: edges 12 23 31 14 24 34.
FROM_GMSH = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
MIRRORED = [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]  # corners 1 and 2 swapped, so that the volume stays positive
FACES = [(0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (2, 0, 3, 6, 7, 9)]
DIGITS = 6  # of coordinates in mm: 1 nm


@dataclass
class Part:
    """A mesh; indices from 0."""

    name: str
    material: object  # young_mpa, poisson, density_t_mm3
    nodes: np.ndarray  # (n, 3) mm
    elements: np.ndarray  # (m, 10)
    sets: dict  # name: sorted indices of nodes
    places: dict  # name: Ring or Patch
    quality: dict


def mesh(name, material, build, places):
    """Meshes the solid that `build` makes."""
    gmsh.initialize(["-noenv"], readConfigFiles=False)
    try:
        for option, value in {
            "General.Terminal": 0,
            "General.NumThreads": 1,
            "Mesh.Algorithm": 6,
            "Mesh.Algorithm3D": 1,
            "Mesh.MeshSizeExtendFromBoundary": 0,
            "Mesh.MeshSizeFromPoints": 0,
            "Mesh.Optimize": 1,
            "Mesh.OptimizeNetgen": 1,
        }.items():
            gmsh.option.setNumber(option, value)
        gmsh.model.add(name)
        set_sizes(build())
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        nodes, elements, quality = quarter_of_gmsh()
    finally:
        gmsh.finalize()
    for axis in (1, 2):
        nodes, elements = mirror(nodes, elements, axis)
    part = Part(name, material, nodes, elements, {}, places, quality)
    surface = skin(elements)
    for set_name, place in places.items():
        part.sets[set_name] = find(part, surface, set_name, place)
    snap(part)
    part.nodes = np.round(part.nodes, DIGITS) + 0.0
    return part


def set_sizes(sizes):
    """Elements of one size, finer near surfaces: (surfaces, size, within, up to), and in boxes: (low, high, size, up to)."""
    field = gmsh.model.mesh.field
    fields = []
    for surfaces, size, within, up_to in sizes["near"]:
        distance = field.add("Distance")
        field.setNumbers(distance, "SurfacesList", surfaces)
        field.setNumber(distance, "Sampling", 60)
        threshold = field.add("Threshold")
        for key, value in {
            "InField": distance,
            "SizeMin": size,
            "SizeMax": sizes["size"],
            "DistMin": within,
            "DistMax": up_to,
        }.items():
            field.setNumber(threshold, key, value)
        fields.append(threshold)
    for low, high, size, up_to in sizes.get("in", ()):
        box = field.add("Box")
        for axis, x0, x1 in zip("XYZ", low, high):
            field.setNumber(box, f"{axis}Min", x0)
            field.setNumber(box, f"{axis}Max", x1)
        for key, value in {"VIn": size, "VOut": sizes["size"], "Thickness": up_to}.items():
            field.setNumber(box, key, value)
        fields.append(box)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", fields)
    field.setAsBackgroundMesh(least)


def quarter_of_gmsh():
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    kinds, ids, connectivity = gmsh.model.mesh.getElements(3)
    if list(kinds) != [11]:
        raise SystemExit(f"expected 10-node tetrahedra, found gmsh's kinds {kinds}")
    quality = {}
    for measure in ("minSJ", "minSICN", "gamma"):
        values = gmsh.model.mesh.getElementQualities(ids[0], measure)
        quality[measure] = (float(np.min(values)), float(np.percentile(values, 1)), float(np.median(values)))
    index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    index[tags] = np.arange(len(tags))
    elements = index[connectivity[0].reshape(-1, 10)][:, FROM_GMSH]
    used, elements = np.unique(elements, return_inverse=True)
    return coordinates.reshape(-1, 3)[used], elements.reshape(-1, 10), quality


def mirror(nodes, elements, axis):
    """Adds the mirror image in the plane axis = 0; nodes in the plane are shared."""
    nodes = nodes.copy()
    shared = np.abs(nodes[:, axis]) < 1e-6
    nodes[shared, axis] = 0.0
    image = np.arange(len(nodes))
    image[~shared] = len(nodes) + np.arange(np.count_nonzero(~shared))
    reflected = nodes[~shared].copy()
    reflected[:, axis] *= -1
    return np.vstack([nodes, reflected]), np.vstack([elements, image[elements][:, MIRRORED]])


def skin(elements):
    """Faces (6 nodes, outward) that belong to one element only."""
    faces = np.vstack([elements[:, face] for face in FACES])
    corners = np.sort(faces[:, :3], axis=1)
    _, first, count = np.unique(corners, axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[count == 1])]


def measure(nodes, place):
    """Distance of nodes from a cylinder's surface, and from its middle along the axis."""
    offset = nodes - np.array(place.center)
    along = offset[:, place.axis]
    across = np.delete(offset, place.axis, axis=1)
    return np.hypot(across[:, 0], across[:, 1]) - place.radius, along


def find(part, surface, name, place):
    """Nodes of the surface's faces that lie wholly in the place."""
    if isinstance(place, Ring):
        off, along = measure(part.nodes, place)
        inside = (np.abs(off) < 1e-5) & (np.abs(along) < place.width / 2 + 1e-6)
    else:
        low, high = np.array(place.low) - 1e-6, np.array(place.high) + 1e-6
        inside = np.all((part.nodes >= low) & (part.nodes <= high), axis=1)
    faces = surface[np.all(inside[surface], axis=1)]
    found = np.unique(faces)
    if len(found) < 12:
        raise SystemExit(f"{part.name}: {name} has {len(found)} nodes")
    if isinstance(place, Ring) and len(found) != np.count_nonzero(inside):
        other = np.count_nonzero(inside)
        raise SystemExit(f"{part.name}: a ring at {name} would gather {other} nodes, not {len(found)}")
    return found


def snap(part):
    """Puts the nodes of rings on their cylinders, and those of patches into their planes."""
    for name, place in part.places.items():
        chosen = part.sets[name]
        if isinstance(place, Ring):
            across = [k for k in range(3) if k != place.axis]
            center = np.array(place.center)[across]
            offset = part.nodes[np.ix_(chosen, across)] - center
            radius = np.hypot(offset[:, 0], offset[:, 1])[:, None]
            part.nodes[np.ix_(chosen, across)] = center + offset * (place.radius / radius)
        else:
            part.nodes[chosen, place.axis] = place.at


def volumes(part):
    """Volume, first moments and second moments (about the origin) of the quadratic elements, exact for curved ones."""
    # 5³ collapsed Gauss points: the integrand has degree 7, the collapse adds 2 in the first direction
    x, w = np.polynomial.legendre.leggauss(5)
    x, w = (x + 1) / 2, w / 2
    total, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    least = np.inf
    nodes = part.nodes[part.elements]
    for i in range(5):
        for j in range(5):
            for k in range(5):
                a, b = x[i], x[j] * (1 - x[i])
                c = x[k] * (1 - a - b)
                weight = w[i] * w[j] * w[k] * (1 - a) * (1 - a - b)
                shape, slope = tetrahedron(a, b, c)
                jacobian = np.einsum("ak,mai->mki", slope, nodes)
                volume = np.linalg.det(jacobian)
                least = min(least, volume.min())
                place = np.einsum("a,mai->mi", shape, nodes)
                total += weight * volume.sum()
                first += weight * volume @ place
                second += weight * np.einsum("m,mi,mj->ij", volume, place, place)
    if least <= 0:
        raise SystemExit(f"{part.name}: an element is inverted")
    return total, first, second


def tetrahedron(a, b, c):
    """Shape functions of the 10-node tetrahedron and their slopes at (a, b, c)."""
    l = np.array([1 - a - b - c, a, b, c])
    d = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    shape, slope = [], []
    for i in range(4):
        shape.append(l[i] * (2 * l[i] - 1))
        slope.append((4 * l[i] - 1) * d[i])
    for i, j in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)):
        shape.append(4 * l[i] * l[j])
        slope.append(4 * (l[i] * d[j] + l[j] * d[i]))
    return np.array(shape), np.array(slope)


def mass_properties(part):
    """Mass (kg), centre (mm), inertia about the centre (g m²)."""
    density = part.material.density_t_mm3
    volume, first, second = volumes(part)
    center = first / volume
    about = second - volume * np.outer(center, center)
    inertia = density * (np.trace(about) * np.eye(3) - about)
    return density * volume * 1e3, center, inertia  # a tonne mm² is a g m²


def report(part):
    mass, center, inertia = mass_properties(part)
    print(f"{part.name}: {len(part.nodes)} nodes, {len(part.elements)} elements, {mass:.4f} kg")
    print("  centre (mm)", np.round(center, 6), " inertia (g m²)", np.round(np.diag(inertia), 3))
    for measure_name, (least, percent, median) in part.quality.items():
        print(f"  {measure_name}: least {least:.3f}, 1 % below {percent:.3f}, median {median:.3f}")
    for name, chosen in part.sets.items():
        middle = part.nodes[chosen].mean(axis=0)
        print(f"  {name:7s} {len(chosen):5d} nodes, mean", np.round(middle, 3) + 0.0)

"""Computes reference.json from crank.bdf.gz and block.inp.gz with numpy and scipy alone, and with CalculiX where `ccx` is installed.

    python reference.py         # both; `crank` or `block` for one

This script shares no code with the project's own finite elements. Ten-node tetrahedra: stiffness at 4 points; consistent mass
exact for curved elements (`exact`), or at the same 4 points (`calculix`, as in CalculiX and similar codes). SI units throughout.

Averaging: a marker's motion (u, θ) at its centre c is the rigid motion that fits the nodes of its set best, all nodes with the
weight 1, all three components: least Σ |q_k − u − θ × (x_k − c)|². A force at the marker is distributed by the transpose.
"""

import gzip
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu

HERE = Path(__file__).parent
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
THROW, SPACING, FLANGE = 0.043, 0.092, 0.230
MAINS = [(0.0, 0.0, (j - 2) * SPACING) for j in range(5)]
PINS = [(side * THROW, 0.0, (i - 1.5) * SPACING) for i, side in enumerate((1, -1, -1, 1))]
RADIAL, AXIAL, TORSION = 1e8, 1e8, 1e6  # springs to ground: N/m, N/m, N m/rad
MASS_TO_KG, LENGTH_TO_M = 1e3, 1e-3


class Mesh:
    """Nodes in m, elements, sets of node indices, material in SI."""

    def __init__(self, nodes, elements, sets, young, poisson, density):
        self.nodes = np.array(nodes) * LENGTH_TO_M
        self.elements = np.array(elements) - 1
        self.sets = {name: np.array(ids) - 1 for name, ids in sets.items()}
        self.young, self.poisson = young * MASS_TO_KG / LENGTH_TO_M, poisson
        self.density = density * MASS_TO_KG / LENGTH_TO_M**3


def nastran_number(text):
    """`7.85-9` and the like."""
    text = text.strip()
    sign = max(text.rfind("+"), text.rfind("-"))
    return float(text if sign < 1 or text[sign - 1] in "eE" else text[:sign] + "e" + text[sign:])


def read_crank():
    """The deck as decks.py writes it; sets are named in the order of their numbers."""
    names = [f"MAIN{j}" for j in range(1, 6)] + [f"PIN{i}" for i in range(1, 5)] + ["FLANGE", "SNOUT"]
    nodes, elements, cards = [], [], {}
    material = open_set = None
    for line in gzip.open(HERE / "crank.bdf.gz", "rt"):
        line = line.rstrip("\n")
        fields = [line[k : k + 8].strip() for k in range(8, min(len(line), 72), 8)]
        if line.startswith("GRID*"):
            nodes.append([float(line[40:56]), float(line[56:72])])
        elif line.startswith("*"):
            nodes[-1].append(float(line[8:24]))
        elif line.startswith("CTETRA"):
            elements.append([int(f) for f in fields[2:8]])
            open_set = elements[-1]
        elif line.startswith("SET1"):
            open_set = cards[int(fields[0])] = [int(f) for f in fields[1:8]]
        elif line.startswith("+"):
            open_set.extend(int(f) for f in fields)
        elif line.startswith("MAT1"):
            material = [nastran_number(fields[k]) for k in (1, 3, 4)]
    return Mesh(nodes, elements, {names[k - 1]: ids for k, ids in cards.items()}, *material)


def read_block():
    """The input as decks.py writes it."""
    nodes, elements, sets, material, into = [], [], {}, [], None
    for line in gzip.open(HERE / "block.inp.gz", "rt"):
        line = line.strip()
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            into = line
            if line.startswith("*NSET"):
                chosen = sets[line.split("NSET=")[1]] = []
            continue
        figures = line.split(",")
        if into.startswith("*NODE"):
            nodes.append([float(x) for x in figures[1:]])
        elif into.startswith("*ELEMENT"):
            elements.append([int(x) for x in figures[1:]])
        elif into.startswith("*NSET"):
            chosen.extend(int(x) for x in figures)
        elif into.startswith(("*ELASTIC", "*DENSITY")):
            material.extend(float(x) for x in figures)
    return Mesh(nodes, elements, sets, *material)


def shapes(point):
    """Shape functions of the ten-node tetrahedron and their slopes."""
    a, b, c = point
    l = np.array([1 - a - b - c, a, b, c])
    d = np.array([[-1.0, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    shape = [l[i] * (2 * l[i] - 1) for i in range(4)] + [4 * l[i] * l[j] for i, j in EDGES]
    slope = [(4 * l[i] - 1) * d[i] for i in range(4)] + [4 * (l[i] * d[j] + l[j] * d[i]) for i, j in EDGES]
    return np.array(shape), np.array(slope)


def four_points():
    """Degree 2."""
    a, b = (5 - np.sqrt(5)) / 20, (5 + 3 * np.sqrt(5)) / 20
    return [(p, 1 / 24) for p in ((a, a, a), (b, a, a), (a, b, a), (a, a, b))]


def many_points():
    """Collapsed Gauss points, 5³. N_a N_b det J of a curved element has degree 7; the collapse adds 2 in the first direction."""
    x, w = np.polynomial.legendre.leggauss(5)
    x, w = (x + 1) / 2, w / 2
    points = []
    for i in range(5):
        for j in range(5):
            for k in range(5):
                a, b = x[i], x[j] * (1 - x[i])
                c = x[k] * (1 - a - b)
                points.append(((a, b, c), w[i] * w[j] * w[k] * (1 - a) * (1 - a - b)))
    return points


def jacobians(mesh, slope):
    return np.einsum("ak,mai->mki", slope, mesh.nodes[mesh.elements])


def stiffness(mesh):
    """K, three freedoms a node."""
    e, nu = mesh.young, mesh.poisson
    lame, shear = e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))
    blocks = np.zeros((len(mesh.elements), 10, 3, 10, 3))
    for point, weight in four_points():
        _, slope = shapes(point)
        jacobian = jacobians(mesh, slope)
        volume = weight * np.linalg.det(jacobian)
        g = np.linalg.solve(jacobian, np.broadcast_to(slope.T, (len(volume), 3, 10)))  # m, 3, 10
        blocks += lame * np.einsum("m,mia,mjb->maibj", volume, g, g, optimize=True)
        blocks += shear * np.einsum("m,mja,mib->maibj", volume, g, g, optimize=True)
        blocks += shear * np.einsum("m,mka,mkb,ij->maibj", volume, g, g, np.eye(3), optimize=True)
    freedoms = (3 * mesh.elements[:, :, None] + np.arange(3)).reshape(len(mesh.elements), 30)
    rows = np.repeat(freedoms, 30, axis=1).ravel()
    columns = np.tile(freedoms, (1, 30)).ravel()
    size = 3 * len(mesh.nodes)
    matrix = sparse.coo_matrix((blocks.ravel(), (rows, columns)), shape=(size, size)).tocsc()
    return (matrix + matrix.T) / 2


def mass(mesh, points):
    """M, three freedoms a node."""
    blocks = np.zeros((len(mesh.elements), 10, 10))
    for point, weight in points:
        shape, slope = shapes(point)
        volume = weight * np.linalg.det(jacobians(mesh, slope))
        blocks += mesh.density * volume[:, None, None] * np.outer(shape, shape)
    rows = np.repeat(mesh.elements, 10, axis=1).ravel()
    columns = np.tile(mesh.elements, (1, 10)).ravel()
    size = len(mesh.nodes)
    matrix = sparse.coo_matrix((blocks.ravel(), (rows, columns)), shape=(size, size)).tocsc()
    return sparse.kron(matrix, sparse.eye(3), format="csc")


def rigid(mesh):
    """Rigid motions about the origin, size × 6."""
    x, y, z = mesh.nodes.T
    motions = np.zeros((len(x), 3, 6))
    motions[:, [0, 1, 2], [0, 1, 2]] = 1
    motions[:, 1, 3], motions[:, 2, 3] = -z, y
    motions[:, 0, 4], motions[:, 2, 4] = z, -x
    motions[:, 0, 5], motions[:, 1, 5] = -y, x
    return motions.reshape(-1, 6)


def mass_properties(mesh, matrix):
    motions = rigid(mesh)
    m = motions.T @ (matrix @ motions)
    # a turn about y moves a point at x by −x along z, and so on
    first = -np.array([m[2, 4], m[0, 5], m[1, 3]])
    return {
        "mass_kg": m[0, 0],
        "center_m": (first / m[0, 0]).tolist(),
        "inertia_about_origin_kg_m2": m[3:, 3:].tolist(),
    }


def averaging(mesh, name, center):
    """The rows (6 × size) that give a marker's motion."""
    chosen = mesh.sets[name]
    offset = mesh.nodes[chosen] - np.array(center)
    fit = np.zeros((len(chosen), 3, 6))
    fit[:, [0, 1, 2], [0, 1, 2]] = 1
    for k in range(3):
        axis = np.eye(3)[k]
        fit[:, :, 3 + k] = np.cross(axis, offset)
    fit = fit.reshape(-1, 6)
    rows = np.linalg.solve(fit.T @ fit, fit.T)
    columns = (3 * chosen[:, None] + np.arange(3)).ravel()
    places = np.repeat(np.arange(6), len(columns)), np.tile(columns, 6)
    return sparse.coo_matrix((rows.ravel(), places), shape=(6, 3 * len(mesh.nodes))).tocsr()


def factor(matrix):
    """Sparse LU of a symmetric matrix."""
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def frequencies(k, matrix, count, solver=None, shift=-((2 * np.pi * 200.0) ** 2)):
    """The lowest (Hz), by shift-inverted Lanczos."""
    solver = solver or factor(k - shift * matrix)
    inverse = LinearOperator(k.shape, matvec=solver.solve, dtype=float)
    start = np.sin(np.arange(k.shape[0]) + 1.0)
    values = eigsh(k, count, matrix, sigma=shift, OPinv=inverse, v0=start, tol=1e-13, return_eigenvectors=False)
    return np.sqrt(np.maximum(np.sort(values), 0)) / (2 * np.pi)


def calculix(mesh, count, held):
    """The same frequencies by CalculiX, or None where it is missing; 7 digits."""
    lines = ["*NODE"]
    lines += [f"{i},{x:.9f},{y:.9f},{z:.9f}" for i, (x, y, z) in enumerate(mesh.nodes, 1)]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=SOLID"]
    lines += [f"{i}," + ",".join(map(str, element + 1)) for i, element in enumerate(mesh.elements, 1)]
    lines += ["*MATERIAL, NAME=METAL", "*ELASTIC", f"{mesh.young!r},{mesh.poisson!r}", "*DENSITY", f"{mesh.density!r}"]
    lines += ["*SOLID SECTION, ELSET=SOLID, MATERIAL=METAL"]
    if len(held):
        lines += ["*BOUNDARY"] + [f"{n + 1},1,3" for n in held]
    lines += ["*STEP", "*FREQUENCY", str(count), "*END STEP"]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "job.inp").write_text("\n".join(lines) + "\n")
        quiet = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
        try:
            subprocess.run(["ccx", "job"], cwd=folder, env=quiet, stdout=subprocess.DEVNULL, check=True)
        except FileNotFoundError:
            return None
        found = []
        for line in (Path(folder) / "job.dat").read_text().splitlines():
            if "P A R T I C I P A T I O N" in line:
                break
            words = line.split()
            if len(words) == 5 and words[0].isdigit():
                found.append(float(words[3]))
        return found


def crank():
    mesh = read_crank()
    k, exact, foreign = stiffness(mesh), mass(mesh, many_points()), mass(mesh, four_points())
    motions = rigid(mesh)
    residual = np.abs(k @ motions[:, :3]).max() / np.abs(k.diagonal()).max()
    print(f"crank: {len(mesh.nodes)} nodes; stiffness times rigid motion {residual:.1e}")
    result = {"nodes": len(mesh.nodes), "elements": len(mesh.elements)} | mass_properties(mesh, exact)
    result["free_hz_exact_mass"] = frequencies(k, exact, 22)[6:].tolist()
    result["free_hz_calculix_mass"] = frequencies(k, foreign, 22)[6:].tolist()
    compare(result["free_hz_calculix_mass"], calculix(mesh, 22, []), 6, result)

    mains = [averaging(mesh, f"MAIN{j + 1}", center) for j, center in enumerate(MAINS)]
    pins = [averaging(mesh, f"PIN{i + 1}", center) for i, center in enumerate(PINS)]
    flange = averaging(mesh, "FLANGE", (0, 0, FLANGE))
    springs = [(rows[c], RADIAL) for rows in mains for c in (0, 1)] + [(mains[2][2], AXIAL), (flange[5], TORSION)]
    on_springs = k + sum(stiff * (row.T @ row) for row, stiff in springs)
    solver = factor(on_springs)
    cases = {
        # loads of rods and pistons of the engine at 4000 rpm with pistons 1 and 4 at the top, rounded
        "dead_centre": [[9500, 0], [-6650, 0], [-6650, 0], [9500, 0]],
        "pin_1_across": [[0, 1000], [0, 0], [0, 0], [0, 0]],
        "mixed": [[1000, 500], [-2000, 300], [700, -900], [-400, 1200]],
    }
    table = {}
    for name, loads in cases.items():
        force = sum(rows[c].T.toarray().ravel() * f for rows, load in zip(pins, loads) for c, f in enumerate(load))
        answer = solver.solve(force)
        for _ in range(2):
            answer += solver.solve(force - on_springs @ answer)
        reaction = sum(RADIAL * (rows[0] @ answer)[0] for rows in mains)
        print(f"  {name}: {reaction:.6f} N on the springs of {sum(load[0] for load in loads)} N")
        table[name] = {
            "pin_forces_n": loads,
            "main_m": [(rows[:3] @ answer).tolist() for rows in mains],
            "pin_m": [(rows[:3] @ answer).tolist() for rows in pins],
            "flange_turn_rad": float((flange[5] @ answer)[0]),
        }
    result["on_springs"] = {
        "how": "springs to ground at the averaged markers: main[1..5] x and y, main[3] z, turn of the flange about z; "
        "forces (x, y) at pin[1..4]; displacements (x, y, z)",
        "radial_n_per_m": RADIAL,
        "axial_n_per_m": AXIAL,
        "torsion_n_m_per_rad": TORSION,
        "cases": table,
    }
    return result


def block():
    mesh = read_block()
    k, exact, foreign = stiffness(mesh), mass(mesh, many_points()), mass(mesh, four_points())
    print(f"block: {len(mesh.nodes)} nodes")
    held = np.unique(np.concatenate([mesh.sets[f"MOUNT{n}"] for n in range(1, 5)]))
    free = np.ones(3 * len(mesh.nodes), dtype=bool)
    free[(3 * held[:, None] + np.arange(3)).ravel()] = False
    free = np.flatnonzero(free)
    result = {"nodes": len(mesh.nodes), "elements": len(mesh.elements)} | mass_properties(mesh, exact)
    kept = k[free][:, free]
    solver = factor(kept)
    for key, matrix in (("supported_hz_exact_mass", exact), ("supported_hz_calculix_mass", foreign)):
        result[key] = frequencies(kept, matrix[free][:, free].tocsc(), 22, solver, 0.0).tolist()
    compare(result["supported_hz_calculix_mass"], calculix(mesh, 22, held), 0, result)
    mains = sparse.vstack([averaging(mesh, f"MAIN{j + 1}", center)[:2] for j, center in enumerate(MAINS)]).tocsc()[:, free]
    answers = solver.solve(mains.T.toarray())
    for _ in range(2):
        answers += solver.solve(mains.T.toarray() - kept @ answers)
    result["main_flexibility_m_per_n"] = (mains @ answers).tolist()
    result["main_flexibility_how"] = (
        "rows and columns main[1].x, main[1].y, main[2].x, ... main[5].y, averaged; all nodes of MOUNT1..4 held"
    )
    return result


def compare(ours, theirs, rigid_modes, result):
    """Notes the worst relative difference; CalculiX prints 7 digits."""
    if theirs is None:
        print("  no ccx: not compared")
        return
    worst = max(abs(a / b - 1) for a, b in zip(ours, theirs[rigid_modes:], strict=True))
    print(f"  CalculiX: worst difference of {len(ours)} frequencies {worst:.1e}")
    result["worst_difference_to_calculix"] = worst


def main(wanted):
    path = HERE / "reference.json"
    made = {name: solve() for name, solve in (("crank", crank), ("block", block)) if name in wanted}
    known = json.loads(path.read_text()) if path.exists() else {}
    reference = {"made_by": "reference.py: numpy, scipy (sparse LU, Lanczos)"} | {
        name: made.get(name, known.get(name)) for name in ("crank", "block")
    }
    path.write_text(json.dumps(reference, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:] or ["crank", "block"])

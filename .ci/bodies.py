"""Reads reduced bodies with independent readers and moves one in another program. Usage: bodies.py ENG FOLDER

ENG is the command; FOLDER gets the model, its results and the bodies. The bar of the tests is reduced and written in every
format. NumPy, pyNastran and the lines of Abaqus must give the same matrices, and the frequencies that `eng reduce` prints.
Exudyn moves the free, spinning bar with the arrays, and must find the motion of `eng run`. Exits with 1 where they differ.
"""

import csv
import json
import pathlib
import subprocess
import sys

import exudyn
import numpy
import scipy.linalg
from exudyn.FEM import ObjectFFRFreducedOrderInterface
from pyNastran.bdf.bdf import BDF
from pyNastran.op4.op4 import read_op4

eng, folder = sys.argv[1], pathlib.Path(sys.argv[2])
mesh = pathlib.Path(__file__).parent.parent / "tests/mesh/bar.bdf"
folder.mkdir(parents=True, exist_ok=True)
# a soft bar: its deflections are so large that each term of the floating frame counts
(folder / "bar.bdf").write_text(mesh.read_text().replace("210000.", "  1000.", 1))
SPIN, SPEED = [300.0, 40.0, 500.0], [1.0, -2.0, 0.5]
DURATION = 5e-3
(folder / "free.eng").write_text(f"""
model Free {{
    gravity = [0, 0, 0] m/s^2
    flexible bar {{
        mesh = nastran("bar.bdf", units: mm_tonne_s)
        modes = static(at: tip, freedoms: [x, y, z]) + normal(7)
        element_rules = exact
        damping = 1 %
        marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        marker side = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm)
        start angular_velocity = {SPIN} rad/s
        start velocity = {SPEED} m/s
    }}
    output tip = bar.tip.origin in ground
    output side = bar.side.origin in ground
}}
analysis fly = transient(Free(), duration: {DURATION} s, sample: 1 ms, tolerance: 0.01)
""")


def run(*words):
    subprocess.run([eng, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def close(a, b, relative, what):
    error = numpy.max(numpy.abs(numpy.asarray(a) - b)) / numpy.max(numpy.abs(b))
    print(f"{what}: {error:.1e} (limit {relative:.0e})")
    assert error <= relative, (what, error)


for form in ("numpy", "op4", "dmig", "abaqus"):
    run("reduce", "free.eng", "--to", form, "--out", form)
about = json.loads((folder / "numpy/bar.json").read_text())


def array(name):
    return numpy.load(folder / f"numpy/bar.{name}.npy")


mass, stiffness, damping, motion = map(array, ("mass", "stiffness", "damping", "motion"))
size = len(mass)
n = size - 6
assert motion.shape == (2, 6, size) and len(about["coordinates"]) == size

# Nastran's OP4
op4 = read_op4(str(folder / "op4/bar.op4"))
for name, expected in {"KENG": stiffness, "MENG": mass, "BENG": damping, "LENG": motion.reshape(12, size)}.items():
    close(op4[name].data, expected, 1e-15, f"op4 {name}")

# Nastran's bulk data: DMIG of scalar points, and MPC of grid points
deck = BDF(log=None, debug=None)
deck.read_bdf(str(folder / "dmig/bar.bdf"), punch=True, xref=False)
scalar = 3
assert sorted(deck.spoints) == list(range(scalar, scalar + size)), sorted(deck.spoints)
for name, expected in {"KENG": stiffness, "MENG": mass, "BENG": damping}.items():
    found = numpy.zeros((size, size))
    direct = deck.dmigs[name]
    for (column, _), (row, _), value in zip(direct.GCj, direct.GCi, direct.Real):
        found[row - scalar, column - scalar] = found[column - scalar, row - scalar] = value
    close(found, expected, 1e-9, f"dmig {name}")
rows = numpy.zeros((12, size))
for card in deck.mpcs[1]:
    own = 6 * (card.nodes[0] - 1) + int(card.components[0]) - 1
    assert card.coefficients[0] == -1.0
    for point, factor in zip(card.nodes[1:], card.coefficients[1:]):
        rows[own, point - scalar] = factor
close(rows, motion.reshape(12, size), 1e-9, "mpc")

# Abaqus: the lines of the matrices; the equations of the deck
for name, expected in {"stiffness": stiffness, "mass": mass, "damping": damping}.items():
    found = numpy.zeros((size, size))
    for line in (folder / f"abaqus/bar.{name}.mtx").read_text().splitlines():
        node, freedom, other, its, value = line.split(",")
        i, j = (6 * (int(a) - 3) + int(b) - 1 for a, b in ((node, freedom), (other, its)))
        found[i, j] = found[j, i] = float(value)
    close(found, expected, 1e-15, f"abaqus {name}")
words = (folder / "abaqus/bar.inp").read_text().split("*EQUATION\n")[1:]
assert len(words) == 12
for row, text in enumerate(words):
    count, *terms = text.splitlines()
    numbers = [float(word) for line in terms for word in line.split(",")]
    assert len(numbers) == 3 * int(count) and numbers[:3] == [row // 6 + 1, row % 6 + 1, -1.0]
    found = numpy.zeros(size)
    for node, freedom, factor in zip(*[iter(numbers[3:])] * 3):
        found[int(6 * (node - 3) + freedom - 1)] = factor
    close(found, motion.reshape(12, size)[row], 1e-15, f"equation {row}")

# six rigid motions, and the frequencies of the free body
values = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)
frequencies = numpy.sqrt(numpy.abs(values)) / (2 * numpy.pi)
assert max(frequencies[:6]) < 1e-3 * frequencies[6], frequencies[:8]
close(frequencies[6:], numpy.array(about["frequencies"]), 1e-9, "frequencies")

# Exudyn takes the constants of the floating frame: its products with skew matrices of shapes, PsiTilde = −E_k Phi
translation, rotation, modal = mass[:3, 6:], mass[3:6, 6:], mass[6:, 6:]
by_shape, coriolis, centrifugal = map(array, ("rotation_by_shape", "coriolis", "centrifugal"))
m = about["mass"]
pairs = {(0, 0): 0, (1, 1): 1, (2, 2): 2, (0, 1): 3, (1, 2): 4, (0, 2): 5}
tilde = numpy.zeros((3 * n, n))
tilde_tilde = numpy.zeros((3 * n, 3 * n))
translation_tilde = numpy.zeros((3, 3 * n))
rotation_tilde = numpy.zeros((3, 3 * n))
for k in range(3):
    tilde[k::3] = -coriolis[k].T
    rotation_tilde[:, k::3] = by_shape[k]
    translation_tilde[:, k::3] = -numpy.cross(numpy.eye(3)[k], translation.T).T
    for l in range(3):
        tilde_tilde[k::3, l::3] = centrifugal[pairs[min(k, l), max(k, l)]]
shapes = array("shapes")
center = numpy.array(about["first_moment"]) / m
skew = numpy.array([[0, -center[2], center[1]], [center[2], 0, -center[0]], [-center[1], center[0], 0]])
body = ObjectFFRFreducedOrderInterface()
body.SetWithDictionary({
    "modeBasis": shapes[:, :3, :].reshape(-1, n), "trigList": [], "postProcessingModes": {},
    "massMatrixReduced": modal, "stiffnessMatrixReduced": stiffness[6:, 6:],
    "infoList": [n, len(shapes), 3, 4, 7, 7 + n], "rigidBodyNodeType": "NodeType.RotationEulerParameters",
    "xRef": array("nodes").flatten(), "inertiaLocal": mass[3:6, 3:6], "Mtt": mass[:3, :3], "totalMass": m,
    "chiU": center, "chiUtilde": skew, "mPsiTildePsi": tilde, "mPsiTildePsiTilde": tilde_tilde,
    "mPhitTPsi": translation, "mPhitTPsiTilde": translation_tilde,
    "mXRefTildePsi": -rotation, "mXRefTildePsiTilde": rotation_tilde,
})
system = exudyn.SystemContainer().AddSystem()
made = body.AddObjectFFRFreducedOrder(system, initialVelocity=SPEED, initialAngularVelocity=SPIN)
system.SetObjectParameter(made["oFFRFreducedOrder"], "dampingMatrixReduced", exudyn.MatrixContainer(damping[6:, 6:]))
system.Assemble()
settings = exudyn.SimulationSettings()
settings.timeIntegration.numberOfSteps = 5000
settings.timeIntegration.endTime = DURATION
settings.timeIntegration.generalizedAlpha.spectralRadius = 1.0
settings.timeIntegration.verboseMode = 0
settings.solution.file.write = False
system.SolveDynamic(settings)
place = system.GetNodeOutput(made["nRigidBody"], exudyn.OutputVariableType.Position)
turn = system.GetNodeOutput(made["nRigidBody"], exudyn.OutputVariableType.RotationMatrix).reshape(3, 3)
amplitudes = system.GetNodeOutput(made["nGenericODE2"], exudyn.OutputVariableType.Coordinates)
run("run", "free.eng", "--out", "run", "--no-plots", "--csv")
with open(folder / "run/fly.csv", newline="") as file:
    paths, units, *rows = csv.reader(file)
last = {path: float(value) for path, value in zip(paths, rows[-1])}
assert abs(last["time"] - DURATION) < 1e-12 and all(units[paths.index(f"tip.{axis}")] == "m" for axis in "xyz")
for index, name in enumerate(("tip", "side")):
    at_rest = numpy.array(about["markers"][index]["position"])
    found = place + turn @ (at_rest + motion[index, :3, 6:] @ amplitudes)
    expected = [last[f"{name}.{axis}"] for axis in "xyz"]
    close(found, numpy.array(expected), 1e-6, f"place of {name} after {DURATION} s in Exudyn")

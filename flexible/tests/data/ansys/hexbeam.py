"""Frequencies of the beam `hexbeam.cdb.gz` with the material of `ansys_archives.rs`, without Eng: hexahedra of 20
nodes, stiffness at 2³ points, mass at 3³ (ANSYS Theory Reference, SOLID186). Needs numpy."""

import gzip
import itertools
import pathlib

import numpy as np

YOUNG, POISSON, DENSITY = 16.9e6, 0.31, 4.1408e-4
path = pathlib.Path(__file__).parent / "hexbeam.cdb.gz"
lines = gzip.open(path, "rt").read().splitlines()
begin = next(i for i, line in enumerate(lines) if line.startswith("NBLOCK")) + 2
place = {
    int(line[:9]): [float(line[27 + 21 * k : 48 + 21 * k].strip() or 0) for k in range(3)]
    for line in lines[begin : begin + 321]
}
begin = next(i for i, line in enumerate(lines) if line.startswith("EBLOCK")) + 2
pairs = (lines[begin + 2 * k] + " " + lines[begin + 2 * k + 1] for k in range(40))
elements = [[int(word) - 1 for word in pair.split()[11:]] for pair in pairs]
points = np.array([place[n] for n in sorted(place)])

plane = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
corner = np.array([[*xy, z] for z in (-1, 1) for xy in plane], float)
ring = [(0, 1), (1, 2), (2, 3), (3, 0)]
edges = ring + [(a + 4, b + 4) for a, b in ring] + [(a, a + 4) for a in range(4)]
nodes = np.vstack([corner, [(corner[a] + corner[b]) / 2 for a, b in edges]])
# monomials of the serendipity element: at most one exponent is 2
powers = np.array([e for e in itertools.product(range(3), repeat=3) if e.count(2) <= 1])


def monomials(p, powers=powers):
    return np.prod(np.asarray(p) ** powers, axis=1)


def slopes(p):
    lower = [np.maximum(powers - np.eye(3, dtype=int)[d], 0) for d in range(3)]
    return np.array([powers[:, d] * monomials(p, lower[d]) for d in range(3)])


coefficients = np.linalg.inv([monomials(p) for p in nodes])


def gauss(n):
    x, w = np.polynomial.legendre.leggauss(n)
    for (a, u), (b, v), (c, t) in itertools.product(zip(x, w), repeat=3):
        yield (a, b, c), u * v * t


def matrices(x):
    shear = YOUNG / 2 / (1 + POISSON)
    law = np.diag([2 * shear] * 3 + [shear] * 3)
    law[:3, :3] += YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
    stiffness, mass = np.zeros((60, 60)), np.zeros((20, 20))
    for p, weight in gauss(2):
        slope = slopes(p) @ coefficients
        jacobian = slope @ x
        g = np.linalg.solve(jacobian, slope)
        strain = np.zeros((6, 60))
        for row, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]):
            strain[row, i::3] += g[j]
            if i != j:
                strain[row, j::3] += g[i]
        stiffness += weight * np.linalg.det(jacobian) * strain.T @ law @ strain
    for p, weight in gauss(3):
        shape = monomials(p) @ coefficients
        volume = weight * np.linalg.det(slopes(p) @ coefficients @ x)
        mass += DENSITY * volume * np.outer(shape, shape)
    return stiffness, np.kron(mass, np.eye(3))


size = 3 * len(points)
total_stiffness, total_mass = np.zeros((size, size)), np.zeros((size, size))
for element in elements:
    rows = np.array([[3 * n, 3 * n + 1, 3 * n + 2] for n in element]).ravel()
    stiffness, mass = matrices(points[element])
    total_stiffness[np.ix_(rows, rows)] += stiffness
    total_mass[np.ix_(rows, rows)] += mass
inverse = np.linalg.inv(np.linalg.cholesky(total_mass))
values = np.linalg.eigvalsh(inverse @ total_stiffness @ inverse.T)
print(np.sqrt(values[6:12]) / (2 * np.pi))

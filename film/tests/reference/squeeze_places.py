"""Places of the highest pressure of two squeeze states of film_reference.json, by differences. Usage: squeeze_places.py

Solves d/dtheta(H^3 dP/dtheta) + H^3 d2P/dZ2 = 12 dH/dtau with P >= 0 and P = 0 at the ends, H = 1 - eps cos(theta), Z = z/R,
B/D = 0.5. The cells with oil under pressure are found as an active set. Prints place (deg), highest pressure and force
along x for squeeze_toward_30 and squeeze_away_31. Needs NumPy and SciPy.
"""

import numpy
import scipy.sparse
import scipy.sparse.linalg

AROUND, ACROSS, WIDTH = 720, 80, 1.0


def solve(ratio, rate):
    angle = numpy.arange(AROUND) * 2 * numpy.pi / AROUND
    step, width = 2 * numpy.pi / AROUND, WIDTH / ACROSS
    cubed = (1 - ratio * numpy.cos(angle)) ** 3
    ahead = scipy.sparse.diags((1 - ratio * numpy.cos(angle + step / 2)) ** 3)
    turned = scipy.sparse.csr_matrix(numpy.roll(numpy.eye(AROUND), 1, axis=1))
    slope = turned - scipy.sparse.identity(AROUND)
    around = -(slope.T @ ahead @ slope) / step**2
    # ends at half a cell beside the outer cells
    curvature = scipy.sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(ACROSS, ACROSS)).tolil()
    curvature[0, 0] = curvature[-1, -1] = -3.0
    across = scipy.sparse.kron(scipy.sparse.diags(cubed), curvature / width**2)
    matrix = (scipy.sparse.kron(around, scipy.sparse.identity(ACROSS)) + across).tocsr()
    right = numpy.repeat(-12 * rate * numpy.cos(angle), ACROSS)
    pressed = numpy.ones(AROUND * ACROSS, bool)
    for _ in range(100):
        cells = numpy.flatnonzero(pressed)
        pressure = numpy.zeros(AROUND * ACROSS)
        pressure[cells] = scipy.sparse.linalg.spsolve(matrix[cells][:, cells].tocsc(), right[cells])
        kept = (pressed & (pressure > 0)) | (~pressed & (matrix @ pressure - right > 0))
        if (kept == pressed).all():
            break
        pressed = kept
    else:
        raise SystemExit("the active set does not settle")
    pressure = pressure.reshape(AROUND, ACROSS)
    force = -(pressure * numpy.cos(angle)[:, None]).sum() * step * width
    place = numpy.degrees(angle[pressure[:, ACROSS // 2].argmax()])
    return place, pressure.max(), force


for name, rate in ("squeeze_toward_30", 0.45), ("squeeze_away_31", -0.45):
    place, highest, force = solve(0.9, rate)
    print(f"{name}: {min(place, 360 - place):.1f} deg, {highest:.6g}, {force:.6g}")

"""Makes `stdlib/thrust.csv`: pads of a thrust bearing by Reynolds' equation. Needs numpy and scipy.

    python3 make_thrust.py > ../../stdlib/thrust.csv

A pad of the length L and the width B falls from its leading edge by `depth` over the share `taper` of L, to the gap h, and is flat
behind. With p = sum of P_n(x) sin(n pi z/B) for odd n, Reynolds' equation for an approach at the speed v is one equation in x for each n,
`(H^3 P_n')' - (n pi/B)^2 H^3 P_n = -12 mu v 4/(n pi)`. It is solved on 1000 and 2000 cells and extrapolated. Columns: B/L,
`u = log(1 + depth/h)`, taper, and the logarithms of two numbers: the load over that of a pad without flow along it, `mu v B^3` times the
integral of `1/H^3`; the share of the taper in the load.
"""

import numpy as np
from scipy.linalg import solve_banded

SLENDERNESS = [0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1, 1.25, 1.6, 2]
STEPS = [0, 0.15, 0.3, 0.5, 0.75, 1, 1.3, 1.6, 1.9, 2.2, 2.5, 2.8, 3.1, 3.5]
TAPERS = [0.5, 0.6, 0.7, 0.75, 0.8, 0.84, 0.87, 0.9]


def pad(slenderness, step, taper, cells, waves=41):
    """Load over mu v L B^3/h^3, and the share of the taper in it. Lengths are in L, gaps in h."""
    front = round(cells * taper)
    falling = np.exp(np.linspace(np.log(1 + step), 0, front + 1))
    flat = taper + (1 - taper) * np.linspace(0, 1, cells - front + 1)[1:]
    x = np.concatenate([taper * (1 + step - falling) / step, flat])
    width = np.diff(x)
    middle = (x[1:] + x[:-1]) / 2
    cube = np.where(middle <= taper, 1 + step * (1 - middle / taper), 1.0) ** 3
    flow = cube / width
    own = (width[1:] + width[:-1]) / 2
    side = (cube[1:] * width[1:] + cube[:-1] * width[:-1]) / 2
    whole = front_load = 0.0
    for n in range(1, waves + 1, 2):
        bands = np.zeros((3, len(x) - 2))
        bands[1] = flow[1:] + flow[:-1] + (n * np.pi / slenderness) ** 2 * side
        bands[0, 1:] = bands[2, :-1] = -flow[1:-1]
        inside = solve_banded((1, 1), bands, 48 / (n * np.pi) * own)
        pressure = np.concatenate([[0], inside, [0]])
        load = (pressure[1:] + pressure[:-1]) * width * slenderness / (n * np.pi)
        whole += load.sum()
        front_load += load[:front].sum()
    return np.array([whole / slenderness**3, front_load / whole])


print("B/L,u,taper,load,share")
for slenderness in SLENDERNESS:
    for u in STEPS:
        for taper in TAPERS:
            step = max(np.exp(u) - 1, 1e-7)
            coarse, fine = (pad(slenderness, step, taper, n) for n in (1000, 2000))
            load, share = fine + (fine - coarse) / 3
            load /= (1 - taper) + taper * (2 + step) / (2 * (1 + step) ** 2)
            print(f"{slenderness:g},{u:g},{taper:g},{np.log(load):.7g},{np.log(share):.7g}")

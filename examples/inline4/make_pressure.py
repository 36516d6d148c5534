"""Writes pressure.csv: cylinder pressure of a four-stroke petrol engine over 720 degrees of crank angle.

Single zone: dp/dtheta = -gamma p/V dV/dtheta + (gamma - 1)/V dQ/dtheta with constant gamma between inlet closing and
exhaust opening, and Wiebe's heat release x = 1 - exp(-a ((theta - start)/duration)^(m + 1)), a = 5, m = 2
(J. B. Heywood, Internal Combustion Engine Fundamentals, 1988, sections 9.2.2 and 14.4). Gas exchange at constant manifold
pressures, joined by smooth blow-down and by a smooth step around the overlap. theta = 0 is the firing dead centre; the
trace is periodic. Geometry as in inline4.eng: bore 86, stroke 86, rod 143 mm, compression ratio 10.3.

Run: python3 make_pressure.py   (no other packages)
"""

from math import cos, exp, pi, radians, sin, sqrt

BORE, STROKE, ROD, RATIO = 0.086, 0.086, 0.143, 10.3
GAMMA = 1.30
INTAKE, EXHAUST = 0.95, 1.08  # bar, in the cylinder
INLET_CLOSES, EXHAUST_OPENS = -140.0, 130.0  # degrees after firing dead centre
BLOW_DOWN = 75.0  # degrees
COMBUSTION_STARTS, COMBUSTION_LASTS = -22.0, 52.0
HEAT = 1.24e3  # J a cycle and cylinder
A, M = 5.0, 2.0


def volume(theta):
    r, t = STROKE / 2, radians(theta)
    swept = pi / 4 * BORE**2 * STROKE
    travel = r * (1 - cos(t)) + ROD - sqrt(ROD**2 - (r * sin(t)) ** 2)
    return swept / (RATIO - 1) + pi / 4 * BORE**2 * travel


def burnt(theta):
    x = (theta - COMBUSTION_STARTS) / COMBUSTION_LASTS
    return 0.0 if x <= 0 else 1 - exp(-A * x ** (M + 1))


def smooth_step(x):
    """0 to 1 with two vanishing derivatives at both ends."""
    x = min(max(x, 0.0), 1.0)
    return x**3 * (10 - 15 * x + 6 * x * x)


def closed_cycle():
    """Pressure in bar from inlet closing to exhaust opening, every 0.01 degrees (Heun's method)."""
    step = 0.01
    count = round((EXHAUST_OPENS - INLET_CLOSES) / step)
    theta, p, table = INLET_CLOSES, INTAKE * 1e5, []

    def increment(theta, p):
        v0, v1 = volume(theta), volume(theta + step)
        heat = HEAT * (burnt(theta + step) - burnt(theta))
        return (-GAMMA * p * (v1 - v0) + (GAMMA - 1) * heat) / ((v0 + v1) / 2)

    for i in range(count + 1):
        theta = INLET_CLOSES + i * step
        table.append(p / 1e5)
        first = increment(theta, p)
        p += (first + increment(theta, p + first)) / 2
    return lambda angle: table[min(max(round((angle - INLET_CLOSES) / step), 0), count)]


def main():
    closed = closed_cycle()

    def pressure(theta):
        """theta in (-360, 360]."""
        if INLET_CLOSES <= theta <= EXHAUST_OPENS:
            return closed(theta)
        if theta > 0:
            expanded = closed(EXHAUST_OPENS) * (volume(EXHAUST_OPENS) / volume(theta)) ** GAMMA
            left = 1 - smooth_step((theta - EXHAUST_OPENS) / BLOW_DOWN)
            base = EXHAUST + (expanded - EXHAUST) * left
        else:
            base = EXHAUST
        # from exhaust to intake pressure around the overlap dead centre, 340 to 390 degrees
        since = theta if theta > 0 else theta + 720
        return base + (INTAKE - base) * smooth_step((since - 340) / 50)

    with open("pressure.csv", "w", encoding="ascii", newline="\n") as file:
        file.write("theta [deg],p [bar]\n")
        for degree in range(0, 721):
            theta = degree if degree <= 360 else degree - 720
            file.write(f"{degree},{pressure(theta):.5f}\n")


if __name__ == "__main__":
    main()

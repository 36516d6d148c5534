"""Models that several tests use."""

from pathlib import Path

import pytest

import englang as eng

ROOT = Path(__file__).parents[2]

MASS = """
use std.joints.Translational
use std.forces.LinearSpring
model Mass {
    param stiffness: Stiffness = 3 N/mm in (0 N/mm, 100 N/mm)
    param weight: Mass = 2 kg in (0 kg, 10 kg)
    gravity = [0, 0, 0] m/s^2
    marker wall = [0, 0, 0] mm
    body block { mass = weight; inertia = [1, 1, 1] g*m^2; marker eye = origin }
    joint rail = Translational(block.eye, wall)
    force spring = LinearSpring(block.eye, wall, stiffness: stiffness, free_length: 100 mm)
    start rail.travel = 120 mm
    output place = dot(block.origin.origin, ground.z) as mm
}
analysis swing = transient(Mass(), duration: 0.5 s, sample: 1 ms)
analysis long = transient(Mass(), duration: 20000 s, sample: 50 ms)
analysis sweep[k in [1, 4, 9] N/mm] = transient(Mass(stiffness: k), duration: 10 ms)
report extremes "Extremes" {
    value widest = maximum(swing.place) as mm
    require maximum(swing.place) < 0.2 m else "too far: {widest}"
    advise maximum(swing.place) < 0.1 m else "far: {widest}"
    figure places = history(swing.place, over: time)
}
report springs { value least = minimum(sweep[1..3].place) as m }
"""


@pytest.fixture(scope="session")
def mass() -> eng.Program:
    """A mass on a spring."""
    return eng.from_text(MASS, name="mass.eng")


@pytest.fixture(scope="session")
def slider_crank() -> eng.Program:
    """The slider-crank of the examples, from its text."""
    text = (ROOT / "examples/slider_crank/slider_crank.eng").read_text(encoding="utf-8")
    return eng.from_text(text, name="slider_crank.eng")

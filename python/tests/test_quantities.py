"""Quantities of pint in the place of texts with units."""

import pickle

import pint
import pytest

import englang as eng

UNITS: pint.UnitRegistry[float] = pint.UnitRegistry()

SHAFT = """
use std.joints.Revolute
use std.forces.TorsionSpring
model Shaft {
    param stiffness: TorsionalStiffness = 10 N*m/rad
    param speed: AngularVelocity = 1 rad/s
    param rate: Frequency = 1 Hz
    param oil: Temperature = 20 degC
    param share: 1 = 0.2
    param pressure: AbsolutePressure = 1 bar
    gravity = [0, 0, 0] m/s^2
    body wheel { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker hub = origin }
    joint bearing = Revolute(wheel.hub, ground)
    force spring = TorsionSpring(wheel.hub, ground, stiffness: stiffness)
    start der(bearing.angle) = speed
    output angle = bearing.angle*share as deg
    output others = rate*share as Hz
    output warmth = oil as K
    output load = pressure as bar
}
analysis turn = transient(Shaft(), duration: 0.1 s, sample: 1 ms)
report turns { value most = maximum(turn.angle) as deg }
"""


@pytest.fixture(scope="module")
def shaft() -> eng.Program:
    return eng.from_text(SHAFT, name="shaft.eng")


def value(analysis: eng.Analysis, path: str) -> float:
    return next(parameter.value for parameter in analysis.parameters if parameter.path == path)


@pytest.mark.parametrize(
    ("path", "number", "unit", "expected"),
    [
        ("stiffness", 3, "newton * meter / radian", 3.0),
        ("stiffness", 180, "newton * millimeter / degree", 0.18 * 180 / 3.141592653589793),
        ("speed", 30, "rpm", 3.141592653589793),
        ("rate", 2, "kilohertz", 2000.0),
        ("oil", 80, "degC", 80.0),
        ("oil", 353.15, "kelvin", 80.0),
        ("share", 5, "percent", 0.05),
        ("pressure", 250, "kilopascal", 2.5),
        ("pressure", 1, "psi", 0.0689475729),
    ],
)
def test_a_quantity_has_its_unit(shaft: eng.Program, path: str, number: float, unit: str, expected: float) -> None:
    changed = shaft.analysis("turn").set({path: UNITS.Quantity(number, unit)})
    assert value(changed, path) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("path", "number", "unit", "message"),
    [
        # `float` of these two is a number, which would count as one in SI units
        ("stiffness", 30, "degree", "stiffness is in kg"),
        ("pressure", 5, "percent", "pressure is in kg/m/s"),
        ("speed", 50, "hertz", "speed is in rad/s"),
        ("rate", 1, "mole", "there is no unit mole in Eng"),
        ("rate", 1, "hertz ** 0.5", "a root of a unit"),
    ],
)
def test_a_wrong_dimension_is_refused(shaft: eng.Program, path: str, number: float, unit: str, message: str) -> None:
    with pytest.raises(eng.SettingError, match=message):
        shaft.analysis("turn").set({path: UNITS.Quantity(number, unit)})


def test_a_value_is_one_number(shaft: eng.Program) -> None:
    with pytest.raises(TypeError, match="speed: a value is one number"):
        shaft.analysis("turn").set({"speed": UNITS.Quantity([1.0, 2.0], "rpm")})


def test_the_system_of_a_registry_does_not_count(shaft: eng.Program) -> None:
    units: pint.UnitRegistry[float] = pint.UnitRegistry(system="cgs")
    assert value(shaft.analysis("turn").set({"stiffness": units.Quantity(7, "N*m/rad")}), "stiffness") == 7.0


def test_runs_studies_and_bounds_take_quantities(shaft: eng.Program) -> None:
    analysis = shaft.analysis("turn")
    run = analysis.run({"speed": UNITS.Quantity(60, "rpm")}, step=UNITS.Quantity(1, "millisecond"))
    same = analysis.run({"speed": f"{2 * 3.141592653589793!r} rad/s"}, step="1 ms")
    assert run["angle"].tobytes() == same["angle"].tobytes()
    changed = analysis.set({"oil": UNITS.Quantity(80, "degC")})
    assert value(pickle.loads(pickle.dumps(changed)), "oil") == value(changed, "oil")
    study = shaft.study("turn", {"speed": [UNITS.Quantity(30, "rpm"), UNITS.Quantity(60, "rpm")]})
    assert not study.failures and study.units["speed"] == "rad/s"
    assert study["speed"][1] == pytest.approx(2 * 3.141592653589793)
    bounds = {"stiffness": (UNITS.Quantity(1, "N*m/rad"), UNITS.Quantity(3, "N*m/rad"))}
    objective = shaft.objective("turn", "turns.most", ["stiffness"], bounds=bounds, gradient=False)
    assert objective.settings([0.5]) == {"stiffness": pytest.approx(2.0)}


def test_a_simulation_takes_quantities(shaft: eng.Program) -> None:
    model = shaft.model("Shaft")
    simulation = model.simulation({"rate": UNITS.Quantity(2, "kilohertz")}, step=UNITS.Quantity(1, "millisecond"))
    assert simulation.value("others") == pytest.approx(400.0)
    with pytest.raises(eng.SettingError, match="stiffness"):
        model.simulation({"stiffness": UNITS.Quantity(30, "degree")})

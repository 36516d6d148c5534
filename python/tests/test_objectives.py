"""Objective functions against closed forms, and with an optimiser."""

import math
from collections.abc import Mapping

import numpy
import pytest
from scipy.optimize import minimize
from scipy.stats import qmc

import englang as eng
from conftest import MASS

# 100 mm + 20 mm cos(sqrt(k/m) t)
MOMENT = 100


def place(run: eng.Run) -> tuple[float, Mapping[str, float]]:
    """The place at 0.1 s with its derivatives."""
    return run["place"][MOMENT], {path: slope["place"][MOMENT] for path, slope in run.gradients.items()}


def frequency(stiffness: float, weight: float) -> float:
    return math.sqrt(stiffness / weight)


def test_value_and_gradient_are_those_of_the_closed_form(mass: eng.Program) -> None:
    objective = mass.objective("swing", place, ["stiffness", "weight"])
    assert objective.parameters == ["stiffness", "weight"] and objective.size == 2
    # between the limits 0 and 100 N/mm, 0 and 10 kg
    assert objective.start == pytest.approx([0.03, 0.2], rel=1e-4)
    assert numpy.array(objective.bounds) == pytest.approx(numpy.array([(0, 1), (0, 1)]), abs=1e-5)
    settings = objective.settings([0.05, 0.3])
    assert settings == pytest.approx({"stiffness": 5e3, "weight": 3}, rel=1e-4)
    value, slope = objective([0.05, 0.3])
    stiffness, weight = settings["stiffness"], settings["weight"]
    rate, time = frequency(stiffness, weight), 0.1
    assert value == pytest.approx(100 + 20 * math.cos(rate * time), abs=2e-3)
    by_rate = -20 * time * math.sin(rate * time)
    ranges = [(high - low) for low, high in ((0, 100e3), (0, 10))]
    expected = [by_rate * rate / 2 / stiffness * ranges[0], -by_rate * rate / 2 / weight * ranges[1]]
    assert slope == pytest.approx(expected, rel=2e-3)
    assert objective.runs == 1 and objective.run is not None and len(objective.run) == 501
    opposite, other = mass.objective("swing", place, ["stiffness", "weight"], maximise=True)([0.05, 0.3])
    assert opposite == -value and numpy.array_equal(other, -slope)


def test_an_optimiser_finds_the_stiffness(mass: eng.Program) -> None:
    # half a period after 0.1 s puts the mass to the other end of its way
    best = 2 * (math.pi / 0.1) ** 2
    bounds = {"stiffness": ("1 N/mm", "5 N/mm")}
    objective = mass.objective("swing", place, "stiffness", bounds=bounds)
    assert numpy.array(objective.bounds) == pytest.approx(numpy.array([(0, 1)]), abs=1e-12)
    found = minimize(objective, objective.start, jac=True, bounds=objective.bounds, method="L-BFGS-B")
    assert found.success
    assert objective.settings(found.x)["stiffness"] == pytest.approx(best, rel=2e-3)
    assert found.fun == pytest.approx(80, abs=1e-3)
    with_gradients = objective.runs
    plain = mass.objective("swing", lambda run: run["place"][MOMENT], "stiffness", bounds=bounds, gradient=False)
    again = minimize(plain, plain.start, bounds=plain.bounds, method="L-BFGS-B")
    assert again.fun == pytest.approx(80, abs=1e-3)
    assert with_gradients < plain.runs


def test_a_value_of_a_report_has_its_gradient() -> None:
    program = eng.from_text("""
        use std.joints.Revolute
        model Swing {
            param length: Length = 400 mm in (10 mm, 2 m)
            gravity = [0, -9.81, 0] m/s^2
            marker pivot = [0, 0, 0] mm
            body bob { mass = 1.2 kg; inertia = [2, 2, 2] g*m^2; marker top = [0, 1, 0]*length }
            joint pin = Revolute(bob.top, pivot)
            start pin.angle = 30 deg
            output height = dot(bob.origin.origin, ground.y) as mm
        }
        analysis swing = transient(Swing(), duration: 1 s, sample: 5 ms)
        report size { value highest = maximum(swing.height) as mm; value lowest = minimum(swing.height) as mm }""")
    objective = program.objective("swing", "size.lowest", "length")
    value, slope = objective(objective.start)
    # the bob hangs at its length when it passes the lowest point
    assert value == pytest.approx(-400, rel=1e-4)
    assert slope == pytest.approx([-1990], rel=1e-3)
    ahead = program.objective("swing", "size.lowest", "length", gradient=False)
    assert (ahead(objective.start + 1e-3) - ahead(objective.start - 1e-3)) / 2e-3 == pytest.approx(slope[0], rel=1e-3)
    run = program.analysis("swing").run(gradients="length")
    assert run.report("size", by="length").units["lowest"] == "1"
    with pytest.raises(eng.SettingError, match=r'no gradients by lengt: run it with gradients=\["lengt"\]'):
        run.report("size", by="lengt")
    with pytest.raises(eng.SettingError, match="no such value; it has: highest, lowest"):
        program.objective("swing", "size.lowes", "length", gradient=False)(objective.start)


def test_designs_are_points_of_a_study(mass: eng.Program) -> None:
    objective = mass.objective("swing", place, ["weight"])
    points = objective.scale(qmc.Sobol(objective.size, rng=1).random_base2(3))
    study = mass.study("swing", points, values=len)
    assert study["value"] == [501] * 8
    assert min(study["weight"]) > 0 and max(study["weight"]) < 10
    program = eng.from_text(MASS.replace("2 kg in (0 kg, 10 kg)", "2 kg"))
    free = program.objective("swing", len, ["weight"], gradient=False)
    assert free.start == pytest.approx([1]) and free.bounds[0][1] is None
    with pytest.raises(eng.SettingError, match="state bounds="):
        free.scale([[0.5]])


def test_an_objective_without_gradients_has_none_of_the_text() -> None:
    text = MASS.replace("sample: 1 ms)", "sample: 1 ms, gradients: [weight])")
    program = eng.from_text(text)
    assert list(program.analysis("swing").run().gradients) == ["weight"]
    objective = program.objective("swing", "extremes.widest", "stiffness", gradient=False)
    assert objective(objective.start) == pytest.approx(120)
    assert objective.run is not None and not objective.run.gradients


def test_a_bound_stays_inside_of_one_limit() -> None:
    # the upper limit is infinite in millimetres
    text = MASS.replace("2 kg in (0 kg, 10 kg)", "2 kg").replace(
        "param weight", "param height: Length = 0 mm in (-5 mm, 1e308 m)\n    param weight"
    )
    objective = eng.from_text(text).objective("swing", len, "height", gradient=False)
    ((low, high),) = objective.bounds
    assert low is not None and high is None
    assert -5e-3 < objective.settings([low])["height"] < -4.9e-3


def test_patterns_take_all_their_parameters(mass: eng.Program) -> None:
    objective = mass.objective("swing", place, ["w*", "stiffness", "weight"])
    assert objective.parameters == ["weight", "stiffness"]
    assert repr(objective) == "<Objective of swing over weight, stiffness>"


def test_mistakes_are_told(mass: eng.Program) -> None:
    with pytest.raises(eng.SettingError, match="did you mean weight"):
        mass.objective("swing", place, "weigt")
    with pytest.raises(eng.SettingError, match="name a report and its value"):
        mass.objective("swing", "widest", "weight")
    with pytest.raises(eng.SettingError, match="bounds: stiffness is not among"):
        mass.objective("swing", place, "weight", bounds={"stiffness": (1.0, 2.0)})
    with pytest.raises(eng.SettingError, match="is not below"):
        mass.objective("swing", place, "weight", bounds={"weight": ("2 kg", "1 kg")})
    with pytest.raises(TypeError, match="a value and its derivatives"):
        mass.objective("swing", len, "weight")([0.5])
    with pytest.raises(TypeError, match="gradients is no argument for many runs"):
        mass.objective("swing", place, "weight", gradients=["weight"])  # type: ignore[call-arg]
    with pytest.raises(ValueError, match="there are 1 parameters"):
        mass.objective("swing", place, "weight")([0.5, 0.5])

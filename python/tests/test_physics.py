"""Runs against closed forms."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy
import pytest

import englang as eng


@pytest.mark.parametrize(("throw", "rod"), [(0.0685, 0.207), (0.04, 0.11), (0.05, 0.3)])
def test_a_slider_crank_moves_by_its_closed_form(slider_crank: eng.Program, throw: float, rod: float) -> None:
    run = slider_crank.analysis("inertia").run({"throw": f"{1e3 * throw} mm", "rod_length": rod, "speed": "3000 rpm"})
    speed = 3000 * math.pi / 30
    angle = speed * run.si("time")
    sine, cosine = numpy.sin(angle), numpy.cos(angle)
    along = numpy.sqrt(rod**2 - (throw * sine) ** 2)
    place = throw * cosine + along
    velocity = -throw * speed * sine * (1 + throw * cosine / along)
    assert len(run) == 145
    assert numpy.max(numpy.abs(run.si("piston_place") - place)) < 1e-9 * throw
    assert numpy.max(numpy.abs(run.si("piston_velocity") - velocity)) < 1e-9 * throw * speed
    assert run.units["piston_place"] == "mm"
    assert numpy.array_equal(run["piston_place"], run.si("piston_place") / 1e-3)


def test_a_sweep_over_parameters_has_the_periods_of_the_springs(mass: eng.Program) -> None:
    analysis = mass.analysis("swing")
    stated: list[tuple[str | float, float]] = [("1 N/mm", 1000), ("2 N/mm", 2000), (5000.0, 5000)]
    for stiffness, si in stated:
        setting = {"stiffness": stiffness, "weight": numpy.float32(0.5)}
        coarse, fine = (analysis.run(setting, step=step) for step in ("100 us", 50e-6))
        exact = 0.1 + 0.02 * numpy.cos(math.sqrt(si / 0.5) * fine.si("time"))
        errors = coarse.si("place") - exact, fine.si("place") - exact
        # of second order: half the step leaves a quarter of the error, and the rest is of fourth order
        largest = [float(numpy.max(numpy.abs(error))) for error in errors]
        assert largest[0] / largest[1] == pytest.approx(4, rel=1e-3)
        assert numpy.max(numpy.abs(4 * errors[1] - errors[0])) / 3 < 1e-7 * 0.02


def test_a_sweep_of_the_text_has_its_points(mass: eng.Program) -> None:
    names = [name for name in mass.analyses if name.startswith("sweep[")]
    assert names == ["sweep[1]", "sweep[2]", "sweep[3]"]
    runs = [mass.analysis(name).run() for name in names]
    assert [run.point["k"] for run in runs] == pytest.approx([1, 4, 9], rel=1e-15)
    with pytest.raises(eng.SettingError, match="varies stiffness"):
        mass.analysis("sweep[1]").run({"stiffness": "1 N/mm"})


def test_runs_side_by_side_give_the_same_bits(slider_crank: eng.Program) -> None:
    analysis = slider_crank.analysis("inertia")
    settings = [{"rod_length": 0.18 + 0.01 * point} for point in range(4)]
    alone = [analysis.run(one) for one in settings]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(analysis.run, settings))
    for one, other in zip(alone, together, strict=True):
        for path in one.columns:
            assert one[path].tobytes() == other[path].tobytes(), path


def test_a_simulation_is_stepped_and_continued(mass: eng.Program) -> None:
    model = mass.model("Mass")
    simulation = model.simulation({"stiffness": "8 N/mm"}, tolerance=1e-3)
    read = simulation.watch("place", "rail.speed")
    assert simulation.advance(0.01) == 0.01
    place, speed = read()
    rate = math.sqrt(8000 / 2)
    assert place == pytest.approx(0.1 + 0.02 * math.cos(rate * 0.01), abs=1e-7)
    assert speed == pytest.approx(-0.02 * rate * math.sin(rate * 0.01), abs=1e-5)
    assert simulation.value("place") == place
    saved = simulation.checkpoint()
    other = model.simulation({"stiffness": "8 N/mm"}, tolerance=1e-3, checkpoint=saved)
    simulation.advance(0.05)
    other.advance(0.05)
    assert simulation.value("place") == other.value("place")
    assert simulation.time == other.time
    assert simulation.cycle_angle is None


def test_inputs_are_set_while_a_simulation_runs() -> None:
    program = eng.from_text("""
        use std.joints.Revolute
        force Brake(a: Marker, b: Marker, torque: Torque) { apply torque -torque*b.z on a against b }
        model Rotor {
            input brake: Torque = 0 N*m in (-1 N*m, 50 N*m)
            gravity = [0, 0, 0] m/s^2
            marker axis = [0, 0, 0] mm
            body wheel { mass = 5 kg; inertia = [20, 20, 40] g*m^2; marker hub = origin }
            joint hinge = Revolute(wheel.hub, axis)
            force load = Brake(wheel.hub, axis, torque: brake)
            start der(hinge.angle) = 100 rad/s
        }""")
    model = program.model("Rotor")
    (brake,) = model.inputs
    assert (brake.path, brake.unit, brake.interpolation) == ("brake", "N*m", "hold")
    assert (brake.lower, brake.upper) == pytest.approx((-1, 50))
    simulation = model.simulation()
    simulation.set_input("brake", "4 N*m")
    simulation.advance(0.1)
    # 4 N m on 0.04 kg m² for 0.1 s
    assert simulation.value("hinge.speed") == pytest.approx(100 - 4 / 0.04 * 0.1, rel=1e-9)
    with pytest.raises(eng.Error, match="brake"):
        simulation.set_input("brake", 80.0)
    with pytest.raises(eng.SettingError, match="brake"):
        simulation.set_input("brake", "3 kg")

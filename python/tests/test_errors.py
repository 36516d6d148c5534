"""Errors: the rendered message, its place and fix, and runs that end early."""

import _thread
import pickle
import signal
import threading
import time
from itertools import pairwise
from pathlib import Path

import pytest

import englang as eng

MISTAKE = """model M {
    param length: Length = 400 mn
}
"""


def test_a_wrong_text_names_place_and_fix() -> None:
    with pytest.raises(eng.ModelError) as raised:
        eng.from_text(MISTAKE, name="mistake.eng")
    error = raised.value
    text = str(error)
    assert text.startswith("error[") and "mistake.eng:2:32" in text and "400 mn" in text
    (diagnostic,) = error.diagnostics
    assert diagnostic.severity == "error" and diagnostic.code in text
    assert diagnostic.place is not None and str(diagnostic.place) == "mistake.eng:2:32"
    assert any(fix.replacement == "mm" for fix in diagnostic.fixes)
    fix = next(fix for fix in diagnostic.fixes if fix.replacement == "mm")
    assert fix.place is not None
    mended = MISTAKE.encode()[: fix.place.start] + b"mm" + MISTAKE.encode()[fix.place.end :]
    assert eng.from_text(mended.decode()).models == ["M"]
    copied = pickle.loads(pickle.dumps(error))
    assert str(copied) == text and copied.diagnostics == error.diagnostics


def test_a_missing_file_is_an_error_of_the_system(tmp_path: object) -> None:
    with pytest.raises(FileNotFoundError, match="there is no file"):
        eng.load(f"{tmp_path}/none.eng")
    with pytest.raises(OSError, match="this is no file"):
        eng.load(f"{tmp_path}")


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"stiffnes": 1.0}, "stiffnes: there is no parameter stiffnes; did you mean stiffness?"),
        ({"stiffness": "1 N/furlong"}, "stiffness: there is no unit furlong"),
        ({"stiffness": "soft"}, "stiffness: "),
        ({"stiffness": "1 kg"}, "stiffness is in"),
    ],
)
def test_wrong_settings_are_refused(mass: eng.Program, setting: dict[str, str | float], message: str) -> None:
    with pytest.raises(eng.SettingError) as raised:
        mass.analysis("swing").run(setting)
    assert message in str(raised.value)
    assert isinstance(raised.value, ValueError)


def test_values_of_other_types_are_refused(mass: eng.Program) -> None:
    for value in [None, True, [1.0]]:
        with pytest.raises(TypeError, match='such as "250 mm", or a number in SI units'):
            mass.analysis("swing").run({"stiffness": value})  # type: ignore[dict-item]
    with pytest.raises(TypeError):
        mass.analysis("swing").run(3)  # type: ignore[arg-type]
    with pytest.raises(eng.SettingError, match="at least one"):
        mass.analysis("swing").run(threads=0)
    with pytest.raises(eng.SettingError, match="a step is a time"):
        mass.analysis("swing").run(step="1 mm")
    with pytest.raises(eng.RunError, match="step"):
        mass.analysis("swing").run(step=-1.0)


def test_wrong_arguments_are_refused(mass: eng.Program) -> None:
    analysis = mass.analysis("swing")
    with pytest.raises(TypeError, match="progress is a function of two numbers, not int"):
        analysis.run(progress=3)  # type: ignore[arg-type]
    # a run that is shorter than the time between two calls has the last one
    with pytest.raises(ZeroDivisionError):
        analysis.run(progress=lambda *_: 1 / 0)
    with pytest.raises(TypeError, match="gradients are texts, not float"):
        analysis.run(gradients=[1.0])  # type: ignore[list-item]
    assert list(analysis.run(gradients="weight").gradients) == ["weight"]
    assert analysis.run(channels="place").columns == ["time", "place"]
    with pytest.raises(eng.SettingError, match="brak: there is no input brak"):
        mass.model("Mass").simulation().set_input("brak", 1.0)


def test_paths_may_be_bytes(tmp_path: Path) -> None:
    file = tmp_path / "empty.eng"
    file.write_text("model Empty { }", encoding="utf-8")
    paths: list[str | bytes | Path] = [str(file), bytes(file), file]
    for path in paths:
        assert eng.load(path).models == ["Empty"]


def test_refusals_of_the_system_are_errors_of_the_system(mass: eng.Program, tmp_path: Path) -> None:
    run = mass.analysis("swing").run()
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(OSError, match="is a file, not a folder"):
        run.write_parquet(file / "below")
    with pytest.raises(OSError):
        run.write_parquet(tmp_path / ("x" * 300))
    with pytest.raises(eng.SettingError, match=r"no channel is called zz\*"):
        run.select("zz*")


def test_names_that_are_not_there_are_named(mass: eng.Program) -> None:
    with pytest.raises(eng.SettingError, match="no analysis swings; there are: swing"):
        mass.analysis("swings")
    with pytest.raises(eng.SettingError, match="no model Mas; there are: Mass"):
        mass.model("Mas")
    with pytest.raises(eng.SettingError, match="no channel plac; did you mean place"):
        mass.model("Mass").simulation().value("plac")


def test_limits_are_told_with_their_place(mass: eng.Program) -> None:
    with pytest.raises(eng.RunError) as raised:
        mass.analysis("swing").run({"weight": "11 kg"})
    assert "mass.eng:" in str(raised.value) and "weight" in str(raised.value)
    assert raised.value.diagnostics[0].place is not None
    assert raised.value.partial is None


def test_a_failed_run_keeps_its_samples() -> None:
    program = eng.from_text("""
        use std.joints.Translational
        force Guard(a: Marker, b: Marker) {
            require dot(a.origin - b.origin, b.z) < 100 mm else "too far"
            apply force 0*b.z*1 N on a against b
        }
        model Flight {
            gravity = [0, 0, 0] m/s^2
            marker wall = [0, 0, 0] mm
            body block { mass = 2 kg; inertia = [1, 1, 1] g*m^2; marker eye = origin }
            joint rail = Translational(block.eye, wall)
            force guard = Guard(block.eye, wall)
            start der(rail.travel) = 1 m/s
        }
        analysis flight = transient(Flight(), duration: 1 s, sample: 10 ms)""")
    with pytest.raises(eng.RunError, match="too far") as raised:
        program.analysis("flight").run()
    partial = raised.value.partial
    assert partial is not None and partial.failure is not None
    assert 9 <= len(partial) <= 11
    assert partial.si("rail.travel") == pytest.approx(partial.si("time"), abs=1e-9)
    copied = pickle.loads(pickle.dumps(raised.value))
    assert copied.partial is None and str(copied) == str(raised.value)


def test_ctrl_c_stops_a_run_and_keeps_its_samples(mass: eng.Program) -> None:
    # a shell without a terminal starts its jobs with the signal ignored
    before = signal.signal(signal.SIGINT, signal.default_int_handler)

    def interrupt(_fraction: float, now: float) -> None:
        # by the time of the model, so the load of the machine does not count
        if now > 1.0:
            _thread.interrupt_main()

    try:
        with pytest.raises(KeyboardInterrupt) as raised:
            mass.analysis("long").run(progress=interrupt)
    finally:
        signal.signal(signal.SIGINT, before)
    assert isinstance(raised.value, eng.Interrupted)
    partial = raised.value.partial
    assert partial is not None and 1 < len(partial) < 400000
    # the interpreter and the program are as before
    assert len(mass.analysis("swing").run()) == 501


def test_ctrl_c_ends_an_advance_at_a_step(mass: eng.Program) -> None:
    simulation = mass.model("Mass").simulation()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    # time has passed, however early the timer ends the next advance
    simulation.advance(1e-3)
    threading.Timer(0.5, _thread.interrupt_main).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            simulation.advance(1e12)
    finally:
        signal.signal(signal.SIGINT, before)
    # it stands at the end of a step, and goes on from there
    reached = simulation.time
    assert 1e-3 <= reached < 1e12
    assert simulation.advance(reached + 1e-3) == reached + 1e-3


def test_a_run_reports_its_progress_and_may_be_stopped(mass: eng.Program) -> None:
    told: list[tuple[float, float]] = []

    def progress(fraction: float, now: float) -> None:
        told.append((fraction, now))
        if len(told) == 3:
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        mass.analysis("long").run(progress=progress)
    assert len(told) == 3
    assert 0 < told[0][0] < told[1][0] < told[2][0] < 1
    assert told[2][1] == pytest.approx(told[2][0] * 20000, rel=1e-6)
    told.clear()
    told_at_the_end = told.append
    mass.analysis("swing").run(progress=lambda *now: told_at_the_end(now))
    assert told[-1] == (1.0, 0.5)


def test_other_threads_go_on_during_a_run(mass: eng.Program) -> None:
    ticks = 0
    ended = threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not ended.wait(0.001):
            ticks += 1

    # the ticks at each call of `stop`. A run that kept the interpreter would let through one tick a call at most
    at_calls: list[int] = []

    def several() -> bool:
        return any(later - earlier >= 3 for earlier, later in pairwise(at_calls))

    def stop(_fraction: float, _now: float) -> None:
        at_calls.append(ticks)
        # a guard: a run without ticks does not go on for ever
        if several() or time.monotonic() - began > 600:
            raise LookupError

    thread = threading.Thread(target=tick)
    began = time.monotonic()
    thread.start()
    with pytest.raises(LookupError):
        mass.analysis("long").run(progress=stop)
    ended.set()
    thread.join()
    assert several()


def test_nothing_is_printed(mass: eng.Program, capfd: pytest.CaptureFixture[str]) -> None:
    mass.analysis("swing").run().report("extremes")
    with pytest.raises(eng.ModelError):
        eng.from_text(MISTAKE)
    assert capfd.readouterr() == ("", "")

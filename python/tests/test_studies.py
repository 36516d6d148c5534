"""Studies over executors, and what travels to other processes."""

import gc
import math
import multiprocessing
import pickle
import signal
import tempfile
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy
import pandas
import polars
import pytest
from distributed import Client

import englang as eng
from conftest import MASS, ROOT
from englang import _program

STIFFNESSES = [1.0, 4.0, 9.0, 16.0]


@pytest.fixture(scope="module")
def processes() -> Iterator[Executor]:
    """Two processes that share nothing with this one."""
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


def period(run: eng.Run) -> dict[str, float]:
    """The period of a mass on a spring, from its energy."""
    speed = numpy.abs(run.si("rail.speed")).max()
    return {"period": float(2 * math.pi * 0.02 / speed), "samples": float(len(run))}


def wrong(run: eng.Run) -> float:
    """A mistake of a user at one point."""
    if run.metadata["parameter.stiffness"].startswith("4 "):
        raise LookupError("no such thing")
    return 1.0


def taken(_run: eng.Run) -> dict[str, float]:
    """Names that the study has already."""
    return {"weight": 1.0, "state": 2.0, "other": 3.0}


def temporary(place: str) -> None:
    """Takes a folder for temporary files."""
    tempfile.tempdir = place


def folders_of(program: eng.Program, place: str) -> list[str]:
    """The folders of programs in a worker process that keeps a program."""
    return [folder.name for folder in Path(place).glob("englang-*") if (folder / program.file).is_file()]


def without_kept_programs() -> None:
    """A forked process drops the programs of its parent."""
    _program._KEPT.clear()
    gc.collect()


def expected(stiffness: float) -> float:
    return 2 * math.pi * math.sqrt(2 / (1e3 * stiffness))


@pytest.mark.parametrize(
    "points",
    [
        [{"stiffness": f"{stiffness} N/mm"} for stiffness in STIFFNESSES],
        [{"stiffness": 1e3 * stiffness} for stiffness in STIFFNESSES],
        {"stiffness [N/mm]": STIFFNESSES},
        {"stiffness": numpy.array(STIFFNESSES) * 1e3},
        pandas.DataFrame({"stiffness [N/m]": [1e3 * stiffness for stiffness in STIFFNESSES]}),
        polars.DataFrame({"stiffness [N/mm]": STIFFNESSES}),
        polars.DataFrame({"stiffness [N/mm]": STIFFNESSES}).to_arrow(),
    ],
    ids=["quantities", "numbers", "columns", "arrays", "pandas", "polars", "arrow"],
)
def test_points_come_in_many_forms(mass: eng.Program, points: Any) -> None:
    study = mass.study("swing", points, values=period)
    scale = 1e3 if study.units["stiffness"] == "N/m" else 1.0
    assert [value / scale for value in study["stiffness"]] == pytest.approx(STIFFNESSES, rel=1e-15)
    assert study["period"] == pytest.approx([expected(stiffness) for stiffness in STIFFNESSES], rel=1e-3)
    assert study["state"] == ["complete"] * 4
    assert study.failures == []


def test_every_executor_gives_the_same_rows(mass: eng.Program, processes: Executor) -> None:
    points = {"stiffness [N/mm]": STIFFNESSES}
    alone = mass.study("swing", points, values=period, reports="extremes")
    assert alone.units == {"stiffness": "N/mm", "report.extremes.widest": "mm"}
    assert alone["report.extremes.widest"] == pytest.approx([120] * 4, rel=1e-9)
    assert alone["report.extremes.holds"] == [True] * 4
    with ThreadPoolExecutor(2) as threads:
        assert mass.study("swing", points, values=period, reports="extremes", executor=threads) == alone
    assert mass.study("swing", points, values=period, reports="extremes", executor=processes) == alone


def test_dask_runs_a_study(mass: eng.Program) -> None:
    points = {"stiffness [N/mm]": STIFFNESSES}
    with Client(n_workers=1, threads_per_worker=1, dashboard_address=None) as client:  # type: ignore[no-untyped-call]
        study = mass.study("swing", points, executor=client.get_executor())
    assert study == mass.study("swing", points)
    assert study["state"] == ["complete"] * 4


def test_a_failed_point_is_a_row(mass: eng.Program, processes: Executor) -> None:
    points = [{"weight": "1 kg"}, {"weight": "11 kg"}, {"weight": "3 kg", "stiffness": "4 N/mm"}]
    study = mass.study("swing", points, reports=["extremes"], executor=processes)
    assert study["state"] == ["complete", "failed", "complete"]
    assert study["stiffness"] == [None, None, 4.0]
    (failure,) = study.failures
    assert failure["weight"] == pytest.approx(11) and failure["report.extremes.widest"] is None
    assert failure["code"].startswith("E") and "weight" in failure["message"]
    assert failure["place"].startswith("mass.eng:")
    mistaken = mass.study("swing", points[::2], values=wrong)
    assert mistaken["value"] == [1.0, None]
    assert mistaken["message"] == [None, "LookupError: no such thing"]
    assert mistaken["code"] == mistaken["place"] == [None, None]


def test_a_requirement_that_does_not_hold_is_told(mass: eng.Program) -> None:
    program = eng.from_text(MASS.replace("< 0.2 m else", "< 0.1 m else"))
    (row,) = program.study("swing", [{}], reports="extremes").rows
    assert row["state"] == "complete" and not row["report.extremes.holds"]
    assert row["message"] == "too far: 120 mm"


def test_mistakes_of_the_caller_are_errors(mass: eng.Program, processes: Executor) -> None:
    points = {"stiffness": ["1 N/mm"]}
    with pytest.raises(eng.SettingError, match="stiffnes: .* did you mean stiffness"):
        mass.study("swing", [{"stiffnes": 1.0}])
    with pytest.raises(eng.SettingError, match="furlong"):
        mass.study("swing", {"stiffness [N/furlong]": [1.0]})
    with pytest.raises(eng.SettingError, match="no report extreme; there are: extremes, springs"):
        mass.study("swing", points, reports="extreme")
    with pytest.raises(ValueError, match="different lengths: a has 1, b has 2"):
        mass.study("swing", {"a": [1], "b": [1, 2]})
    for wrong in [3, "stiffness", ["stiffness"], {"stiffness": "1 N/mm"}]:
        with pytest.raises(TypeError, match="list"):
            mass.study("swing", wrong)
    with pytest.raises(TypeError, match="folder is no argument for many runs: there are channels"):
        mass.study("swing", points, folder="out")  # type: ignore[call-arg]
    # a function that no other process can have
    with pytest.raises((AttributeError, pickle.PicklingError)):
        mass.study("swing", points, values=lambda run: 1.0, executor=processes)
    with pytest.raises(eng.SettingError, match="values="):
        eng.from_text("model M { param x: Length = 1 mm }\nanalysis a = assemble(M())").study("a", [{}])


def test_a_column_has_one_unit(mass: eng.Program) -> None:
    with pytest.raises(eng.SettingError, match="stiffness: the points have it in N/mm and in N/m; use one of them"):
        mass.study("swing", [{"stiffness": "4 N/mm"}, {"stiffness [N/m]": 3e3}], values=len)
    with pytest.raises(eng.SettingError, match="stiffness is stated twice"):
        mass.study("swing", {"stiffness": ["4 N/mm"], "stiffness [N/mm]": [3.0]}, values=len)
    points = [{"stiffness": "4 N/mm", "stiffness [N/mm]": None}, {"stiffness": None, "stiffness [N/mm]": 3.0}]
    assert mass.study("swing", points, values=len)["stiffness"] == [4.0, 3.0]


def test_values_have_names_of_their_own(mass: eng.Program, processes: Executor) -> None:
    for executor in (None, processes):
        with pytest.raises(eng.SettingError, match="values: weight, state are columns of the study already; choose"):
            mass.study("swing", {"weight": [1.0, 2.0]}, values=taken, executor=executor)


def test_a_missing_value_of_a_frame_is_not_set(mass: eng.Program) -> None:
    weights = {"weight": pandas.array([1.0, pandas.NA], dtype="Float64"), "stiffness": [math.nan, 4e3]}
    study = mass.study("swing", pandas.DataFrame(weights), values=len)
    assert study["weight"] == [1.0, None] and study["stiffness"] == [None, 4.0]


def test_a_study_is_a_table(mass: eng.Program) -> None:
    study = mass.study("swing", {"stiffness [N/mm]": STIFFNESSES}, values=period)
    assert study.columns == ["stiffness", "period", "samples", "state", "code", "message", "place"]
    frame = study.to_pandas()
    assert list(frame.columns) == study.columns and frame.attrs["units"] == {"stiffness": "N/mm"}
    assert study.to_polars()["period"].to_list() == study["period"]
    assert repr(study) == "<Study of swing: 4 points, 0 failed>"
    html = study._repr_html_()
    assert "stiffness<br>[N/mm]" in html and "4 points" in html
    with pytest.raises(KeyError, match="no column perio; it has: stiffness, period"):
        study["perio"]
    assert pickle.loads(pickle.dumps(study)) == study
    assert len(mass.study("swing", [])) == 0


def test_many_points_keep_their_order(mass: eng.Program) -> None:
    points = {"weight": numpy.linspace(1, 9, 600)}
    study = mass.study("swing", points, values=lambda run: float(run.si("rail.speed").max()), channels="rail.speed")
    assert study["weight"] == pytest.approx(points["weight"], rel=1e-15)
    fastest = 0.02 * numpy.sqrt(3e3 / points["weight"])
    assert study["value"] == pytest.approx(fastest, rel=2e-3)


def test_ctrl_c_ends_a_study(mass: eng.Program) -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    main = threading.main_thread().ident
    assert main is not None
    whole: list[int] = []

    def values(run: eng.Run) -> float:
        whole.append(len(run))
        return 0.0

    threading.Timer(0.5, signal.pthread_kill, (main, signal.SIGINT)).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            mass.study("long", {"weight": ["1 kg", "2 kg", "3 kg"]}, values=values)
    finally:
        signal.signal(signal.SIGINT, before)
    # no run went on to its end
    assert whole == []


def test_programs_and_analyses_travel(mass: eng.Program) -> None:
    program = pickle.loads(pickle.dumps(mass))
    assert (program.file, program.analyses) == (mass.file, mass.analyses)
    # the same text is compiled once
    assert pickle.loads(pickle.dumps(mass)) is program
    analysis = mass.analysis("swing").set({"stiffness": "8 N/mm"}).set({"weight": numpy.float64(0.5)})
    copied = pickle.loads(pickle.dumps(analysis))
    assert copied.program is program
    ours, theirs = analysis.run(), copied.run()
    assert ours["place"].tobytes() == theirs["place"].tobytes()
    library = eng.from_text("use shared.Empty\nanalysis none = assemble(Empty())", files={"shared.eng": "model Empty {}"})
    assert pickle.loads(pickle.dumps(library.analysis("none"))).name == "none"


def test_programs_of_files_travel(tmp_path: Path) -> None:
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "shared.eng").write_text("model Empty { param x: Length = 1 mm }", encoding="utf-8")
    main = tmp_path / "main.eng"
    main.write_text("use part.shared.Empty\nanalysis none = assemble(Empty())", encoding="utf-8")
    program = eng.load(main)
    bytes_of_it = pickle.dumps(program.analysis("none"))
    for file in tmp_path.rglob("*.eng"):
        file.unlink()
    copied = pickle.loads(bytes_of_it)
    assert copied.program.file == "main.eng" and copied.parameters[0].path == "x"
    # the files are read once
    assert pickle.dumps(program.analysis("none")) == bytes_of_it
    main.write_text("use part.shared.Empty\nanalysis none = assemble(Empty())", encoding="utf-8")
    (tmp_path / "part" / "shared.eng").write_text("model Empty { param x: Length = 1 mm }", encoding="utf-8")
    program = eng.load(main)
    main.unlink()
    with pytest.raises(OSError, match="main.eng"):
        pickle.dumps(program)
    main.write_text("use part.shared.Empty\nanalysis other = assemble(Empty())", encoding="utf-8")
    with pytest.raises(eng.SettingError, match="has changed since it was loaded"):
        pickle.loads(pickle.dumps(program))


@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_worker_processes_leave_no_folder(method: str, tmp_path: Path) -> None:
    (tmp_path / "main.eng").write_text("model Empty {}\nanalysis none = assemble(Empty())", encoding="utf-8")
    program = eng.load(tmp_path / "main.eng")
    place = tmp_path / "temporary"
    place.mkdir()
    context = multiprocessing.get_context(method)
    with ProcessPoolExecutor(1, mp_context=context, initializer=temporary, initargs=(str(place),)) as pool:
        (folder,) = pool.submit(folders_of, program, str(place)).result()
        assert (place / folder).is_dir()
    assert list(place.iterdir()) == []


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="the system has no fork")
def test_a_forked_process_keeps_the_folder_of_its_parent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "main.eng").write_text("model Empty {}\nanalysis none = assemble(Empty())", encoding="utf-8")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    packed = pickle.dumps(eng.load(tmp_path / "main.eng"))
    monkeypatch.setattr(_program, "_KEPT", {})
    assert pickle.loads(packed).analyses == ["none"]
    worker = multiprocessing.get_context("fork").Process(target=without_kept_programs)
    worker.start()
    worker.join()
    assert worker.exitcode == 0 and len(list(tmp_path.glob("englang-*"))) == 1
    without_kept_programs()
    assert list(tmp_path.glob("englang-*")) == []


def test_runs_travel(mass: eng.Program, processes: Executor) -> None:
    analysis = mass.analysis("swing").set({"stiffness": "8 N/mm"})
    settings = [{"weight": 1.0}, {"weight": 2.0}]
    for run, setting in zip(processes.map(analysis.run, settings), settings, strict=True):
        own = analysis.run(setting)
        assert run.columns == own.columns and run.units == own.units and run.metadata == own.metadata
        assert (run.warnings, run.point, run.facts, run.failure) == (own.warnings, own.point, own.facts, own.failure)
        for path in run.columns:
            assert run[path].tobytes() == own[path].tobytes(), path
        report, of_own = run.report("extremes"), own.report("extremes")
        assert report.values == of_own.values and report.figures == of_own.figures
        assert mass.report("extremes", run).values == of_own.values


def test_gradients_and_orbits_travel() -> None:
    program = eng.load(ROOT / "examples/big_end/big_end.eng")
    assert pickle.loads(pickle.dumps(program)).reports == program.reports
    mass = eng.from_text(MASS)
    run = mass.analysis("swing").run(gradients="weight")
    copied = pickle.loads(pickle.dumps(run))
    slope = pickle.loads(pickle.dumps(copied.gradients["weight"]))
    assert slope["place"].tobytes() == run.gradients["weight"]["place"].tobytes()
    assert slope.unit == "kg" and slope.units == run.gradients["weight"].units
    with pytest.raises(eng.SettingError, match="a run of swing"):
        mass.analysis("long")._native.restored(run._native.packed())
    with pytest.raises(eng.SettingError, match="no run of this version"):
        mass.analysis("swing")._native.restored(b"nothing")


def test_reports_travel(mass: eng.Program) -> None:
    report = mass.analysis("swing").run().report("extremes")
    copied = pickle.loads(pickle.dumps(report))
    assert (copied.values, copied.units, copied.conditions) == (report.values, report.units, report.conditions)
    assert copied.figures == report.figures and copied.figures["places"]._repr_svg_().lstrip().startswith("<svg")


def test_the_values_of_a_study_may_be_any_function(mass: eng.Program) -> None:
    functions: list[Callable[[eng.Run], Any]] = [len, lambda run: {"widest": run["place"].max()}]
    for function in functions:
        assert mass.study("swing", [{}], values=function)["state"] == ["complete"]

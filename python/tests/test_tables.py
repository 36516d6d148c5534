"""Tables: NumPy, Arrow, files."""

import base64
import gc
import math
import re
import sys
from pathlib import Path

import numpy
import pandas
import polars
import pyarrow
import pyarrow.parquet
import pytest

import englang as eng
from conftest import MASS


def test_arrow_reads_the_memory_of_the_run(mass: eng.Program) -> None:
    run = mass.analysis("swing").run()
    table = pyarrow.table(run)
    assert table.column_names == run.columns
    assert table.num_rows == len(run) == 501
    for path in run.columns:
        (chunk,) = table[path].chunks
        values = run[path]
        assert chunk.buffers()[1].address == values.__array_interface__["data"][0]
        assert numpy.array_equal(chunk.to_numpy(), values)
    field = table.schema.field("place")
    assert field.metadata[b"unit"] == b"mm"
    assert float(field.metadata[b"si_scale"]) == 1e-3
    assert table.schema.metadata[b"eng.analysis"] == b"swing"
    assert pyarrow.schema(run) == table.schema
    # the table keeps the memory
    del run, values
    gc.collect()
    assert chunk.to_numpy().size == 501
    assert table["place"][0].as_py() == pytest.approx(120, rel=1e-12)


def test_polars_and_pandas_read_the_run(mass: eng.Program) -> None:
    run = mass.analysis("swing").run()
    frame = polars.DataFrame(run)
    assert frame.columns == run.columns
    other = pandas.DataFrame.from_arrow(run)
    for path in run.columns:
        assert numpy.array_equal(frame[path].to_numpy(), run[path])
        assert numpy.array_equal(other[path].to_numpy(), run[path])
    again = pyarrow.table(frame.to_arrow())
    assert again["place"].to_pylist() == run["place"].tolist()


def test_frames_are_one_call(mass: eng.Program, monkeypatch: pytest.MonkeyPatch) -> None:
    run = mass.analysis("swing").run(gradients="weight")
    for table in (run, run.gradients["weight"]):
        frame, other = table.to_pandas("place"), table.to_polars()
        assert [path for path in frame.columns if not path.endswith(".gradient")] == ["time", "place"]
        assert frame.attrs["units"]["place"] == table.units["place"]
        assert other.columns == table.columns
        for path in frame.columns:
            assert numpy.array_equal(frame[path].to_numpy(), table[path])
            assert numpy.array_equal(other[path].to_numpy(), table[path])
    for name, method in (("pandas", run.to_pandas), ("polars", run.to_polars)):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(ModuleNotFoundError, match=f"pip install {name}"):
            method()


def test_notebooks_show_tables_and_reports(mass: eng.Program) -> None:
    run = mass.analysis("swing").run(gradients="weight")
    html = run._repr_html_()
    assert "501 samples" in html and "time<br>[s]" in html and "120" in html
    # rows of the samples, and of the values of the report over this analysis; the other report is about the sweep
    assert html.count("<tr>") == 1 + 5 + 1 + 1 + 1
    assert "<h4>Extremes</h4>" in html and "⚠ far: 120 mm" in html and html.count("<img") == 1
    assert "springs" not in html and "run it first" not in html
    figures = "".join(f"    figure more{number} = history(swing.place, over: time)\n" for number in range(5))
    program = eng.from_text(MASS.replace("    figure places", f"{figures}    figure places"))
    html = program.analysis("swing").run()._repr_html_()
    assert html.count("<img") == 4 and "2 more figures" in html
    # nothing of a report whose columns are not there
    html = run.select("rail.travel")._repr_html_()
    assert "501 samples" in html and "Extremes" not in html
    assert "Gradient of swing by weight" in run.gradients["weight"]._repr_html_()
    report = run.report("extremes")
    html = report._repr_html_()
    assert "<h4>Extremes</h4>" in html and "widest" in html and "mm" in html
    assert "⚠ far: 120 mm" in html
    (coded,) = re.findall('<img alt="places" .* src="data:image/svg\\+xml;base64,(.*)">', html)
    assert base64.b64decode(coded).decode() == report.figures["places"]
    assert report.figures["places"]._repr_svg_() == report.figures["places"]
    with pytest.raises(TypeError, match="not iterable"):
        iter(run)  # type: ignore[call-overload]


def test_columns_are_read_without_numpy(mass: eng.Program) -> None:
    run = mass.analysis("swing").run()
    column = run.column("place")
    assert (column.path, column.unit, len(column)) == ("place", "mm", 501)
    view = memoryview(column)
    assert (view.format, view.shape, view.readonly, view.nbytes) == ("d", (501,), True, 8 * 501)
    assert view.tolist() == list(column) == run["place"].tolist()
    assert column[-1] == column[500] == view[500]
    assert bytes(column) == run["place"].tobytes()
    for wrong in [501, -502]:
        with pytest.raises(IndexError):
            column[wrong]
    with pytest.raises(ValueError, match="read-only"):
        run["place"][0] = 0.0
    with pytest.raises(TypeError):
        view[0] = 0.0  # type: ignore[call-overload]
    del column, run
    gc.collect()
    assert view[0] == pytest.approx(120, rel=1e-12)


def test_a_selection_keeps_columns(mass: eng.Program) -> None:
    run = mass.analysis("swing").run()
    assert run.select("rail.*", "place").columns == [
        path for path in run.columns if path in ("time", "place") or path.startswith("rail.")
    ]
    kept = mass.analysis("swing").run(channels=["place"])
    assert kept.columns == ["time", "place"]
    assert numpy.array_equal(kept["place"], run["place"])
    assert "place" in kept and "rail.travel" not in kept
    with pytest.raises(KeyError, match="rail.travel"):
        kept["rail.travel"]
    with pytest.raises(eng.Error, match="no channel is called rail.trave"):
        run.select("rail.trave")


def test_files_are_those_of_the_command(mass: eng.Program, tmp_path: Path) -> None:
    run = mass.analysis("swing").run()
    written = run.write_parquet(tmp_path)
    assert written == tmp_path / "swing.parquet"
    table = pyarrow.parquet.read_table(written)
    assert table.equals(pyarrow.table(run))
    streamed = mass.analysis("swing").run(folder=tmp_path / "streamed")
    assert numpy.array_equal(streamed["place"], run["place"])
    assert (tmp_path / "streamed" / "swing.parquet").is_file()
    again = mass.analysis("swing").run(folder=tmp_path / "streamed", resume=True)
    assert "not run again" in " ".join(again.facts)
    assert again["place"] == pytest.approx(run["place"], rel=1e-15)


def test_reports_give_their_numbers(mass: eng.Program) -> None:
    run = mass.analysis("swing").run()
    assert mass.reports == ["extremes", "springs"]
    report = run.report("extremes")
    assert report.title == "Extremes"
    widest = float(numpy.max(run["place"]))
    assert report.values["widest"] == pytest.approx(widest, rel=1e-12)
    assert report.units["widest"] == "mm"
    assert sorted(report.values) == sorted(report.units)
    required, advised = report.conditions
    assert required.holds and not required.advises
    assert not advised.holds and advised.advises and "120 mm" in advised.message
    assert report.holds
    assert report.figures["places"].lstrip().startswith("<svg")
    assert report.missing == {}
    assert mass.report("extremes").missing.keys() >= {"widest", "places"}


def test_a_report_over_several_runs_names_each_number(mass: eng.Program) -> None:
    runs = [mass.analysis(f"sweep[{point}]").run() for point in (1, 2, 3)]
    report = mass.report("springs", *runs)
    assert report.values == {
        f"least.sweep[{point}]": pytest.approx(1e-3 * float(numpy.min(run["place"])), rel=1e-12)
        for point, run in zip((1, 2, 3), runs, strict=True)
    }
    assert set(report.units.values()) == {"m"}


def test_reports_refuse_runs_of_another_text(mass: eng.Program, slider_crank: eng.Program) -> None:
    run = slider_crank.analysis("inertia").run(channels=["piston_place"])
    with pytest.raises(eng.SettingError, match="another text"):
        mass.report("extremes", run)
    with pytest.raises(eng.SettingError, match="no report extreme; there are: extremes, springs"):
        mass.report("extreme")


def test_parameters_have_units_limits_and_values(mass: eng.Program) -> None:
    parameters = mass.model("Mass").parameters
    assert [parameter.path for parameter in parameters][:3] == ["stiffness", "weight", "block.mass"]
    stiffness, weight = parameters[:2]
    assert (stiffness.path, stiffness.unit, weight.unit) == ("stiffness", "N/mm", "kg")
    assert (stiffness.value, stiffness.upper) == pytest.approx((3, 100))
    assert stiffness.lower == 0
    assert stiffness.si_scale == 1000 and stiffness.si_offset == 0
    changed = mass.analysis("swing").set({"stiffness": 5000.0, "weight": "1500 g"}).parameters
    assert [parameter.value for parameter in changed[:2]] == pytest.approx([5, 1.5])
    assert mass.model("Mass").summary.startswith("Mass: 1 body")
    channels = {channel.path: channel for channel in mass.model("Mass").channels}
    assert (channels["place"].unit, channels["place"].frame) == ("mm", "")
    assert math.isinf(eng.from_text("model M { param x: Length = 1 mm }").model("M").parameters[0].upper)


def test_gradients_are_tables(mass: eng.Program) -> None:
    analysis = mass.analysis("swing")
    run = analysis.run(gradients=["stiffness", "weight"])
    assert list(run.gradients) == ["stiffness", "weight"]
    by_stiffness = run.gradients["stiffness"]
    assert (by_stiffness.parameter, by_stiffness.unit) == ("stiffness", "N/mm")
    # derivatives of the moments of samples have columns of their own
    columns = [path for path in by_stiffness.columns if not path.endswith(".gradient")]
    assert columns == [path for path in run.columns if not path.startswith("energy.")]
    assert by_stiffness.units["place"] == "mm/(N/mm)"
    table = pyarrow.table(by_stiffness)
    assert table.num_rows == len(by_stiffness) == len(run)
    assert numpy.array_equal(table["place"].to_numpy(), by_stiffness["place"])
    # 100 mm + 20 mm cos(sqrt(k/m) t)
    stiffness, weight = 3000.0, 2.0
    time, frequency = run["time"], math.sqrt(stiffness / weight)
    expected = -0.02 * time * numpy.sin(frequency * time) * 0.5 * frequency / stiffness
    largest = numpy.abs(expected).max()
    assert numpy.abs(by_stiffness.si("place") - expected).max() < 1e-3 * largest
    expected *= -stiffness / weight
    assert numpy.abs(run.gradients["weight"].si("place") - expected).max() < 1e-3 * numpy.abs(expected).max()
    (only,) = run.select("place").gradients["weight"].columns[1:]
    assert only == "place"
    assert analysis.run().gradients == {}
    with pytest.raises(eng.SettingError, match="stiffnes"):
        analysis.run(gradients=["stiffnes"])

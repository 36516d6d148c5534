"""Notebooks of the documentation: their cells run, and what they assert holds."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))


def test_there_are_notebooks() -> None:
    assert [page.name for page in NOTEBOOKS] == ["bearing.ipynb"]


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_a_notebook_runs(page: Path, tmp_path: Path) -> None:
    """Runs the cells in their order in one process, without Jupyter. A cell compares its numbers by `assert`."""
    notebook = json.loads(page.read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert sum("assert" in cell for cell in cells) >= len(cells) / 2
    environment = {"PATH": "", "ENG_CACHE": str(tmp_path / "cache"), "MPLCONFIGDIR": str(tmp_path)}
    # the limit ends a notebook that hangs
    subprocess.run([sys.executable, "-c", "\n".join(cells)], cwd=tmp_path, env=environment, check=True, timeout=600)


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_a_notebook_stores_little(page: Path) -> None:
    """At most one picture, and outputs of all cells."""
    assert page.stat().st_size < 50_000
    cells = [cell for cell in json.loads(page.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    assert all(cell["outputs"] for cell in cells)
    pictures = [output for cell in cells for output in cell["outputs"] if "image/svg+xml" in output.get("data", {})]
    assert len(pictures) <= 1

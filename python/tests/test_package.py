"""The package: pages, command, modules that an import loads."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import englang as eng
from conftest import ROOT


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


def run(page: Path, folder: Path) -> None:
    """Runs the snippets of a page one after the other, as a reader would."""
    text = "\n".join(blocks(page, "python"))
    assert text
    environment = {"MPLBACKEND": "Agg", "PATH": "", "ENG_CACHE": str(folder / "cache"), "MPLCONFIGDIR": str(folder)}
    subprocess.run([sys.executable, "-c", text], cwd=folder, env=environment, check=True)


def test_the_page_is_true(tmp_path: Path) -> None:
    page = ROOT / "docs/python.md"
    (model,) = blocks(page, "eng")
    (tmp_path / "swing.eng").write_text(model, encoding="utf-8")
    run(page, tmp_path)
    assert (tmp_path / "swing.svg").stat().st_size > 1000


def test_the_readme_is_true(tmp_path: Path) -> None:
    run(ROOT / "python/README.md", tmp_path)


def test_the_command_is_in_the_package(tmp_path: Path) -> None:
    (model,) = blocks(ROOT / "docs/python.md", "eng")
    (tmp_path / "swing.eng").write_text(model, encoding="utf-8")
    for command in [[str(Path(sys.executable).with_name("eng"))], [sys.executable, "-m", "englang"]]:
        done = subprocess.run([*command, "check", "swing.eng"], cwd=tmp_path, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")
        version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True)
        assert version.stdout.strip() == f"eng {eng.__version__}"
    wrong = subprocess.run([*command, "check", "none.eng"], cwd=tmp_path, capture_output=True, text=True)
    assert wrong.returncode == 2 and "there is no file none.eng" in wrong.stderr


def test_every_name_has_a_text() -> None:
    for name in eng.__all__:
        if name != "__version__":
            assert getattr(eng, name).__doc__, name


# all of the standard library that an import of the package imports; what those import in turn is part of it
STANDARD = ("__future__", "collections.abc", "dataclasses", "functools", "importlib", "os", "typing")
# modules of the package that are imported at their first use
LATER = {"englang._command", "englang._display", "englang._objective", "englang._study"}


def loaded(statement: str) -> set[str]:
    """The modules of a fresh interpreter after a statement. It finds packages beside `englang`, but runs no code of its site."""
    beside = str(Path(eng.__file__).parents[1])
    code = f"import sys; sys.path.insert(0, {beside!r}); {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_an_import_of_the_package_loads_few_modules() -> None:
    # a program that runs a model pays for each of them at its start
    modules = loaded("import englang")
    assert "englang._program" in modules and not modules & LATER
    more = modules - loaded(f"import {', '.join(STANDARD)}")
    assert {name for name in more if name.partition(".")[0] != "englang"} == set()


def test_files_of_a_text_are_found() -> None:
    library = "model Empty { param x: Length = 1 mm }"
    program = eng.from_text("use shared.Empty\nanalysis none = assemble(Empty(x: 2 mm))", files={"shared.eng": library})
    assert program.analyses == ["none"]
    assert program.file == "model.eng"
    with pytest.raises(eng.ModelError):
        eng.from_text("use shared.Empty")

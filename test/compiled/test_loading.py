"""Machine code on disk: kept by content, announced when missing, never in the way."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from msd_ident.compiled import Library, build, folders, loading
from msd_ident.data import compiled as filters
from msd_ident.estimate import damped_step
from msd_ident.model import solver, warm_up

SIMULATE = """
import sys
import numpy as np
from msd_ident.model import Plant, simulate
from msd_ident.data.record import Record
t = np.linspace(0.0, 1.0, 50)
print(simulate(Plant(1.0, 1.0, 100.0), Record(time=t, position=t, force_time=t, force=t)).position[-1])
print("numba" in sys.modules)
"""

#: Carts on springs that bend: all digits of their positions.
BENT = """
import numpy as np
from msd_ident.model import Plant, simulate
from msd_ident.model.effects import by_name
from msd_ident.data.record import Record
t = np.linspace(0.0, 4.0, 800)
record = Record(t, t, np.array([0.0, 1.0, 2.0]), np.array([4.0, -3.0, 2.0]))
for name, values in (
    ("bilinear_spring", (0.006, 150.0)), ("end_stop", (0.018, 5e3)), ("one_sided_stop", (0.018, 5e3)),
):
    names = [p.name for p in by_name(name).parameters]
    model = Plant(1.0, 1.0, 100.0) + by_name(name).from_values(dict(zip(names, values, strict=True)))
    print(simulate(model, record, 0.01, 0.1).position.tolist())
"""
#: Peaks of a wave, in a process whose machine code cannot be linked; the library has no function but that.
UNLINKED = """
import sys
import numpy as np
from msd_ident.compiled import loading
def fails(library, code):
    raise RuntimeError("cannot be linked")
loading.linked = fails
from msd_ident.data.compiled import LIBRARY, peaks
for name in set(LIBRARY.functions) - {"peaks"}:
    del LIBRARY.functions[name]
print(peaks(np.sin(np.linspace(0.0, 20.0, 200)), 0.1).tolist(), "numba" in sys.modules)
"""


def ran(code: str, repository: Path, **changed: str) -> subprocess.CompletedProcess[str]:
    """A process with this code, and with these variables in place of those that name a cache."""
    environment = {**os.environ, "PYTHONPATH": str(repository), **changed}
    if changed:
        environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=True, env=environment, cwd=repository)


def test_a_second_process_compiles_nothing_and_imports_no_compiler(repository: Path) -> None:
    warm_up()
    done = ran(SIMULATE, repository)
    assert done.stderr == "" and done.stdout.split()[1] == "False"


@pytest.mark.long
def test_the_process_that_compiles_has_the_digits_of_those_that_load(repository: Path, tmp_path: Path) -> None:
    first, second = (ran(BENT, repository, XDG_CACHE_HOME=str(tmp_path)) for _ in range(2))
    assert first.stderr.count("compiling the solver, once") == first.stderr.count("\n") == 1
    assert "compiling" not in second.stderr
    assert first.stdout == second.stdout and len(first.stdout) > 1000


@pytest.mark.long
def test_without_another_process_the_solver_is_compiled_in_this_one(repository: Path, tmp_path: Path) -> None:
    alone = "import sys; sys.executable = None\n" + SIMULATE
    done = ran(alone, repository, XDG_CACHE_HOME=str(tmp_path))
    value, compiler = done.stdout.split()
    assert done.stderr.count("compiling") == 1 and float(value) == pytest.approx(0.0, abs=1.0) and compiler == "True"


def test_what_cannot_be_linked_is_compiled_by_numba_and_kept_by_it(repository: Path, tmp_path: Path) -> None:
    warm_up()
    path = folders.object_file(filters.LIBRARY)
    kept = tmp_path / "msd_ident" / "compiled" / path.name
    kept.parent.mkdir(parents=True)
    kept.write_bytes(path.read_bytes())
    first, second = (ran(UNLINKED, repository, XDG_CACHE_HOME=str(tmp_path)) for _ in range(2))
    assert first.stdout == second.stdout == "[16, 78, 141] True\n"
    assert list(tmp_path.glob("msd_ident/compiled/__pycache__/*.nbc"))


def test_what_cannot_be_made_is_tried_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(Library, "known", [])
    monkeypatch.setattr(Library, "files", lambda self: [])
    monkeypatch.setattr(build, "addresses", lambda library: {"by": 0})
    library = Library("test_no_such_module", "test_no_such_module")
    assert set(loading.natives(library, print)) == {"by"}
    assert folders.object_file(library).read_bytes() == b""
    monkeypatch.setattr(loading, "_build_apart", lambda libraries: pytest.fail("it is made again"))
    assert set(loading.natives(library, print)) == {"by"}


def test_a_cold_start_says_so_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(loading, "_build_apart", lambda libraries: None)
    monkeypatch.setattr(build, "addresses", lambda library: {})
    said: list[str] = []
    loading.natives(filters.LIBRARY, said.append)
    assert len(said) == 1 and "compiling the solver, once" in said[0] and "\n" not in said[0]


def test_a_warm_start_says_nothing() -> None:
    warm_up()
    said: list[str] = []
    assert set(loading.natives(solver.LIBRARY, said.append)) == {"plan", "run"}
    assert said == []


@cache
def damped_step_code() -> bytes:
    """Compiled once for the tests of an ``xdist_group``."""
    return build.object_code(damped_step.LIBRARY)


@pytest.mark.xdist_group("object code")
def test_object_code_asks_for_nothing_of_python() -> None:
    code = damped_step_code()
    assert b"PyErr" not in code.split(b"\0") and set(loading.linked(damped_step.LIBRARY, code)) == {"damped_step"}


@pytest.mark.xdist_group("object code")
def test_code_of_another_library_is_refused() -> None:
    with pytest.raises(RuntimeError, match="Symbols not found|Failed to materialize"):
        loading.linked(filters.LIBRARY, damped_step_code())

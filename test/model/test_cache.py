"""The compiled solver on disk: kept by content, announced when missing, never in the way."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.model import Plant, simulate, simulator, warm_up
from msd_ident.model.kernel import cache

SIMULATE = """
import numpy as np
from msd_ident.model import Plant, simulate
from msd_ident.data.record import Record
t = np.linspace(0.0, 1.0, 50)
print(simulate(Plant(1.0, 1.0, 100.0), Record(time=t, position=t, force_time=t, force=t)).position[-1])
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


def test_a_second_process_compiles_nothing(repository: Path) -> None:
    warm_up()
    environment = {**os.environ, "NUMBA_DEBUG_CACHE": "1", "PYTHONPATH": str(repository)}
    done = subprocess.run(
        [sys.executable, "-c", SIMULATE], capture_output=True, text=True, check=True, env=environment, cwd=repository
    )
    assert "compiling" not in done.stderr
    assert "data saved" not in done.stdout
    assert "data loaded" in done.stdout


@pytest.mark.long
def test_the_process_that_compiles_has_the_digits_of_those_that_load(repository: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": str(repository)}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-c", BENT]
    first, second = (
        subprocess.run(command, capture_output=True, text=True, check=True, env=environment, cwd=repository)
        for _ in range(2)
    )
    assert "compiling" in first.stderr and "compiling" not in second.stderr
    assert first.stdout == second.stdout and len(first.stdout) > 1000


@pytest.mark.long
def test_without_another_process_the_solver_is_compiled_in_this_one(repository: Path, tmp_path: Path) -> None:
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": str(repository)}
    environment.pop("NUMBA_CACHE_DIR", None)
    alone = "import sys; sys.executable = None\n" + SIMULATE
    done = subprocess.run(
        [sys.executable, "-c", alone], capture_output=True, text=True, check=True, env=environment, cwd=repository
    )
    assert done.stderr.count("compiling") == 1 and float(done.stdout) == pytest.approx(0.0, abs=1.0)


def test_a_cold_start_says_so_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    said: list[str] = []
    cache.load(said.append)
    assert len(said) == 1 and "compiling the solver, once" in said[0] and "\n" not in said[0]
    assert list(tmp_path.glob("msd_ident/solver-*/msd_solver_entry.py"))


def test_warming_up_leaves_nothing_to_load() -> None:
    warm_up()
    entries = simulator._kernel()
    assert len(entries.run.signatures) == len(entries.plan.signatures) == 1
    simulate(Plant(1.0, 1.0, 100.0), Record(np.arange(30.0), np.zeros(30), np.arange(30.0), np.ones(30)))
    assert len(entries.run.signatures) == len(entries.plan.signatures) == 1


def test_a_warm_start_says_nothing() -> None:
    warm_up()
    said: list[str] = []
    cache.load(said.append)
    assert said == []


def test_a_cache_folder_that_cannot_be_written_is_passed_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(blocked))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "good"))
    assert cache.folder().parent == tmp_path / "good" / "msd_ident"


def test_editing_any_law_or_kernel_file_makes_a_new_build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    room = Path(cache.__file__).parents[1]
    copy = tmp_path / "model"
    for path in (*room.glob("effects/*.py"), *room.glob("kernel/*.py"), room / "plant.py"):
        target = copy / path.relative_to(room)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(path.read_bytes())
    monkeypatch.setattr(cache, "__file__", str(copy / "kernel" / "cache.py"))
    before = cache.fingerprint()
    for name in ("effects/cogging.py", "kernel/rk.py", "effects/brand_new.py"):
        edited = copy / name
        edited.write_text((edited.read_text() if edited.exists() else "") + "\n# edited\n")
        after = cache.fingerprint()
        assert after != before
        before = after

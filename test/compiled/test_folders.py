"""Where machine code is kept."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from msd_ident.compiled import Library, folders
from msd_ident.estimate import damped_step
from msd_ident.model import solver


def test_a_folder_that_cannot_be_written_is_passed_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(blocked))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "good"))
    assert folders.folder() == tmp_path / "good" / "msd_ident" / "compiled"


def test_all_that_the_solver_is_made_from_counts() -> None:
    names = {"/".join(path.parts[-2:]) for path in solver.LIBRARY.files()}
    assert {"effects/cogging.py", "effects/law.py", "kernel/rk.py", "model/plant.py", "compiled/build.py"} <= names
    of_step = {"/".join(path.parts[-2:]) for path in damped_step.LIBRARY.files()}
    assert {"estimate/damped_step.py", "estimate/damped_step_loops.py"} <= of_step and "kernel/rk.py" not in of_step


def test_an_edited_a_new_and_a_renamed_file_make_another_build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Library, "files", lambda self: sorted(tmp_path.glob("*.py")))
    found = []
    for change in ("a = 1", "a = 2", ""):
        (tmp_path / "law.py").write_text(change)
        found.append(folders.fingerprint(solver.LIBRARY))
    (tmp_path / "new.py").write_text("")
    found.append(folders.fingerprint(solver.LIBRARY))
    (tmp_path / "new.py").rename(tmp_path / "newer.py")
    found.append(folders.fingerprint(solver.LIBRARY))
    assert len(set(found)) == 5


def test_another_processor_makes_another_build(monkeypatch: pytest.MonkeyPatch) -> None:
    """A home folder may be shared by computers, one of which lacks an instruction of the other."""
    before = folders.fingerprint(solver.LIBRARY)
    folders._machine.cache_clear()
    monkeypatch.setattr(folders.llvm, "get_host_cpu_name", lambda: "another")
    try:
        assert folders.fingerprint(solver.LIBRARY) != before
    finally:
        folders._machine.cache_clear()


def test_only_the_newest_builds_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    room = folders.folder()
    for age in range(6):
        old = room / f"{solver.LIBRARY.declared_in}-{age}.o"
        old.write_bytes(b"old")
        os.utime(old, (1000.0 - age, 1000.0 - age))
    other = room / f"{damped_step.LIBRARY.declared_in}-0.o"
    other.write_bytes(b"of another library")
    folders.keep(solver.LIBRARY, b"new")
    kept = {path.name.rpartition("-")[2] for path in room.glob(f"{solver.LIBRARY.declared_in}-*.o")}
    assert kept == {"0.o", "1.o", "2.o", folders.object_file(solver.LIBRARY).name.rpartition("-")[2]}
    assert other.exists() and not list(room.glob("*.tmp"))

"""Files are replaced whole or not at all."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest

from msd_ident.errors import SetupError
from msd_ident.writing import write_files, write_text


def test_a_full_disk_leaves_the_old_file(tmp_path: Path) -> None:
    """The old result was cut off, and the new one lost too."""
    path = tmp_path / "result.json"
    write_text("old", path)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(SetupError, match="cannot write .*result.json: .*; expected a writable file"):
            write_text("x" * 5000, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_text() == "old"
    assert [one.name for one in tmp_path.iterdir()] == ["result.json"]


def test_a_link_stays_and_its_file_keeps_its_rights(tmp_path: Path) -> None:
    real, link = tmp_path / "real.json", tmp_path / "link.json"
    write_text("old", real)
    real.chmod(0o640)
    link.symlink_to(real)
    write_text("new", link)
    assert link.is_symlink() and real.read_text() == "new"
    assert real.stat().st_mode & 0o777 == 0o640


def test_of_several_files_all_are_replaced_or_none(tmp_path: Path) -> None:
    """A model of MuJoCo was replaced, and its callback was lost."""
    model, callback = tmp_path / "m.xml", tmp_path / "m_callback.py"
    write_text("old", model)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(SetupError, match="cannot write .*m_callback.py: .*; expected a writable place"):
            write_files({model: b"new", callback: b"x" * 5000})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert model.read_text() == "old"
    assert [one.name for one in tmp_path.iterdir()] == ["m.xml"]
    write_files({model: b"new", callback: b"more"})
    assert (model.read_text(), callback.read_text()) == ("new", "more")

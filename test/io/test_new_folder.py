"""New folders: nothing is overwritten, and what a disk refuses is said in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from msd_ident.errors import SetupError
from msd_ident.io.new_folder import dated_folder


def test_two_that_ask_within_a_second_get_folders_of_their_own(tmp_path: Path) -> None:
    made = {dated_folder(tmp_path / "new", "demo") for _ in range(3)}
    assert len(made) == 3 and all(one.is_dir() and one.parent == tmp_path / "new" for one in made)


@pytest.mark.timeout(10)
def test_a_parent_that_is_a_link_to_nothing_is_refused(tmp_path: Path) -> None:
    """It exists and cannot be made, at every number."""
    (tmp_path / "out").symlink_to(tmp_path / "nowhere" / "at all")
    with pytest.raises(SetupError, match=r"cannot make .*out/demo_.*: File exists; expected a writable place"):
        dated_folder(tmp_path / "out", "demo")

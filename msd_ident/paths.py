"""What a path leads to: only files and folders are read, since a device or a pipe may have no end."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from msd_ident.errors import DataError

_KINDS = {
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
}


def kind_of(path: str | os.PathLike[str]) -> str:
    """``a device``, ``a pipe`` or ``a socket``, also behind links; empty for files, folders and what cannot be seen."""
    try:
        return _KINDS.get(stat.S_IFMT(os.stat(path).st_mode), "")
    except (OSError, ValueError):
        return ""


def check_plain(path: str | os.PathLike[str], expected: str) -> None:
    """Refuse what is neither file nor folder, and a folder that holds such a thing.

    Args:
        path: to be read.
        expected: for the words of the refusal.

    Raises:
        DataError: reading it might never end.
    """
    where = Path(path)
    try:
        entries = [where, *(where.iterdir() if where.is_dir() else ())]
    except OSError:
        entries = [where]
    for entry in entries:
        if kind := kind_of(entry):
            raise DataError(f"{entry} is {kind}; expected {expected}: copy what it holds into a file")

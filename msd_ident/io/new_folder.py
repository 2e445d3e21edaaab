"""Makes the folder of a new bag; removes nothing but a bag that the user allows to overwrite."""

from __future__ import annotations

import math
import shutil
from datetime import datetime
from itertools import chain, count
from pathlib import Path

from msd_ident.errors import UsageError
from msd_ident.io.crash_safe_file import PART, copies_of, is_being_written
from msd_ident.io.metadata import BagEntry
from msd_ident.writing import writing_to

#: Smaller files than this are nothing but their index.
_LEAST_BYTES = 10_000


def make_folder(folder: Path, overwrite: bool) -> None:
    """Make an empty folder for a bag.

    An empty folder is taken as it is. If two processes ask for the same new name at once, one of them gets it.

    Args:
        folder: the folder; its parents are made too.
        overwrite: remove the folder first if it is a bag. Nothing but a bag is ever removed.

    Raises:
        UsageError: the folder exists and may not be replaced.
        SetupError: the folder cannot be made.
    """
    with writing_to(folder, doing="make"):
        if is_empty(folder):
            return
        if folder.exists() or folder.is_symlink():
            _clear(folder, overwrite)
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            raise UsageError(f"{folder} exists; expected a new name: nothing is overwritten") from None


def dated_folder(parent: Path, prefix: str) -> Path:
    """A new folder named by date and time; one that is made here, so that nobody else has it.

    Two that ask within a second, and two rigs that share the parent, get names that differ.

    Raises:
        SetupError: the disk does not take it.
    """
    stem = f"{prefix}_{datetime.now():%Y_%m_%d-%H_%M_%S}"
    for name in chain([stem], (f"{stem}_{number}" for number in count(2))):
        folder = parent / name
        with writing_to(folder, doing="make"):
            parent.mkdir(parents=True, exist_ok=True)
            try:
                folder.mkdir()
            except FileExistsError:
                continue
        return folder
    raise AssertionError("unreachable")


def is_empty(folder: Path) -> bool:
    """Whether it is a folder, no link, with nothing in it."""
    return folder.is_dir() and not folder.is_symlink() and not any(folder.iterdir())


def check_limits(sync_seconds: float, split_bytes: int, split_seconds: float) -> None:
    """Check the limits of a bag writer.

    Args:
        sync_seconds: time between flushes [s], at least 0.
        split_bytes: size at which a file ends.
        split_seconds: length at which a file ends [s]; 0 for no limit.

    Raises:
        UsageError: one of them is out of range.
    """
    if not 0.0 <= sync_seconds < math.inf:
        raise UsageError(f"the time between syncs is {sync_seconds} s; expected 0 or more")
    if split_bytes < _LEAST_BYTES:
        raise UsageError(f"the size of a file is {split_bytes} bytes; expected at least {_LEAST_BYTES}")
    if not 0.0 <= split_seconds < math.inf:
        raise UsageError(f"the length of a file is {split_seconds} s; expected 0 (for no limit) or more")


def next_file(entry: BagEntry, folder: Path) -> str:
    """Name of the bag's next file, which does not exist yet.

    Args:
        entry: the bag, with the files that it has.
        folder: of the bag.
    """
    number = len(entry.files)
    while True:
        path = folder / f"{folder.resolve().name}_{number}.mcap"
        if not path.exists() and not copies_of(path):
            return path.name
        number += 1


def _clear(folder: Path, overwrite: bool) -> None:
    if not folder.is_dir():
        raise UsageError(f"{folder} is a file; expected a new folder for the bag: give another name")
    content = list(folder.iterdir())
    if not content:
        return
    is_bag = all(path.name.endswith((".mcap", "metadata.yaml", PART)) for path in content)
    if not is_bag:
        raise UsageError(f"{folder} exists and is no bag; expected a new folder for the bag: give another name")
    if not overwrite:
        raise UsageError(f"{folder} exists; expected a new name: give another one, or --overwrite to replace it")
    if any(is_being_written(path) for path in content):
        raise UsageError(f"{folder} is being recorded; expected a bag that is complete: stop the recorder first")
    shutil.rmtree(folder)

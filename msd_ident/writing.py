"""Write to a file, or make a folder; errors of the disk become one line."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from msd_ident.errors import SetupError


def write_text(text: str, path: Path) -> None:
    """Write text as UTF-8. What stands there stays as it is until all of the text is on the disk.

    Raises:
        SetupError: the disk does not take it.
    """
    with writing_to(path, "a writable file"):
        if path.exists() and not path.is_file():  # a device, a pipe
            path.write_text(text, encoding="utf-8", newline="\n")
            return
        target = path.resolve()  # of a link, the file it names
        part = target.with_name(f".{target.name}.{os.getpid()}.part")
        try:
            part.write_text(text, encoding="utf-8", newline="\n")
            if target.exists():
                shutil.copymode(target, part)
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)


@contextmanager
def writing_to(path: Path, expected: str = "a writable place", doing: str = "write") -> Iterator[None]:
    """Where a file is written, or a folder is made.

    Args:
        path: of the file or folder, for the words of the refusal.
        expected: what it should be, for the same.
        doing: what the disk does not take, for the same.

    Raises:
        SetupError: the disk does not take it.
    """
    try:
        yield
    except OSError as error:
        raise SetupError(f"cannot {doing} {path}: {error.strerror or error}; expected {expected}") from None

"""Write to a file, or make a folder; errors of the disk become one line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from msd_ident.errors import SetupError


def write_text(text: str, path: Path) -> None:
    """Write text as UTF-8, over what may stand there.

    Raises:
        SetupError: the disk does not take it.
    """
    with writing_to(path, "a writable file"):
        path.write_text(text, encoding="utf-8")


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

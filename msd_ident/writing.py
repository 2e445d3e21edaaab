"""Write to a file, or make a folder; errors of the disk become one line."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from msd_ident.errors import SetupError


def readable(text: str) -> str:
    """Text that can be written as UTF-8: a byte of a file's name that is none becomes an escape of JSON."""
    return text.encode(errors="backslashreplace").decode()


def write_text(text: str, path: Path) -> None:
    """Write text as UTF-8, as ``readable`` shows it. What stands there stays as it is until all text is on the disk.

    Raises:
        SetupError: the disk does not take it.
    """
    write_files({path: readable(text).encode()}, "a writable file")


def write_files(contents: Mapping[Path, bytes], expected: str = "a writable place") -> None:
    """Write files. What stands there stays as it is until all of them are on the disk; only devices and pipes are
    written at once.

    Args:
        contents: of each file.
        expected: what a file should be, for the words of the refusal.

    Raises:
        SetupError: the disk does not take one of them.
    """
    parts: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            with writing_to(path, expected):
                if path.exists() and not path.is_file():  # a device, a pipe
                    path.write_bytes(content)
                    continue
                target = path.resolve()  # of a link, the file it names
                parts[target] = target.with_name(f".{target.name}.{os.getpid()}.part")
                parts[target].write_bytes(content)
                if target.exists():
                    shutil.copymode(target, parts[target])
        for target, part in parts.items():
            with writing_to(target, expected):
                part.replace(target)
    finally:
        for part in parts.values():
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

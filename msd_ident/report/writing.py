"""Write text to a file; errors of the disk become one line."""

from __future__ import annotations

from pathlib import Path

from msd_ident.errors import SetupError


def write_text(text: str, path: Path) -> None:
    """Write text as UTF-8, over what may stand there.

    Raises:
        SetupError: the disk does not take it.
    """
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise SetupError(f"cannot write {path}: {error.strerror}; expected a writable file") from None

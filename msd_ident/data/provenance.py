"""Where a result comes from, and how to reproduce it: files with their hashes, signals, versions, command."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from msd_ident import seeds
from msd_ident.errors import DataError

#: Packages whose version can move a digit of a result.
PACKAGES = ("msd_ident", "numpy", "scipy", "numba")


@dataclass(frozen=True)
class Origin:
    """One source of data.

    Attributes:
        path: as given; ``live`` for a buffer.
        kind: what it is, for people.
        size: bytes of all its files.
        sha256: of its content; that of a folder is over its files in the order of their names.
        position, force: topic and field, or column, that was read.
    """

    path: str
    kind: str
    size: int
    sha256: str
    position: str
    force: str


@dataclass(frozen=True)
class Provenance:
    """How a result was made.

    Attributes:
        command: the line that makes it again, from the same folder.
        made: when, ISO 8601 in UTC.
        origins: what was read.
        versions: by package; ``python`` too.
        seeds: of all random numbers, by what they are drawn for.
    """

    command: str
    made: str
    origins: tuple[Origin, ...]
    versions: Mapping[str, str]
    seeds: Mapping[str, int] = field(default_factory=lambda: dict(seeds.ALL))

    @property
    def drawn(self) -> str:
        """The seeds in words."""
        return "seeds " + ", ".join(f"{seed} ({what})" for what, seed in self.seeds.items())

    def to_json_dict(self) -> dict[str, Any]:
        """Plain words and numbers."""
        return {**asdict(self), "versions": dict(self.versions), "seeds": dict(self.seeds)}


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that compute."""
    return {"python": platform.python_version(), **{name: _version(name) for name in PACKAGES}}


@cache
def _version(package: str) -> str:
    """Of an installed package: all that it says of itself is read for that, once."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def fingerprint(path: Path) -> tuple[int, str]:
    """Size in bytes and SHA-256 of a file, or of all files of a folder: name and content, in the order of the names.

    Raises:
        DataError: it cannot be read.
    """
    digest, size = hashlib.sha256(), 0
    folder = path.is_dir()
    try:
        for file in sorted(p for p in path.rglob("*") if p.is_file()) if folder else [path]:
            if folder:
                digest.update(os.fsencode(file.relative_to(path)) + b"\0")
            with file.open("rb") as handle:
                while block := handle.read(1 << 20):
                    size += len(block)
                    digest.update(block)
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}; expected a file that may be read") from None
    return size, digest.hexdigest()

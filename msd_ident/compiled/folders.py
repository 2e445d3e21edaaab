"""Where machine code is kept between runs."""

from __future__ import annotations

import contextlib
import hashlib
import os
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from importlib import metadata
from pathlib import Path

import llvmlite.binding as llvm

from msd_ident.compiled.function import Library

#: Older builds of a library that are kept beside the present one.
KEPT = 3


def fingerprint(library: Library) -> str:
    """Hash of all that the machine code is made from: sources, numba, Python, and the processor's instructions."""
    digest = hashlib.sha256(_machine().encode())
    for path in library.files():
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def _machine() -> str:
    versions = " ".join(metadata.version(package) for package in ("numba", "llvmlite", "numpy"))
    return f"{versions} {sys.version} {llvm.get_host_cpu_name()} {llvm.get_host_cpu_features().flatten()}"


def _roots() -> Iterator[Path]:
    """Folders to try, the best first."""
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA" if sys.platform == "win32" else ""):
        if given := os.environ.get(name):
            yield Path(given)
    with contextlib.suppress(RuntimeError):
        yield Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")
    yield Path(tempfile.gettempdir()) / f"msd_ident-{getattr(os, 'getuid', lambda: 'user')()}"


def folder() -> Path:
    """The folder of all builds, made if need be: the first that can be written."""
    return _writable(tuple(_roots()))


@cache
def _writable(roots: tuple[Path, ...]) -> Path:
    for root in roots:
        path = root / "msd_ident" / "compiled"
        with contextlib.suppress(OSError):
            path.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=path):
                return path
    return Path(tempfile.mkdtemp(prefix="msd_ident-compiled-"))


def object_file(library: Library) -> Path:
    """File of the machine code of a library as it is now."""
    return folder() / f"{library.declared_in}-{fingerprint(library)}.o"


def keep(library: Library, code: bytes) -> None:
    """Write machine code, at once as a whole, and drop all but the newest few older builds of the library."""
    path = object_file(library)
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    with os.fdopen(handle, "wb") as file:
        file.write(code)
    os.replace(temporary, path)
    others = [other for other in path.parent.glob(f"{library.declared_in}-*.o") if other != path]
    others.sort(key=lambda other: other.stat().st_mtime, reverse=True)
    for old in others[KEPT:]:
        old.unlink(missing_ok=True)

"""Machine code from disk into this process."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from msd_ident.compiled import folders
from msd_ident.compiled.function import Library, Native

_PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_char_p)
_APART = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from msd_ident.compiled.loading import build_here
sys.exit(build_here(sys.argv[2:]))
"""
#: How a process ends that somebody stopped.
_STOPPED = (-signal.SIGINT, -signal.SIGTERM, -9)


def natives(library: Library, say: Callable[[str], None]) -> Mapping[str, Native]:
    """The functions of a library by name; compiled first, and kept, where no build of them is at hand.

    Where machine code cannot be made or linked, numba compiles the functions in this process, and keeps them itself.
    """
    path = folders.object_file(library)
    if not path.exists():
        missing = [one for one in Library.known if not folders.object_file(one).exists()]
        for line in filter(None, (one.announced for one in missing)):
            say(line)
        _build_apart(missing)
    if code := path.read_bytes() if path.exists() else b"":
        with contextlib.suppress(RuntimeError):
            return linked(library, code)
    from msd_ident.compiled import build

    return {name: _PROTOTYPE(address) for name, address in build.addresses(library).items()}


def linked(library: Library, code: bytes) -> Mapping[str, Native]:
    """The functions in object code.

    Raises:
        RuntimeError: it asks for something that is not there.
    """
    builder = llvm.JITLibraryBuilder().add_object_img(code).add_current_process()
    for name in library.functions:
        builder.export_symbol(name)
    tracker = builder.link(_compiler(), f"{library.declared_in} {len(_KEPT)}")
    _KEPT.append(tracker)
    return {name: _PROTOTYPE(tracker[name]) for name in library.functions}


#: Code that is unloaded with these.
_KEPT: list[Any] = []


@cache
def _compiler() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.create_lljit_compiler()


def build_here(declaring: list[str]) -> int:
    """Compile the libraries that these modules declare, in this process, and keep them.

    Returns:
        How many cannot be made.
    """
    from msd_ident.compiled import build

    failed = 0
    for name in declaring:
        library = importlib.import_module(name).LIBRARY
        try:
            code = build.object_code(library)
            linked(library, code)
        except Exception:  # whatever a version of numba or of llvmlite raises
            code, failed = b"", failed + 1
        folders.keep(library, code)
    return failed


def _build_apart(libraries: list[Library]) -> None:
    """Compile libraries in a process of its own; without one, nothing is made.

    What brings it down is not tried again: an empty file says so.
    """
    command = [sys.executable or "", "-c", _APART, json.dumps(sys.path), *(one.declared_in for one in libraries)]
    quiet = subprocess.DEVNULL
    try:
        ended = subprocess.run(command, check=False, stdin=quiet, stdout=quiet, stderr=quiet).returncode
    except OSError:
        return
    if ended and ended not in _STOPPED:
        for library in libraries:
            if not folders.object_file(library).exists():
                folders.keep(library, b"")

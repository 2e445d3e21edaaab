"""Machine code from disk into this process."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from msd_ident.compiled import folders
from msd_ident.compiled.function import Library

Native = Callable[[bytes], int]

_PROTOTYPE = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_char_p)
_APART = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from msd_ident.compiled.loading import build_here
build_here(sys.argv[2:])
"""


def natives(library: Library, say: Callable[[str], None]) -> Mapping[str, Native]:
    """The functions of a library by name; compiled first, and kept, where no build of them is at hand.

    Where machine code cannot be linked, or there can be no process to make it, numba compiles it in this one.
    """
    path = folders.object_file(library)
    if not path.exists():
        missing = [one for one in Library.known if not folders.object_file(one).exists()]
        for line in filter(None, (one.announced for one in missing)):
            say(line)
        _build_apart(missing)
    if path.exists():
        with contextlib.suppress(RuntimeError, OSError):
            return linked(library, path.read_bytes())
    from msd_ident.compiled import build

    return {name: _PROTOTYPE(address) for name, address in build.addresses(library).items()}


def linked(library: Library, code: bytes) -> dict[str, Native]:
    """The functions in object code.

    Raises:
        RuntimeError: it cannot be linked.
    """
    builder = llvm.JITLibraryBuilder().add_object_img(code).add_current_process()
    for name in library.functions:
        builder.export_symbol(name)
    tracker = builder.link(_compiler(), library.declared_in)
    found = {name: _PROTOTYPE(tracker[name]) for name in library.functions}
    _KEPT.append(tracker)
    return found


#: Code that is unloaded with these.
_KEPT: list[Any] = []


@cache
def _compiler() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.create_lljit_compiler()


def build_here(declaring: list[str]) -> None:
    """Compile the libraries that these modules declare, in this process, and keep them."""
    from msd_ident.compiled import build

    for name in declaring:
        library = importlib.import_module(name).LIBRARY
        code = build.object_code(library)
        linked(library, code)
        folders.keep(library, code)


def _build_apart(libraries: list[Library]) -> None:
    """Compile libraries in a process of its own; without one, nothing is made."""
    with contextlib.suppress(OSError):
        subprocess.run(
            [sys.executable or "", "-c", _APART, json.dumps(sys.path), *(one.declared_in for one in libraries)],
            check=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

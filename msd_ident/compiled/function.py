"""Compiled functions as Python sees them.

A function gets one pointer, to 8-byte words: its numbers as they are, and of each array the address and the shape. So
its machine code needs nothing of numba, whose import takes half a second, as long as a short command itself.
"""

from __future__ import annotations

import importlib
import os
import struct
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

#: What an argument is: ``f8``, ``i8`` or ``b1`` for a number, with ``[:]`` or ``[:,:]`` for an array (``i1`` too); or
#: a tuple of kinds, the first of which may be the class of a named tuple.
Kind = Any
#: Machine code: it takes words, and gives 1 when it came to its end.
Native = Callable[[bytes], int]

#: Where numba is not to compile, the functions run as they are written.
_AS_WRITTEN = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")

#: Format in ``struct`` of a number.
_FORMATS = {"f8": "d", "i8": "q", "b1": "q"}


class Prepared(NamedTuple):
    """An argument that is already in words, for one that goes into many calls; ``kept`` owns the memory."""

    words: tuple[Any, ...]
    kept: Any


@dataclass(frozen=True, eq=False)
class Library:
    """The compiled functions that one module declares.

    Attributes:
        declared_in: the module, which holds this as ``LIBRARY``.
        written_in: module with the functions themselves; it is imported only to compile them.
        sources: files and folders, from the package on, beside that module and the declaring one, on which the machine
            code depends.
        announced: what the user is told when it must be compiled; nothing for what takes a few seconds.
        functions: by name.
    """

    declared_in: str
    written_in: str
    sources: tuple[str, ...] = ()
    announced: str = ""
    functions: dict[str, Function] = field(default_factory=dict)
    #: All that this process has imported.
    known: ClassVar[list[Library]] = []

    def __post_init__(self) -> None:
        self.known.append(self)

    def function(self, name: str, *kinds: Kind) -> Function:
        """Declare a function, which returns nothing: what it finds, it fills in."""
        self.functions[name] = Function(self, name, kinds)
        return self.functions[name]

    def files(self) -> list[Path]:
        """All files that the machine code is made from."""
        package = Path(__file__).resolve().parents[1]
        modules = (name.split(".")[1:] for name in (self.declared_in, self.written_in))
        given = [package.joinpath(*parts).with_suffix(".py") for parts in modules]
        given += [package / name for name in (*self.sources, "compiled")]
        return sorted({file for path in given for file in (path.glob("*.py") if path.is_dir() else [path])})

    def load(self, say: Callable[[str], None] | None = None) -> None:
        """Load the machine code, or compile it; ``say``, or stderr, is told in one line if that takes long."""
        if _AS_WRITTEN:
            return
        from msd_ident.compiled import loading

        with _LOADING:
            if not all(function.loaded for function in self.functions.values()):
                for name, native in loading.natives(self, say or _to_stderr).items():
                    self.functions[name].native = native


_LOADING = threading.RLock()


class Function:
    """A compiled function, loaded when it is first called.

    Calls are thread-safe and release the GIL. Arrays must have the declared type and be contiguous.
    """

    def __init__(self, library: Library, name: str, kinds: Sequence[Kind]) -> None:
        self.library = library
        self.name = name
        self.kinds = tuple(kinds)
        self.native: Native | None = None
        self._pack = struct.Struct("".join(map(_format, self.kinds))).pack

    @property
    def loaded(self) -> bool:
        """Whether its machine code is at hand."""
        return self.native is not None

    def __call__(self, *arguments: Any) -> None:
        """Call it.

        Raises:
            TypeError: an argument is not of its kind.
            MemoryError: there was not room enough.
        """
        if _AS_WRITTEN:
            written = getattr(importlib.import_module(self.library.written_in), self.name)
            written(*(one.kept if type(one) is Prepared else one for one in arguments))
            return
        if self.native is None:
            self.library.load()
        assert self.native is not None
        words: list[Any] = []
        for kind, argument in zip(self.kinds, arguments, strict=True):
            _append(kind, argument, words)
        if self.native(self._pack(*words)) != 1:
            raise MemoryError(f"{self.name} did not come to its end: there was not room enough for its arrays")

    def prepared(self, place: int, argument: Any) -> Prepared:
        """The argument at this place in words."""
        words: list[Any] = []
        _append(self.kinds[place], argument, words)
        return Prepared(tuple(words), argument)


def parts(kind: Kind) -> tuple[Any, Sequence[Kind]]:
    """Class of a tuple's kind, ``None`` for a plain tuple, and the kinds in it."""
    return (None, kind) if not isinstance(kind[0], type) else (kind[0], kind[1:])


def dimensions(kind: str) -> int:
    """How many an array has; 0 for a number."""
    return kind.count(":")


def _format(kind: Kind) -> str:
    if not isinstance(kind, str):
        return "".join(map(_format, parts(kind)[1]))
    return "q" * (1 + dimensions(kind)) if dimensions(kind) else _FORMATS[kind]


def _append(kind: Kind, value: Any, words: list[Any]) -> None:
    """Add the words of one argument."""
    if type(value) is Prepared:
        words.extend(value.words)
    elif not isinstance(kind, str):
        for inner, part in zip(parts(kind)[1], value, strict=True):
            _append(inner, part, words)
    elif kind in _FORMATS:
        words.append(value)
    else:
        wanted, axes = _ARRAYS[kind]
        if value.dtype != wanted or value.ndim != axes or not value.flags.c_contiguous:
            raise TypeError(f"an array {value.dtype} of shape {value.shape} in place of a contiguous {kind}")
        words.append(value.__array_interface__["data"][0])
        words.extend(value.shape)


_ARRAYS = {f"{name}[{axes}]": (np.dtype(name), axes.count(":")) for name in ("f8", "i8", "i1") for axes in (":", ":,:")}


def _to_stderr(line: str) -> None:
    print(line, file=sys.stderr, flush=True)

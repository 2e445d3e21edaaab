"""Functions into machine code, by numba.

Each function gets an entry that takes its arguments out of the words that ``function`` packs, e.g.

    def filtered(words):
        _filtered((f8_1(words[0], words[1]), ...), number(words[6]), ...)
        return 1

numba's ``cfunc`` compiles it to code that asks nothing of Python unless it fails: then the entry returns 0, and
``Function`` raises.
"""

# Numba's functions have no types.
# mypy: allow-untyped-defs, allow-untyped-calls, disable-error-code="untyped-decorator, attr-defined, call-arg"

from __future__ import annotations

import gc
import importlib.util
import itertools
import sys
from collections.abc import Iterator, Mapping
from types import ModuleType
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic

from msd_ident.compiled import folders, runtime
from msd_ident.compiled.function import Kind, Library, dimensions, parts

#: Of an entry; see ``Function``.
ENTRY = types.int64(types.CPointer(types.int64))


def _array(element: types.Type, axes: int) -> Any:
    """A function that makes an address and a shape an array."""

    @intrinsic
    def pointer(typing_context, address):
        """The pointer that an address is."""
        del typing_context, address

        def code(context, builder, signature, arguments):
            return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

        return types.CPointer(element)(types.int64), code

    if axes == 1:
        return njit(lambda address, size: carray(pointer(address), (size,)))
    return njit(lambda address, rows, columns: carray(pointer(address), (rows, columns)))


f8_1, f8_2 = _array(types.float64, 1), _array(types.float64, 2)
i8_1, i8_2 = _array(types.int64, 1), _array(types.int64, 2)
i1_1, i1_2 = _array(types.int8, 1), _array(types.int8, 2)


@intrinsic
def number(typing_context, word):
    """The float64 that a word is."""
    del typing_context, word

    def code(context, builder, signature, arguments):
        del context, signature
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), code


def source(library: Library, cached: bool) -> str:
    """Source of a module with the entries of a library."""
    lines = [
        '"""Entries of compiled functions of msd_ident; written by it, safe to delete."""',
        "from numba import cfunc",
        "from msd_ident.compiled.build import *",
        f"import {library.written_in} as written",
    ]
    for function in library.functions.values():
        words = itertools.count()
        arguments = ", ".join(_taken(kind, words) for kind in function.kinds)
        lines += [
            f'@cfunc(ENTRY, nopython=True, error_model="numpy", cache={cached})',
            f"def {function.name}(words):",
            f"    _{function.name}({arguments})",
            "    return 1",
        ]
        lines.insert(4, f"_{function.name} = written.{function.name}")
        lines[4:4] = [f"{name} = written.{name}" for name in sorted(_classes(function.kinds))]
    return "\n".join(lines) + "\n"


def _taken(kind: Kind, words: Iterator[int]) -> str:
    """An argument, out of the next words."""
    if not isinstance(kind, str):
        made, inner = parts(kind)
        return f"{made.__name__ if made else ''}({''.join(_taken(one, words) + ', ' for one in inner)})"
    if axes := dimensions(kind):
        return f"{kind[:2]}_{axes}({', '.join(f'words[{next(words)}]' for _ in range(1 + axes))})"
    word = f"words[{next(words)}]"
    return {"f8": f"number({word})", "i8": word, "b1": f"{word} != 0"}[kind]


def _classes(kinds: Any) -> set[str]:
    """Names of the named tuples in kinds."""
    found = set()
    for kind in kinds:
        if not isinstance(kind, str):
            made, inner = parts(kind)
            found |= _classes(inner) | ({made.__name__} if made else set())
    return found


def object_code(library: Library) -> bytes:
    """Object code in which each function has its own name.

    The collector of garbage rests meanwhile: it would look through the compiler's millions of objects again and again,
    a tenth of the time, and find little.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        whole, entries = runtime.memory(), dict[str, Any]()
        exec(compile(source(library, cached=False), f"<entries of {library.declared_in}>", "exec"), entries)
        for name in library.functions:
            part = llvm.parse_assembly(entries[name].inspect_llvm())
            part.get_function(entries[name].native_name).name = name
            whole.link_in(part)
        return runtime.self_contained(whole)
    finally:
        if collecting:
            gc.enable()


def addresses(library: Library) -> Mapping[str, int]:
    """The functions' addresses in this process, where numba compiles them or loads them from its own cache."""
    path = folders.object_file(library).with_suffix(".py")
    entry = source(library, cached=True)
    if not path.exists() or path.read_text() != entry:  # numba compiles anew what is newer than its cache
        path.write_text(entry)
    entries = _imported(path.stem.replace(".", "_").replace("-", "_"), str(path))
    return {name: getattr(entries, name).address for name in library.functions}


def _imported(name: str, path: str) -> ModuleType:
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None and spec.loader is not None
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


__all__ = ["ENTRY", "cfunc", "f8_1", "f8_2", "i1_1", "i1_2", "i8_1", "i8_2", "number"]

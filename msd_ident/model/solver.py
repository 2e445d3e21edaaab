"""The compiled solver as Python calls it, see ``model.kernel``."""

from __future__ import annotations

from typing import Any

import numpy as np

from msd_ident.compiled import Library, Prepared
from msd_ident.data.record import Record

LIBRARY = Library(
    __name__,
    "msd_ident.model.kernel.entries",
    sources=("model/effects", "model/kernel", "model/plant.py"),
    announced="msd: compiling the solver, once (about half a minute); later runs start at once",
)

_REAL, _WHOLE, _SMALL = "f8[:]", "i8[:]", "i1[:]"
_PARTS = (_REAL, _REAL, _SMALL, _WHOLE, _WHOLE, _REAL, _REAL, _REAL)

#: See ``kernel.entries.plan``.
_GIVEN = (_REAL, _REAL, _REAL, "b1")
_plan = LIBRARY.function("plan", _GIVEN, _PARTS, _WHOLE, _REAL)
#: See ``kernel.entries.run``; model, rows, plan, measured, out.
run = LIBRARY.function(
    "run", ("i8", _WHOLE), "f8[:,:]", (*_GIVEN, *_PARTS, "f8"), (_REAL, _REAL, "f8", "f8", "f8"), ("f8[:,:]", "f8[:,:]")
)


def plan(record: Record) -> Any:
    """What the record says before any parameter is known, for ``run``; made once for each record."""

    def made() -> Prepared:
        """The plan in the form in which ``run`` takes it."""
        seen = record.from_origin()
        given = (seen.time, seen.force_time, seen.force, seen.hold == "linear")
        most = seen.time.size + seen.force_time.size
        types = {_REAL: np.float64, _WHOLE: np.int64, _SMALL: np.int8}
        room = tuple(np.empty(most, types[kind]) for kind in _PARTS)
        sizes, largest = np.empty(len(room), np.int64), np.empty(1)
        _plan(given, room, sizes, largest)
        parts = (part[:size].copy() for part, size in zip(room, sizes, strict=True))
        return run.prepared(2, (*given, *parts, float(largest[0])))

    return record.kept("plan", made)

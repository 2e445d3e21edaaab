"""Several runs side by side in one table: headings that end in ``Run #1``, ``Run #2`` …"""

from __future__ import annotations

import re
from collections.abc import Sequence

from msd_ident.data.record import FloatArray
from msd_ident.errors import DataError
from msd_ident.io.columns import Columns

#: Value of ``SourceOptions.run`` for all of them, each a record.
ALL = "all"

_ENDING = re.compile(r"^(.*?)[\s,;:_-]*\b(?:run|trial)\s*(?:#|no\.?\s*)?\s*(\d+)\s*$", re.IGNORECASE)


def split(heading: str) -> tuple[str, str]:
    """Heading without its run, and the run's number; an empty one where it names none."""
    found = _ENDING.match(heading)
    return (found.group(1).strip(), found.group(2)) if found and found.group(1).strip() else (heading, "")


def numbers(header: Sequence[str]) -> tuple[str, ...]:
    """Numbers of the runs in a header, in order."""
    return tuple(dict.fromkeys(run for _, run in map(split, header) if run))


class Run:
    """One run of a table: its columns, and those that belong to all runs."""

    def __init__(self, table: Columns, run: str) -> None:
        self._table = table
        parts = [split(heading) for heading in table.header]
        self._places = [place for place, (_, number) in enumerate(parts) if number in ("", run)]
        self.header = tuple(parts[place][0] for place in self._places)

    @property
    def kind(self) -> str:
        """Of the table."""
        return self._table.kind

    @property
    def lines(self) -> int:
        """Of the table."""
        return self._table.lines

    @property
    def notes(self) -> tuple[str, ...]:
        """Of the table."""
        return self._table.notes

    def columns(self, indices: Sequence[int]) -> tuple[FloatArray, ...]:
        """The run's columns of these places."""
        return self._table.columns([self._places[index] for index in indices])


def select(table: Columns, run: str, name: str) -> Columns:
    """The wanted run of a table, or the table itself if it has no runs.

    Args:
        table: the file's columns.
        run: number of the run as text; empty or ``all`` to take the only one.
        name: of the file, for error messages.

    Raises:
        DataError: there are several runs and none is named, or the run is not there.
    """
    known = numbers(table.header)
    if run in known:
        return Run(table, run)
    if run == ALL or not run:
        if len(known) < 2:
            return Run(table, known[0]) if known else table
        if run == ALL:
            return Run(table, known[0])
        raise DataError(
            f"{name} has {len(known)} runs side by side ({_listed(known)}); expected one at a time: say which with "
            f"--run {known[0]}, or --run all"
        )
    have = f"has the runs {_listed(known)}" if known else "has no runs side by side"
    advice = f"say --run {known[0]}, or --run all" if known else "leave --run away"
    raise DataError(f"{name} {have}; expected a run {run}, which is not there: {advice}")


def _listed(known: Sequence[str]) -> str:
    return ", ".join(known) if len(known) < 7 else f"{known[0]} to {known[-1]}"

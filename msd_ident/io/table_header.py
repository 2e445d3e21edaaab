"""Which lines of a table of text are its header, and which are numbers."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.io import date_times, units
from msd_ident.io.cells import cells_of, is_missing, is_number, joined, separator_of
from msd_ident.io.columns import TIME_NAMES

#: What a line that is no part of the table begins with.
COMMENTS = ("#", "%", "//")


def holds_numbers(line: str, header: str, rest: str) -> bool:
    """Whether a line belongs to the numbers.

    It begins with one, or has one and as many cells as the header above, which are names. A number alone is a column
    where the rest has one cell a line too; several above such a column are settings, and so are names with a value.
    A line below a header may have words for missing numbers alone. Lines without one may begin with a date or a time.

    Args:
        line: of text, neither empty nor a comment.
        header: the last line of text above it, empty for none.
        rest: some text below it.
    """
    cells, below, names = cells_of(line), contents(rest), cells_of(header)
    found = [is_number(cell) for cell in cells if cell]
    single = [cells_of(one) for one in below]
    if len(cells) == 1:
        word = bool(header) and is_missing(cells[0])
        return (any(found) or word) and all(len(one) == 1 for one in single)
    if len(single) > 1 and all(len(one) == 1 and is_number(one[0]) for one in single):
        return False
    if len(cells) == len(names) and not any(map(is_number, names)):
        return any(found) or all(map(is_missing, cells))
    timed = any(found) and bool(below) and all(date_times.is_time(one[0]) for one in (cells, single[0]))
    return timed or (bool(found) and found[0])


def contents(text: str) -> list[str]:
    """Lines of a text that are neither empty nor comments."""
    return [line for line in text.split("\n") if line.strip() and not line.lstrip().startswith(COMMENTS)]


def is_one_column(header: str, first: str) -> bool:
    """Whether the numbers that begin with the line ``first`` are one column; a comma may be its decimal mark."""
    return len(cells_of(first)) == 1 or (bool(header) and len(heading_cells(header)) == 1 and is_number(first))


def heading_cells(header: str) -> tuple[str, ...]:
    """Cells of a header, in which white space is part of a name."""
    return cells_of(header) if separator_of(header) is not None else (header.strip().strip('"'),)


def with_units(texts: Sequence[str]) -> str:
    """The header, which may stand in two lines: the names, and below them a unit for each.

    Where the second line has the unit of the time below its name, it may have names of the other columns, as recorders
    do whose channels (``Analog 1``) are chosen: these are taken, as they say more.

    Args:
        texts: the lines of text above the numbers, one at least.
    """
    last, above = cells_of(texts[-1]), cells_of(texts[-2]) if len(texts) > 1 else ()
    if len(above) != len(last):
        return texts[-1]
    pairs = list(zip(above, last, strict=True))
    timed = any(name.lower() in TIME_NAMES and units.is_time(cell) for name, cell in pairs)
    if not timed and not all(units.is_unit(cell) for cell in last):
        return texts[-1]
    return joined([_with_unit(name, cell) for name, cell in pairs], separator_of(texts[-1]) or "\t")


def _with_unit(name: str, below: str) -> str:
    """Name of a column from its cells in two lines."""
    if not units.is_unit(below):
        return below
    return f"{name} ({below.strip('()[]')})" if below else name

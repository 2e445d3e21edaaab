"""Cells of a line of text: separators, quotes and numbers."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence

from msd_ident.io.number_marks import is_marked_number

_SEPARATORS = (";", "\t", ",")
#: What programs write for a missing number: pandas, R, C, Python, JavaScript, spreadsheets.
_MISSING = re.compile(r"[-+]?nan(?:\((?:ind|snan)\))?|n/?a|null|none", re.IGNORECASE)


def separator_of(line: str) -> str | None:
    """What stands between the cells of a line, ``None`` for white space."""
    return next((mark for mark in _SEPARATORS if mark in line), None)


def cells_of(line: str) -> tuple[str, ...]:
    """Cells of a line without quotes and white space around them."""
    return tuple(cell.strip().strip('"') for cell in split(line, separator_of(line)))


def split(line: str, separator: str | None) -> list[str]:
    """Cells of a line; a separator in quotes separates none.

    Args:
        line: of text.
        separator: between the cells, ``None`` for white space.
    """
    if separator is not None and '"' in line:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    return line.split(separator)


def is_number(text: str) -> bool:
    """Whether a cell is a number, with a decimal point or comma, or with thousands separators."""
    try:
        float(text.replace(",", "."))
    except ValueError:
        return is_marked_number(text)
    return True


def is_missing(text: str) -> bool:
    """Whether a cell has a word for a missing number; it counts as an empty one."""
    return bool(_MISSING.fullmatch(text))


def joined(names: Sequence[str], separator: str) -> str:
    """A line of names, from which ``cells_of`` reads them again."""
    return separator.join(f'"{name}"' if separator in name else name for name in names)

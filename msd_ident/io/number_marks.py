"""Decimal marks and thousands separators of the numbers in a table: ``"0,01"``, ``"5,980.000"``, ``5.980,5``.

A comma in a quoted cell is a decimal comma, or separates thousands. The cells of the file decide together.
"""

from __future__ import annotations

import re

from msd_ident.errors import DataError

#: A cell that is a number in quotes: what is before it, and the number.
_QUOTED = re.compile(r'(^[ \t]*|,[ \t]*)"[ \t]*([-+]?\d[\d.,]*(?:[eE][-+]?\d+)?)[ \t]*"(?=[ \t]*(?:,|$))', re.MULTILINE)
#: Digits in groups of three with commas between them.
_GROUPS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?")
#: A decimal comma; in front of it there may be groups of three with points between them.
_DECIMAL_COMMA = re.compile(r"[-+]?(?:\d+|[1-9]\d{0,2}(?:\.\d{3})+),\d+(?:[eE][-+]?\d+)?")
#: A point that separates thousands in front of a decimal comma, and one that cannot.
_POINT_OF_GROUP, _OTHER_POINT = re.compile(r"\d\.\d{3},\d"), re.compile(r"(?<!\d)\.|\.(?!\d{3}(?!\d))")


def is_marked_number(text: str) -> bool:
    """Whether a text is a number with a decimal comma or with thousands separators."""
    return bool(_GROUPS.fullmatch(text) or _DECIMAL_COMMA.fullmatch(text))


def without_quotes(text: str, name: str) -> str:
    """Text in which each quoted number is written with a decimal point, without thousands separators and quotes.

    Args:
        text: lines of cells that are separated by commas.
        name: of the file, for the error message.

    Raises:
        DataError: the commas may be either.
    """
    marked = {cell for _, cell in _QUOTED.findall(text) if "," in cell}
    plain = with_points if marked and _has_decimal_commas(marked, name) else _without_commas
    return _QUOTED.sub(lambda found: found.group(1) + plain(found.group(2)), text)


def with_points(text: str) -> str:
    """Text with points for decimal commas; points that separate thousands are left out."""
    if _POINT_OF_GROUP.search(text) and not _OTHER_POINT.search(text):
        text = text.replace(".", "")
    return text.replace(",", ".")


def _without_commas(number: str) -> str:
    return number.replace(",", "")


def _has_decimal_commas(marked: set[str], name: str) -> bool:
    """Whether the commas in these numbers are decimal; else they separate thousands."""
    decimal = all(_DECIMAL_COMMA.fullmatch(cell) for cell in marked)
    if decimal != all(_GROUPS.fullmatch(cell) for cell in marked):
        return decimal
    raise DataError(
        f'{name} has cells like "{min(marked)}", whose comma may be decimal or separate thousands; expected one that '
        "is clear: write decimal points, and no thousands separators"
    )

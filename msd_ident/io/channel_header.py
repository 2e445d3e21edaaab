"""Headers with a line for each property of the channels, each channel with a pair of columns: its times and its values.

National Instruments' programs write them::

    Interval,0.0005,Interval,0.0005
    Channel name,"Force",Channel name,"Input 1"
    Unit,"V",Unit,"V"
    0,-0.129,0,-3.216
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from msd_ident.io.cells import is_number
from msd_ident.io.columns import TIME_NAMES

#: Keys of the lines that are used, in lower case.
_NAMES = ("channel name", "channel", "name", "signal")
_UNITS = ("unit", "units")
_INTERVALS = ("interval", "sampling interval", "sample interval", "dt", "delta t", "delta_t")


def names_of(lines: Iterable[Sequence[str]]) -> tuple[tuple[str, ...], int] | None:
    """Names of the columns in such a header, and the index of the first line of numbers.

    Args:
        lines: the cells of the first lines of a file.

    Returns:
        ``Time`` for the first channel's times where all channels share them, else ``Time of`` each channel; ``None``
        where the file begins otherwise. Names and intervals are needed: a name and a value alone may be a setting.
    """
    block: dict[str, list[str]] = {}
    first: Sequence[str] = ()
    for cells in lines:
        keys = {cell.lower().rstrip(":") for cell in cells[::2]}
        if len(cells) % 2 or len(keys) != 1 or any(map(is_number, keys)):
            first = cells
            break
        block[keys.pop()] = list(cells[1::2])
    named = next((block[key] for key in _NAMES if key in block), [])
    spaced = next((block[key] for key in _INTERVALS if key in block), [""])
    widths = {2 * len(values) for values in block.values()}
    if widths != {len(first)} or not named or not all(map(is_number, (*spaced, first[0]))):
        return None
    if list(block)[-1] in TIME_NAMES:  # the names of a table below its settings
        return None
    units = next((block[key] for key in _UNITS if key in block), [""] * len(named))
    shared = all(len(set(values)) == 1 for key, values in block.items() if key not in (*_NAMES, *_UNITS))
    header: list[str] = []
    for place, (name, unit) in enumerate(zip(named, units, strict=True)):
        time = "Time" if shared and not place else f"Time of {name}"
        header += [time, f"{name} ({unit})" if unit else name]
    return tuple(header), len(block)

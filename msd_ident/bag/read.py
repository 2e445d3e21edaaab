"""The one way from a path to a Record."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from msd_ident.bag.bag import is_bag
from msd_ident.bag.csv_file import read_csv
from msd_ident.bag.options import SourceOptions
from msd_ident.bag.reader import read_bag
from msd_ident.errors import DataError
from msd_ident.record import Record
from msd_ident.resampling import band_limited

_DEFAULTS = SourceOptions()


def read(
    path: str | os.PathLike[str], options: SourceOptions = _DEFAULTS, told: Callable[[int], None] | None = None
) -> Record:
    """Record from a rosbag2 folder, an ``.mcap`` or ``.db3`` file, or a CSV file.

    Args:
        path: what to read.
        options: which signals are force and position, scales, units, window.
        told: told, now and then, how many messages of a bag were read; what it raises ends the reading.

    Returns:
        The record; its notes say what was lost or repaired on the way.

    Raises:
        DataError: it cannot be read, lacks a signal, or holds one that cannot be used; one line that says why.
    """
    try:
        record = read_bag(path, options, told) if is_bag(path) else read_csv(path, options)
        if options.hold == "band_limited" and not options.no_force:
            record = band_limited(record)
        if options.start is not None or options.end is not None:
            record = record.window(*options.window)
    except DataError as error:
        # Who reads several paths must see which one it is about.
        named = str(error) if Path(path).name in str(error) else f"{path}: {error}"
        raise DataError(named) from None
    if record.position.min() == record.position.max():
        raise DataError(
            f"{path}: the position never changes ({record.position[0]:g} {record.position_unit} in all "
            f"{record.samples} samples); expected motion: check the encoder, or choose another --position"
        )
    return record

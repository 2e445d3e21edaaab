"""Reads a path, bag or table, into a Record, or into one for each run."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from msd_ident.data.record import Record
from msd_ident.data.resampling import band_limited, centred, is_even
from msd_ident.errors import DataError, UsageError
from msd_ident.io import runs
from msd_ident.io.bag import is_bag
from msd_ident.io.columns import open_columns
from msd_ident.io.csv_file import read_table
from msd_ident.io.reader import read_bag
from msd_ident.io.source_options import SourceOptions

_DEFAULTS = SourceOptions()


def read(
    path: str | os.PathLike[str], options: SourceOptions = _DEFAULTS, on_progress: Callable[[int], None] | None = None
) -> Record:
    """Record from a rosbag2 folder, an ``.mcap`` or ``.db3`` file, a CSV or a MAT file.

    Args:
        path: what to read.
        options: which signals are force and position, scales, units, window.
        on_progress: called with the number of messages of a bag read so far; an exception from it ends the reading.

    Returns:
        The record; its notes say what was lost or repaired on the way.

    Raises:
        DataError: it cannot be read, lacks a signal, or holds one that cannot be used; one line that says why.
    """
    try:
        record = _read_bag(path, options, on_progress) if is_bag(path) else read_table(path, options)
        interpolate = options.hold == "band_limited" and not options.no_force
        if interpolate and is_even(record.force_time):  # of the whole: the force beyond a window tells its ends
            record, interpolate = band_limited(record), False
        if options.start is not None or options.end is not None:
            record = record.cut(*options.window)
        if interpolate:
            record = band_limited(record)
        if options.hold == "centred" and not options.no_force:
            record = centred(record)
    except DataError as error:
        # Who reads several paths must see which one it is about.
        named = str(error) if Path(path).name in str(error) else f"{path}: {error}"
        raise DataError(named) from None
    if record.position.min() == record.position.max():
        reading = f"{record.position[0]:g} {record.position_unit} in all {record.samples} samples"
        raise DataError(
            f"{path}: it stands still, the position never changes ({reading}); expected motion: check the encoder, or "
            "choose another --position"
        )
    return record


def each_run(path: str | os.PathLike[str], options: SourceOptions) -> tuple[SourceOptions, ...]:
    """Options for one record each.

    Args:
        path: bag or table.
        options: with ``run`` ``all``, there is one result for each run of the table; else they are returned as they
            are.

    Raises:
        DataError: the file cannot be read.
    """
    if options.run != runs.ALL or is_bag(path):
        return (options,)
    found = runs.numbers(open_columns(Path(path)).header)
    return tuple(replace(options, run=run) for run in found) or (replace(options, run=""),)


def read_all(path: str | os.PathLike[str], options: SourceOptions = _DEFAULTS) -> tuple[Record, ...]:
    """All records of a path: one for each run if ``options.run`` is ``all``, else one.

    Args:
        path: what to read.
        options: as for ``read``.

    Raises:
        DataError: as for ``read``.
    """
    return tuple(read(path, one) for one in each_run(path, options))


def _read_bag(
    path: str | os.PathLike[str], options: SourceOptions, on_progress: Callable[[int], None] | None
) -> Record:
    for word, given in (
        ("--rate", options.rate is not None),
        ("--run", options.run),
        ("--time", options.time),
        ("--time-scale", options.time_scale is not None),
    ):
        if given:
            raise UsageError(f"{word} with the bag {path}; expected it for a table: messages have their own stamps")
    return read_bag(path, options, on_progress)

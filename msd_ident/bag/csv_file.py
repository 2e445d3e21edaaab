"""CSV files: to a Record and back."""

from __future__ import annotations

import os
from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from msd_ident.bag import units
from msd_ident.bag.options import SourceOptions
from msd_ident.bag.table import Table
from msd_ident.errors import DataError, SetupError, UsageError
from msd_ident.record import FloatArray, Record
from msd_ident.streams import from_seconds

_TIME_NAMES = ("time", "t", "stamp", "timestamp")
_FORCE_NAMES = ("force",)
_POSITION_NAMES = ("position",)


def read_csv(path: str | os.PathLike[str], options: SourceOptions) -> Record:
    """Record from a CSV file; see ``msd_ident.bag.read``. An empty cell means that there is no sample in it."""
    table = Table(Path(path))
    time_at, force_at, position_at = choose_columns(table, str(path), options)
    wanted = [time_at, position_at] + ([force_at] if force_at is not None else [])
    time, position, *rest = table.columns(wanted)
    if np.any(np.isnan(time)):
        raise DataError(
            f"{path}: {np.count_nonzero(np.isnan(time))} lines have no {table.header[time_at]}; expected a time on "
            "every line: repair or remove them"
        )
    notes: list[str] = []
    time = time * _scale(options.time_scale, units.time_factor(table.header[time_at]), table.header[time_at], notes)
    x_unit, x_factor = units.position_unit(table.header[position_at])
    t_x, x = _samples(time, position)
    x = x * _scale(options.position_scale, x_factor, table.header[position_at], notes)
    f_unit = "N"
    if force_at is None:
        t_f, f = time[:1], np.zeros(1)
    else:
        f_unit, f_factor = units.force_unit(table.header[force_at])
        t_f, f = _samples(time, rest[0])
        f = f * _scale(options.force_scale, f_factor, table.header[force_at], notes)
    return from_seconds(
        t_x,
        x,
        t_f,
        f,
        hold=options.record_hold,
        hold_known=options.hold != "auto" or force_at is None,
        force_unit=options.force_unit or _scaled_unit(f_unit, options.force_scale, ("N", "N·m")),
        position_unit=options.position_unit or _scaled_unit(x_unit, options.position_scale, ("m", "rad")),
        name=Path(path).name,
        notes=tuple(notes),
    )


def choose_columns(table: Table, name: str, options: SourceOptions) -> tuple[int, int | None, int]:
    """Places of the columns for time, force (``None`` for a free decay) and position.

    Raises:
        DataError: one of them is not there.
        UsageError: two of them are the same.
    """
    time = choose_time(table, name, options)
    force, position = _signals(table, name, options)
    columns = [time, position] + ([force] if force is not None else [])
    twice = next((column for column in columns if columns.count(column) > 1), None)
    if twice is not None:
        raise UsageError(
            f"{name}: column {table.header[twice]} is taken twice; expected columns of their own for time, force and "
            "position: correct --time, --force or --position"
        )
    return time, force, position


def _signals(table: Table, name: str, options: SourceOptions) -> tuple[int | None, int]:
    position = _column(table.header, name, options.position, _POSITION_NAMES, "--position COLUMN")
    if options.no_force:
        return None, position
    hint = "--force COLUMN, or --force none for a free decay"
    return _column(table.header, name, options.force, _FORCE_NAMES, hint), position


def choose_time(table: Table, name: str, options: SourceOptions) -> int:
    """Place of the column with the time.

    Raises:
        DataError: it is not there.
    """
    return _column(table.header, name, options.time, _TIME_NAMES, "--time COLUMN")


def write_csv(record: Record, path: str | os.PathLike[str], overwrite: bool = False) -> None:
    """Write a record so that ``read_csv`` gives the same samples to the last bit.

    The columns are ``time_s``, the force and the position with their units. Where force and position have stamps
    of their own, a line has only the one that was sampled then and leaves the other cell empty.

    Raises:
        UsageError: the file exists and ``overwrite`` is not set.
        SetupError: the disk does not take it.
    """
    target = Path(path)
    if target.exists() and not overwrite:
        raise UsageError(f"{target} exists; expected a new name: give another one, or --overwrite to replace it")
    header = f"time_s,force{_suffix(record.force_unit)},position{_suffix(record.position_unit)}\n"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with target.open("w", encoding="utf-8", newline="\n") as file:
            file.write(header)
            file.writelines(_lines(record))
    except OSError as error:
        raise SetupError(f"cannot write {target}: {error.strerror or error}; expected a writable place") from None


def _lines(record: Record) -> list[str]:
    """Lines with the shortest digits that give the same number again."""
    if record.shared_clock:
        rows = zip(record.time.tolist(), record.force.tolist(), record.position.tolist(), strict=True)
        return [f"{t!r},{f!r},{x!r}\n" for t, f, x in rows]
    force = dict(zip(record.force_time.tolist(), record.force.tolist(), strict=True))
    position = dict(zip(record.time.tolist(), record.position.tolist(), strict=True))
    stamps = np.union1d(record.time, record.force_time).tolist()
    return [f"{t!r},{_cell(force.get(t))},{_cell(position.get(t))}\n" for t in stamps]


def _cell(value: float | None) -> str:
    return "" if value is None else repr(value)


def _suffix(unit: str) -> str:
    """Ending of a column's name that ``units`` understands."""
    plain = {"N·m": "nm", "count": "counts"}.get(unit, unit.lower())
    return f"_{plain}" if plain.isalpha() else ""


def _column(header: Sequence[str], name: str, wanted: str, default: Collection[str], hint: str) -> int:
    folded = [column.strip().lower() for column in header]
    if not wanted:
        found = [i for i, column in enumerate(header) if units.stem(column) in default]
        if len(found) == 1:
            return found[0]
        problem = f"{len(found)} columns" if found else "no column"
        problem = f"{name} has {problem} called {next(iter(default))}"
    elif wanted in header:
        return list(header).index(wanted)
    elif wanted.lower() in folded:
        return folded.index(wanted.lower())
    else:
        problem = f"{name} has no column {wanted}"
    raise DataError(f"{problem}; the columns are: {', '.join(header)}: say which with {hint}")


def _samples(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The lines that have a value."""
    there = ~np.isnan(values)
    return (time, values) if there.all() else (time[there], values[there])


def _scale(given: float | None, named: float, column: str, notes: list[str]) -> float:
    if given is not None:
        return given
    if named != 1.0:
        notes.append(f"column {column} was multiplied by {named:g}, as its unit says.")
    return named


def _scaled_unit(unit: str, scale: float | None, si: tuple[str, str]) -> str:
    """Unit after the user's scale: the SI one, as nobody scales to counts or volts."""
    return unit if scale is None or unit in si else si[0]

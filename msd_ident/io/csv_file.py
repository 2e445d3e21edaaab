"""Files of columns, of any format, to a Record; and a Record to a CSV file."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray, Record
from msd_ident.data.streams import from_seconds
from msd_ident.errors import DataError, UsageError
from msd_ident.io import constant_force, even_stamps, runs, time_unit, units
from msd_ident.io.columns import TIME_NAMES, Columns, open_columns
from msd_ident.io.source_options import SourceOptions
from msd_ident.io.unsigned import signed
from msd_ident.writing import readable, write_text, writing_to

#: Headings that are taken without being named, the first that is there; those of a joint only with their unit, as a
#: number without one is taken for newtons and metres.
_FORCE_NAMES = ("force", "torque")
_POSITION_NAMES = ("position", "angle")
#: Part of a rate that its uncertainty must have to be told.
_SURE = 1e-4
#: Columns that an error message names; a measurement program's file may have hundreds.
_MOST_NAMES = 30


@dataclass(frozen=True)
class Chosen:
    """Places of the columns that are read.

    Attributes:
        time: ``None`` where the sampling rate is given instead.
        force: ``None`` for a free decay.
        position: of the position.
        counter: of the number of the sample, where there is one.
    """

    time: int | None
    force: int | None
    position: int
    counter: int | None


def read_table(path: str | os.PathLike[str], options: SourceOptions) -> Record:
    """Record from a file of columns, whatever its format. An empty cell means that there is no sample in it.

    Args:
        path: of the file.
        options: columns, scales, units and run; see ``msd_ident.io.read``.

    Raises:
        DataError: the file cannot be read, or a column is not there or cannot be used.
        UsageError: two of the columns are the same.
    """
    table = runs.select(open_columns(Path(path)), options.run, str(path))
    chosen = choose_columns(table, str(path), options)
    places = [p for p in (chosen.position, chosen.time, chosen.force, chosen.counter) if p is not None]
    read = dict(zip(places, table.columns(places), strict=True))
    time, there, remarks = _times(table, chosen, read, options, str(path))
    position = read[chosen.position][there]
    x_unit, x_factor, x_note = units.of_column(
        units.POSITION, table.header[chosen.position], options.position_unit, options.position_scale
    )
    t_x, x = _samples(time, position, f"position samples: column {table.header[chosen.position]}", "--position")
    x = x * x_factor
    notes = [*table.notes, *remarks, *filter(None, [x_note])]
    if chosen.force is None:
        f_unit, t_f, f = options.as_force[0] or units.of_no_force(x_unit), time[:1], np.zeros(1)
    else:
        heading = table.header[chosen.force]
        f_unit, f_factor, f_note = units.of_column(units.FORCE, heading, options.force_unit, options.force_scale)
        values, sign = signed(read[chosen.force][there], heading)
        hint = "--force, or --force none for a free decay"
        t_f, f = _samples(time, values, f"force samples: column {heading}", hint)
        f = f * f_factor
        gap = _without_force(heading, position, values)
        notes += [*filter(None, [f_note, sign, gap]), *constant_force.notes(f"column {heading}", f, f_unit, x)]
    return from_seconds(
        t_x,
        x,
        t_f,
        f,
        hold=options.record_hold,
        hold_known=options.hold != "auto" or chosen.force is None,
        force_unit=f_unit,
        position_unit=x_unit,
        name=readable(Path(path).name) + (f" run {options.run}" if options.run not in ("", runs.ALL) else ""),
        notes=tuple(notes),
    )


def choose_columns(table: Columns, name: str, options: SourceOptions) -> Chosen:
    """Places of the columns to read.

    Args:
        table: the file's columns.
        name: of the file, for error messages.
        options: name the columns, where their default names do not fit.

    Raises:
        DataError: one of them is not there.
        UsageError: two of them are the same.
    """
    time = choose_time(table, name, options)
    force, position = _signals(table, name, options)
    columns = [column for column in (time, position, force) if column is not None]
    twice = next((column for column in columns if columns.count(column) > 1), None)
    if twice is not None:
        raise UsageError(
            f"{name}: column {table.header[twice]} is taken twice; expected columns of their own for time, force and "
            "position: correct --time, --force or --position"
        )
    counters = [
        place
        for place, heading in enumerate(table.header)
        if units.stem(heading) in even_stamps.COUNTERS and place not in columns
    ]
    return Chosen(time, force, position, counters[0] if counters and time is not None else None)


def _signals(table: Columns, name: str, options: SourceOptions) -> tuple[int | None, int]:
    called = _first_of(_POSITION_NAMES, table.header)
    position = _column(table.header, name, options.position, called, "--position COLUMN")
    if options.no_force:
        return None, position
    hint = "--force COLUMN, or --force none for a free decay"
    return _column(table.header, name, options.force, _first_of(_FORCE_NAMES, table.header), hint), position


def _first_of(names: Sequence[str], header: Sequence[str]) -> tuple[str]:
    """The first of the names that a heading has, a further one beside its unit; the very first where none has any."""
    stems = [units.stem(column) for column in header if units.unit(column)[0] or units.stem(column) == names[0]]
    return (next((name for name in names if name in stems), names[0]),)


def choose_time(table: Columns, name: str, options: SourceOptions) -> int | None:
    """Place of the time column.

    Args:
        table: the file's columns.
        name: of the file, for error messages.
        options: name the column, or give the sampling rate.

    Returns:
        None if the sampling rate is given.

    Raises:
        DataError: it is not there.
    """
    if options.rate is not None:
        return None
    hint = "--time COLUMN, or the sampling rate with --rate HZ where there is no time"
    return _column(table.header, name, options.time, TIME_NAMES, hint)


def _times(
    table: Columns,
    chosen: Chosen,
    read: Mapping[int, FloatArray],
    options: SourceOptions,
    name: str,
) -> tuple[FloatArray, npt.NDArray[np.bool_], list[str]]:
    """Stamps [s] of the lines that are there, which lines (n,) these are, and notes for the record."""
    position = read[chosen.position]
    if chosen.time is None:
        assert options.rate is not None
        remark = f"the stamps are those of {options.rate:g} samples a second, as --rate says."
        return np.arange(position.size) / options.rate, np.ones(position.size, dtype=bool), [remark]
    heading, time = table.header[chosen.time], read[chosen.time]
    there = np.isfinite(time)
    if lost := int(np.count_nonzero(~there & np.isfinite(position))):
        raise DataError(
            f"{name}: {lost} lines have no {heading}; expected a time on every line: repair or remove them, or give "
            "the sampling rate with --rate HZ"
        )
    time = time[there]
    scale, note = time_unit.factor(heading, time, options.time_scale)
    notes = [note] if note else []
    even = even_stamps.rebuilt(time, None if chosen.counter is None else read[chosen.counter][there])
    if even is not None:
        evidence = "the stamps stay within one rounding of even ones"
        if not even.straight:
            evidence = "no interval is longer than the period rounded up"
        if even.counted and chosen.counter is not None:
            evidence = f"{table.header[chosen.counter]} numbers the samples"
        rounding = f"rounded to {even.tick * scale:.3g} s"
        if even.digits:
            rounding = f"written with {even.digits} digits, at its end rounded to {even.tick * scale:.3g} s"
        notes.append(
            f"{heading} is {rounding}, and {evidence}: the true times are rebuilt, "
            f"{1.0 / (even.period * scale):.5g} Hz{_unsure(even, scale)}."
        )
        time = even.time
    return time * scale, there, notes


def _unsure(even: even_stamps.Rebuilt, scale: float) -> str:
    """How far the rate of rebuilt times may be off, in words; empty where no interval would show it."""
    part = 2.0 * even.tick / (float(even.time[-1] - even.time[0]) * math.sqrt(even.time.size))
    if part < _SURE or even.digits:  # of a fixed number of digits the fine stamps at the begin fix the rate
        return ""
    rate = 1.0 / (even.period * scale)
    off = f"{200.0 * part:.1g} %"
    return f" ± {part * rate:.1g}, which the intervals of the parameters leave out: a mass may be off by {off}"


def write_csv(record: Record, path: str | os.PathLike[str], overwrite: bool = False) -> None:
    """Write a record so that ``read_table`` gives exactly the same samples.

    The columns are ``time_s``, the force and the position with their units. Where force and position have stamps of
    their own, each line has one of them and an empty cell for the other.

    Args:
        record: the record.
        path: of the file; its folder is made.
        overwrite: replace an existing file.

    Raises:
        UsageError: the file exists and ``overwrite`` is not set.
        SetupError: the file cannot be written.
    """
    target = Path(path)
    if target.exists() and not overwrite:
        raise UsageError(f"{target} exists; expected a new name: give another one, or --overwrite to replace it")
    header = f"time_s,force{_suffix(record.force_unit)},position{_suffix(record.position_unit)}\n"
    with writing_to(target):
        target.parent.mkdir(parents=True, exist_ok=True)
    write_text(header + "".join(_lines(record)), target)


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
    elif len(alike := [i for i, column in enumerate(header) if wanted.lower() in _short(column)]) == 1:
        return alike[0]
    elif wanted.isdecimal() and 0 < int(wanted) <= len(header):
        return int(wanted) - 1
    else:
        problem = f"{name} has no column {wanted}"
    raise DataError(f"{problem}; the columns are: {_listed(header)}: say which, by heading or number, with {hint}")


def _listed(header: Sequence[str]) -> str:
    """The columns for an error message, not more than a line can hold."""
    more = f" and {len(header) - _MOST_NAMES} more, which msd info lists" if len(header) > _MOST_NAMES else ""
    return ", ".join(header[:_MOST_NAMES]) + more


def _short(column: str) -> tuple[str, ...]:
    """Shorter names that a heading goes by: without its unit, and without its run."""
    name, _ = runs.split(column.strip())
    return name.lower(), units.stem(name)


def _without_force(heading: str, position: FloatArray, force: FloatArray) -> str:
    """A sentence on lines (n,) with a position and no force between others that have both; empty for none.

    Where most lines lack one of the two, each signal has its own lines.
    """
    both = np.flatnonzero(~np.isnan(position) & ~np.isnan(force))
    if not both.size:
        return ""
    lacking = int(np.count_nonzero(np.isnan(force[both[0] : both[-1]]) & ~np.isnan(position[both[0] : both[-1]])))
    if not 0 < lacking < both.size:
        return ""
    return (
        f"column {heading} is empty in {lacking} of the lines that have a position: the force is held there. If it was "
        "not, the parameters are wrong: complete the column, or cut the record with --start and --end."
    )


def _samples(time: FloatArray, values: FloatArray, what: str, other: str) -> tuple[FloatArray, FloatArray]:
    """The lines that have a value.

    Args:
        time, values: (n,) of all lines.
        what: what they are, with their column, for the message.
        other: options that choose something else.

    Raises:
        DataError: there is none.
    """
    there = ~np.isnan(values)
    if not there.any():
        raise DataError(
            f"no {what} has no number on any line; expected one on most: choose another column with {other}"
        )
    return (time, values) if there.all() else (time[there], values[there])

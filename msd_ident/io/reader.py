"""Reads the force and position signals of a bag into a Record."""

from __future__ import annotations

import os
from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray, Origin, Record
from msd_ident.data.streams import batch_stamps, from_stamps
from msd_ident.errors import DataError
from msd_ident.io import constant_force, units
from msd_ident.io.bag import Bag, open_bag
from msd_ident.io.message_fields import joint_names
from msd_ident.io.signal_choice import Source, choose_force, choose_position
from msd_ident.io.source_options import SourceOptions
from msd_ident.io.topics import RawMessage
from msd_ident.writing import readable

#: Entries of a bag's custom data that give the units of /msd/force and /msd/encoder; newtons and metres without.
FORCE_UNIT, POSITION_UNIT = "msd_force_unit", "msd_position_unit"

#: Stamps that are further away from the log times [ns] than messages travel are of another clock.
_SAME_CLOCK_NS = 60 * 10**9


#: Samples of one signal beyond which a bag would not fit into the memory of a small machine.
MOST_SAMPLES = 10_000_000

#: Called with the number of messages read so far; what it raises ends the reading.
OnProgress = Callable[[int], None]


class _Signal:
    """Samples of one signal, collected message by message."""

    def __init__(self, what: Literal["force", "position"], source: Source) -> None:
        from msd_ident.io.decode import Decoder  # imported here: a table needs no library for bags

        self.source = source
        self._what = what
        self._decoder = Decoder(source.topic)
        self._stamps, self._log_times = array("q"), array("q")
        self._singles = array("d")
        self._parts: list[FloatArray] = []
        self._samples = 0
        self._batches: list[tuple[int, int]] = []  # sequence number and size, in stored order
        self._periods: list[int] = []
        self._messages = self._unreadable = self._unstamped = self._without = self._nan = 0
        self._joints: set[str] = set()

    def add(self, raw: RawMessage) -> None:
        """Take the samples of one message.

        Raises:
            DataError: the type has no such field.
        """
        self._messages += 1
        message: Any = self._decoder.decode(raw.data)
        if message is None:
            self._unreadable += 1
            return
        value: float | None = 0.0
        if self.source.is_batch:
            self._parts.append(np.array(message.positions, dtype=np.float64))
            self._samples += len(message.positions)
            self._batches.append((int(message.sequence), len(message.positions)))
            self._periods.append(int(message.period_ns))
        else:
            value = self.source.field.value(message)
        if value is None:
            self._without += 1
            self._joints.update(joint_names(message))
            return
        stamp = getattr(getattr(message, "header", None), "stamp", None)
        self._stamps.append(0 if stamp is None else stamp.sec * 10**9 + stamp.nanosec)
        self._log_times.append(raw.log_time_ns)
        if not self.source.is_batch:
            self._singles.append(value)
            self._samples += 1
        if self._samples > MOST_SAMPLES:
            raise DataError(
                f"{self.source.topic.name} holds more than {MOST_SAMPLES} samples; expected fewer: cut the bag"
            )

    def samples(self) -> tuple[npt.NDArray[np.int64], FloatArray]:
        """Stamps [ns] and values in the order of the bag, without those that are NaN: there is no sample in them.

        Raises:
            DataError: there are none.
        """
        if not self._stamps:
            raise self._nothing()
        stamps, values = self._all_samples()
        there = ~np.isnan(values)
        self._nan = int(np.count_nonzero(~there))
        if self._nan and self._nan == values.size:
            raise self._nothing()
        return (stamps[there], values[there]) if self._nan else (stamps, values)

    def _all_samples(self) -> tuple[npt.NDArray[np.int64], FloatArray]:
        stamps = self._completed(np.array(self._stamps, dtype=np.int64), np.array(self._log_times, dtype=np.int64))
        if self.source.is_batch:
            sizes = [size for _, size in self._batches]
            parts = zip(stamps.tolist(), self._periods, sizes, strict=True)
            stamps = np.concatenate([batch_stamps(first, period, size) for first, period, size in parts])
            return stamps, np.concatenate(self._parts)
        return stamps, np.array(self._singles, dtype=np.float64)

    def _completed(self, stamps: npt.NDArray[np.int64], log_times: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Log times where there is no stamp. A 0 beside stamps of another clock is the begin of simulated time."""
        without = stamps == 0
        delay = np.abs(log_times - stamps)[~without]
        if delay.size and np.median(delay) > _SAME_CLOCK_NS:
            return stamps
        self._unstamped = int(np.count_nonzero(without))
        return np.where(without, log_times, stamps)

    @property
    def _missing(self) -> tuple[int, int]:
        """Samples and gaps."""
        return _missing_in_sequence(self._batches)

    @property
    def origin(self) -> Origin:
        """Topic, and samples that its publisher numbered and that are not there."""
        return Origin(self._what, self.source.topic.name, self._missing[0])

    @property
    def notes(self) -> list[str]:
        """What was odd, one sentence each."""
        name, notes = self.source.topic.name, []
        if self._unreadable:
            notes.append(f"{name}: {self._unreadable} of {self._messages} messages could not be decoded, left out.")
        if self._unstamped:
            notes.append(
                f"{name}: {self._unstamped} of {self._messages} messages have no stamp; the time at which they were "
                "logged is used."
            )
        if self._without:
            notes.append(f"{name}: {self._without} of {self._messages} messages hold no {self.source.field.text}.")
        if self._nan:
            notes.append(self._without_number())
        lost, gaps = self._missing
        if lost:
            notes.append(f"{name}: {lost} samples are missing in {gaps} gaps of the batches' sequence numbers.")
        return notes

    def _without_number(self) -> str:
        """A sentence on the samples that are NaN."""
        where = f"{self.source.label} is NaN in {self._nan} of {self._samples} samples"
        if self._what == "position":
            return f"{where}, which are left out."
        return (
            f"{where}: the force is held there. If it was not, the parameters are wrong: cut the record with --start "
            "and --end."
        )

    def _nothing(self) -> DataError:
        label, topic = self.source.label, self.source.topic.name
        hint = "; --force none for a free decay" if self._what == "force" else ""
        if self._nan:
            return DataError(
                f"{label} is NaN in all {self._nan} samples; expected numbers: choose another --{self._what}{hint}"
            )
        if self._messages == 0:
            return DataError(f"topic {topic} holds no messages; expected the {self._what}: record it{hint}")
        if self._without:
            joints = f"; the joints are: {', '.join(sorted(self._joints))}" if self._joints else ""
            return DataError(f"no message holds {label}; expected at least one with that entry{joints}")
        return DataError(
            f"none of the {self._messages} messages of {topic} can be decoded; expected {self.source.topic.type}: "
            "record again"
        )


def read_bag(path: str | os.PathLike[str], options: SourceOptions, on_progress: OnProgress | None = None) -> Record:
    """Record from a bag; see ``msd_ident.io.read``.

    Args:
        path: bag folder or file.
        options: which signals are force and position, scales and units. Its window is not applied here.
        on_progress: called with the number of messages read so far.

    Raises:
        DataError: it cannot be read, or lacks a signal.
    """
    bag = open_bag(path)
    try:
        position, force = sources(bag, options, on_progress=on_progress)
    except DataError as error:
        # What is missing may have been in the part that is lost.
        raise DataError(" ".join((f"{error};" if bag.notes else str(error), *bag.notes)).rstrip(".")) from None
    signals = [_Signal("position", position)]
    if force is not None:
        signals.append(_Signal("force", force))
    _collect(bag, signals, on_progress)
    ns_x, x = signals[0].samples()
    ns_f, f = signals[1].samples() if force is not None else (ns_x.min(keepdims=True), np.zeros(1))
    notes = [note for signal in signals for note in signal.notes]
    (f_unit, f_factor), (x_unit, x_factor) = options.as_force, options.as_position
    position_unit = x_unit or bag.custom_data.get(POSITION_UNIT, "m")
    plain = "N" if force is not None else units.of_no_force(position_unit)
    force_unit = f_unit or bag.custom_data.get(FORCE_UNIT) or plain
    f = f * f_factor
    notes += filter(None, [units.option_note(units.POSITION, options.position_unit, position.label)])
    if force is not None:
        notes += filter(None, [units.option_note(units.FORCE, options.force_unit, force.label)])
        notes += constant_force.notes(force.label, f, force_unit, x)
    return from_stamps(
        ns_x,
        x * x_factor,
        ns_f,
        f,
        hold=options.record_hold,
        force_unit=force_unit,
        position_unit=position_unit,
        name=_name(Path(path)),
        notes=(*bag.notes, *notes),
        origins=tuple(signal.origin for signal in signals),
    )


def sources(
    bag: Bag, options: SourceOptions, counts: Mapping[str, int] | None = None, on_progress: OnProgress | None = None
) -> tuple[Source, Source | None]:
    """Topics and fields of position and force.

    Args:
        bag: the bag.
        options: name the signals, where the default topics do not fit.
        counts: number of messages by topic; None to count them, if the options do not name both signals.
        on_progress: called with the number of messages read so far.

    Returns:
        Position, and force or None for a free decay.

    Raises:
        DataError: one of them is not there, or not clear.
    """
    named = options.position and (options.force or options.no_force)
    if counts is None:
        messages = () if named else _counted(bag.messages(by_log_time=False), on_progress)
        counts = Counter(message.topic for message in messages)
    name = str(bag.path)
    position = choose_position(bag.topics, options.position, counts, name)
    if options.no_force:
        return position, None
    return position, choose_force(bag.topics, options.force, counts, position.topic.name, name)


def _counted(messages: Iterable[RawMessage], on_progress: OnProgress | None) -> Iterable[RawMessage]:
    """The messages; the number of each is reported before it is given."""
    if on_progress is None:
        yield from messages
        return
    for number, message in enumerate(messages):
        on_progress(number)
        yield message


def _collect(bag: Bag, signals: Iterable[_Signal], on_progress: OnProgress | None) -> None:
    """One pass in stored order, which shows a clock that jumps back; by log time a loop would look interleaved."""
    by_topic: dict[str, list[_Signal]] = {}
    for signal in signals:
        by_topic.setdefault(signal.source.topic.name, []).append(signal)
    for message in _counted(bag.messages(by_log_time=False), on_progress):
        for signal in by_topic.get(message.topic, ()):
            signal.add(message)


def _missing_in_sequence(batches: Iterable[tuple[int, int]]) -> tuple[int, int]:
    """Samples and gaps between batches; a number that falls is a publisher that restarted, or a late batch."""
    lost = gaps = 0
    expected: int | None = None
    for sequence, size in batches:
        if expected is not None and sequence > expected:
            lost += sequence - expected
            gaps += 1
        expected = sequence + size
    return lost, gaps


def _name(path: Path) -> str:
    return readable(path.name or path.resolve().name)

"""Where the records of a request come from: the live buffer, or bags below one folder, cut and scaled alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from msd_ident.cancellation import raise_if_cancelled
from msd_ident.data.record import Record
from msd_ident.errors import DataError, UsageError
from msd_ident.io import Joint, SourceOptions
from msd_ident.ros.common.inputs import Input, crowds
from msd_ident.ros.common.live_buffer import LiveBuffer
from msd_ident.ros.common.parameters import Settings
from msd_ident.ros.common.path_sandbox import Place

#: Parameters of the node that are fields of ``SourceOptions``.
_SIGNALS = ("force", "position", "force_scale", "position_scale", "force_unit", "position_unit", "hold")


@dataclass(frozen=True)
class Part:
    """Part of a record to use, from its first position sample on [s]; twice 0 is everything, an end of 0 is open."""

    start: float = 0.0
    end: float = 0.0


class Sources:
    """Records as the node's parameters want them.

    Args:
        settings: the node's parameters.
        buffer: the live samples.
        inputs: subscriptions of force and position.
    """

    def __init__(self, settings: Settings, buffer: LiveBuffer, inputs: Mapping[str, Sequence[Input]]) -> None:
        self._settings = settings
        self._buffer = buffer
        self._inputs = inputs

    @property
    def place(self) -> Place:
        """Where bags and reports lie."""
        return Place(self._settings["bag_folder"])

    @property
    def frame(self) -> str:
        """Frame of the encoder."""
        frames = [entry.signal.frame for entry in self._inputs["position"] if entry.signal]
        return next(filter(None, frames), "")

    def record(
        self,
        path: str,
        part: Part,
        on_progress: Callable[[int], None] = lambda messages: None,
        joint: Joint | None = None,
    ) -> Record:
        """A bag or file that a request names, or the live buffer when it names none.

        ``on_progress`` gets the number of messages of a bag read so far; with a ``joint``, force and position are
        that joint's.

        Raises:
            DataError: it cannot be a record.
            UsageError: the path leads elsewhere, or the window is empty.
            Cancelled: nobody waits for it any more.
        """
        from msd_ident import io

        if not path:
            return self._live(part)

        def tell(messages: int) -> None:
            raise_if_cancelled()
            on_progress(messages)

        chosen = options(self._settings, part)
        if joint is not None:
            force_unit = "" if chosen.force_unit == "N" else chosen.force_unit
            position_unit = "" if chosen.position_unit == "m" else chosen.position_unit
            chosen = io.source_of(replace(chosen, force_unit=force_unit, position_unit=position_unit), joint)
        return io.read(self.place.existing(path), chosen, tell)

    def joints(self, path: str) -> tuple[Joint, ...]:
        """All joints of a bag.

        Raises:
            UsageError: the live buffer, which holds one joint, or the path leads elsewhere.
            DataError: it holds none.
        """
        from msd_ident import io

        if not path:
            raise UsageError(
                "all_joints goes with bags; expected bag_paths: the live buffer holds one joint, record a bag"
            )
        return io.joints(self.place.existing(path))

    def _live(self, part: Part) -> Record:
        """The buffer as a record, its window cut as the bag reader does it."""
        window = options(self._settings, part).window
        crowd = "; ".join(crowds(self._inputs["position"]))
        try:
            record = self._buffer.record()
        except DataError as error:
            raise DataError(f"{crowd}: stop the others" if crowd else str(error)) from None
        received = [entry for what in ("position", "force") for entry in self._inputs[what] if entry.count.received]
        origins = tuple(entry.origin(record.start_ns) for entry in received)
        lost = tuple(
            f"{origin.topic}: {origin.lost} samples are missing according to the sequence numbers of their publisher."
            for origin in origins
            if origin.lost
        )
        crowded = (f"{crowd}.",) if crowd else ()
        record = replace(record, origins=origins, notes=(*record.notes, *crowded, *lost))
        return record.cut(*window) if any(map(math.isfinite, window)) else record


def options(s: Settings, part: Part = Part()) -> SourceOptions:  # noqa: B008 - frozen
    """Signals, scales, units and window as the bag reader wants them.

    Raises:
        UsageError: the window or a scale makes no sense.
    """
    start, end = part.start if part.start or part.end else None, part.end or None
    return SourceOptions(**{name: s[name] for name in _SIGNALS}, start=start, end=end)

"""A simulated rig for ``msd investigate``, loaded through its entry point."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident import io
from msd_ident.data.record import MINIMUM_SAMPLES, Record
from msd_ident.design import Limits, Profile
from msd_ident.errors import UsageError
from msd_ident.workflow.investigation import Ran


@dataclass
class SimulatedRig:
    """A simulated rig that plays profiles and stops where the encoder leaves the travel, as on the graph.

    Attributes:
        simulate: the simulator.
        spec: of the rig.
        folder: for the bags.
        seed: of the encoder's noise in the first run; each run has the next one.
        runs: experiments so far.
    """

    simulate: Callable[[Mapping[str, Any]], Any]
    spec: Mapping[str, Any]
    folder: Path
    seed: int = 0
    runs: int = 0

    def play(self, profile: Profile, limits: Limits) -> Ran:
        """Play one profile from rest.

        Raises:
            UsageError: the rig makes no sense, or the profile is beyond the limits.
        """
        limits.check(profile)
        self.runs += 1
        at, force = profile.commands
        asked = {"force_time": at, "force": force, "duration": profile.duration, "seed": self.seed + self.runs}
        try:
            made = self.simulate({**self.spec, **asked})
        except ValueError as error:
            raise UsageError(str(error)) from None
        count, stopped = within(made.position, limits)
        end = float(made.time[count - 1])
        played = at <= end
        record = Record(
            time=made.time[:count], position=made.position[:count], force_time=at[played], force=force[played],
            name=f"run {self.runs}",
        )  # fmt: skip
        path = self.folder / f"run_{self.runs}"
        io.write_bag(record, path, False)
        return Ran(record, str(path), stopped)


def within(position: np.ndarray[Any, np.dtype[np.float64]], limits: Limits) -> tuple[int, str]:
    """Readings until the cart leaves its travel, at least as many as a record needs; and why it was stopped."""
    moved = position - position[0]
    beyond = np.flatnonzero((moved < limits.travel[0]) | (moved > limits.travel[1]))
    if not beyond.size:
        return int(position.size), ""
    first = int(beyond[0])
    return max(first + 1, MINIMUM_SAMPLES), f"the cart left its travel: {moved[first]:.4g} m from its start"

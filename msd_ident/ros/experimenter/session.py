"""A profile player in this process, and the rig of the graph for ``msd investigate``."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from msd_ident.design import Limits, Profile
from msd_ident.errors import DataError, Interrupted
from msd_ident.io import SourceOptions, read
from msd_ident.ros.common.node_runner import spun
from msd_ident.ros.experimenter.profile_player import LEAD, Advance, Experiment, ProfilePlayer
from msd_ident.workflow.investigation import Ran


@contextmanager
def conductor(namespace: str, silence: float, lead: float = LEAD) -> Iterator[ProfilePlayer]:
    """A node in this process that plays profiles; the rig is left without force, whatever happens."""
    with spun("conductor", namespace) as node:
        made = ProfilePlayer(node, silence, lead)
        try:
            yield made
        finally:
            made.close()


@dataclass
class GraphRig:
    """The rig of a graph.

    Attributes:
        conductor: plays on it.
        folder: for the bags.
        stop: ends an experiment in progress.
        advance: called with the progress.
        runs: experiments so far.
    """

    conductor: ProfilePlayer
    folder: Path
    stop: threading.Event
    advance: Advance
    runs: int = 0

    def play(self, profile: Profile, limits: Limits) -> Ran:
        """Play one profile; what is recorded in a bag.

        Raises:
            Interrupted: it was cancelled.
            DataError: it was stopped so soon that nothing can be learnt from it.
        """
        self.runs += 1
        bag = self.folder / f"run_{self.runs}"
        done = self.conductor.play(Experiment(profile, limits, bag, reset=True), self.stop, self.advance)
        if self.stop.is_set():
            raise Interrupted(f"the force is 0 and {bag} holds what was recorded until then")
        try:
            record = read(bag, SourceOptions())
        except DataError as error:
            if done.stopped:
                raise DataError(f"{done.stopped}, too soon to learn anything from it: see {bag}") from error
            raise
        return Ran(record, str(bag), done.stopped, max(done.worst, done.late.worst))

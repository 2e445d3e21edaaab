"""A drive whose force lags behind a changing command."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.model.declarations import Parameter, RecordScales
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import COMMAND_LOOP

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.model.plant import Model


@dataclass(frozen=True)
class DriveHysteresis(Effect):
    """F - Fr·z, where z goes from -1 to 1 within a rise of the command by Fc, and back within a fall: the iron of a
    voice coil or a brake, a valve's spool that sticks, a proportional magnet.

    It knows no time: a command that is held keeps its force. z = 0 at first.
    """

    remanent_force: float
    crossing_force: float

    name = "drive_hysteresis"
    parameters = (
        Parameter(
            "remanent_force", "Fr", "N", 0.0, math.inf, "force by which the drive stays behind a changing command",
            advice="go to the same command from above and from below",
        ),
        Parameter("crossing_force", "Fc", "N", 1e-9, math.inf, "change of the command that crosses the loop"),
    )  # fmt: skip
    acts_on = "input"
    law = "F - Fr·z with dz = (dF/Fc)·(sign(dF) - z)"
    source = "Coleman & Hodgdon 1986 (Int. J. Eng. Sci. 24): hysteresis of a ferromagnet, with a loop of even width"
    neutral = (("remanent_force", 0.0),)
    form_of = "force_gain_nonlinearity"
    stands_alone = True
    prior_odds = 1.0 / 40.0
    piecewise_linear = True
    structure = COMMAND_LOOP
    measured_by = "read the force at rest with a load cell, at the same command from above and from below"

    @classmethod
    def fits(cls, record: Record) -> bool:
        """Whether it pushes with several levels: with one, a loop is a gain."""
        return np.unique(np.abs(np.round(record.force, 12))).size > 2

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """See ``Effect``."""
        return {"remanent_force": (0.0, 0.5 * seen.force), "crossing_force": (1e-3 * seen.force, seen.force)}

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[DriveHysteresis, ...]:
        """Two per cent of the largest command, crossed by a change of twice as much."""
        del plant
        largest = max(float(np.max(np.abs(record.force))), 1e-9)
        return (cls.within_bounds(0.02 * largest, 0.04 * largest),)

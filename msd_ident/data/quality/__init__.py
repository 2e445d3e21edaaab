"""Problems of a record that are visible before any model is fitted: findings with a severity and a sentence.

Each sentence gives numbers. The thresholds are cautious: a clean record has no finding, because nobody reads a warning
that comes with every record.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from msd_ident.data.motion import observe
from msd_ident.data.noise import encoder_step, noise_floor
from msd_ident.data.quality.begin import begins_pushed, rest_before, rests_under_force, since_before
from msd_ident.data.quality.cleaning import as_it_is, clean, removed
from msd_ident.data.quality.clocks import clocks, force_unknown
from msd_ident.data.quality.encoder import frozen_encoder, rate, resolution
from msd_ident.data.quality.excitation import excitation, swapped
from msd_ident.data.quality.feedback import feedback, steered
from msd_ident.data.quality.finding import Check, Finding
from msd_ident.data.quality.gaps import continuous, left_out
from msd_ident.data.quality.relation import relation
from msd_ident.data.quality.repeats import repeated, without_repeats
from msd_ident.data.quality.sampling import missing_in, missing_samples, sampling
from msd_ident.data.quality.skips import lost_time
from msd_ident.data.quality.units import angle_unit, time_unit, units, wrapped
from msd_ident.data.record import Record

__all__ = [
    "Examined",
    "Finding",
    "begins_pushed",
    "check",
    "clean",
    "encoder_step",
    "examine",
    "force_unknown",
    "missing_in",
    "missing_samples",
    "noise_floor",
    "rest_before",
    "rests_under_force",
    "since_before",
    "steered",
]

#: Checks of a record from which the readings that no motion makes are gone.
CHECKS: tuple[Check, ...] = (
    excitation,
    frozen_encoder,
    resolution,
    rate,
    clocks,
    lost_time,
    feedback,
    units,
    angle_unit,
    time_unit,
    relation,
)


#: What is found where nothing happens in a record.
_NOTHING = {"constant_position", "no_excitation"}


@dataclass(frozen=True)
class Examined:
    """What can be said about a record before any model.

    Attributes:
        given: as it came.
        record: without what a long gap parts from the rest, without repeated readings (``without_repeats``), and then
            without what no motion makes (``clean``).
        findings: all of them, the worst first.
    """

    given: Record
    record: Record
    findings: tuple[Finding, ...]

    @property
    def idle(self) -> bool:
        """Whether the force never changes and the cart never moves."""
        return not np.ptp(self.given.force) and any(finding.code in _NOTHING for finding in self.findings)


def examine(record: Record) -> Examined:
    """Choose the part of a record that has no long gap, clean it, and look for its problems."""
    part = continuous(record)
    renewed = without_repeats(part.record)
    cleaned = clean(renewed.record)
    motion, turns = observe(cleaned.record), tuple(wrapped(record))
    checks: tuple[Check, ...] = tuple(one for one in CHECKS if one is not units or not turns)
    if swapped(cleaned.record, motion):  # the steps of a force are no jumps of an encoder's zero
        cleaned, checks = as_it_is(renewed.record), (excitation,)
    findings = [*sampling(record), *left_out(part), *turns]
    findings += [*repeated(part.record, renewed), *removed(renewed.record, cleaned)]
    findings += [finding for one in checks for finding in one(cleaned.record, motion)]
    order = ("error", "warning", "info")
    findings.sort(key=lambda finding: order.index(finding.severity))
    return Examined(record, cleaned.record, tuple(findings))


def check(record: Record) -> tuple[Finding, ...]:
    """All findings of a record, the worst first."""
    return examine(record).findings

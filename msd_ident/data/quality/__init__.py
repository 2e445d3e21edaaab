"""Problems of a record that are visible before any model is fitted: findings with a severity and a sentence.

Each sentence gives numbers. The thresholds are cautious: a clean record has no finding, because nobody reads a warning
that comes with every record.
"""

from __future__ import annotations

from msd_ident.data.motion import observe
from msd_ident.data.noise import encoder_step, noise_floor
from msd_ident.data.quality.begin import begins_pushed, rest_before, rests_under_force, since_before
from msd_ident.data.quality.cleaning import Cleaned, clean
from msd_ident.data.quality.clocks import clocks
from msd_ident.data.quality.encoder import frozen_encoder, rate, removed, resolution
from msd_ident.data.quality.excitation import excitation
from msd_ident.data.quality.feedback import feedback
from msd_ident.data.quality.finding import Check, Finding
from msd_ident.data.quality.relation import relation
from msd_ident.data.quality.sampling import missing_in, missing_samples, sampling
from msd_ident.data.quality.units import time_unit, units
from msd_ident.data.record import Record

__all__ = [
    "Cleaned",
    "Finding",
    "begins_pushed",
    "check",
    "clean",
    "encoder_step",
    "missing_in",
    "missing_samples",
    "noise_floor",
    "rest_before",
    "rests_under_force",
    "since_before",
]

#: Checks of a record from which the readings that no motion makes are gone.
CHECKS: tuple[Check, ...] = (
    excitation,
    frozen_encoder,
    resolution,
    rate,
    clocks,
    feedback,
    units,
    time_unit,
    relation,
)


def check(record: Record) -> tuple[Finding, ...]:
    """All findings of a record, the worst first."""
    cleaned = clean(record)
    kept = cleaned.record
    motion = observe(kept, encoder_step(kept), noise_floor(kept))
    findings = [*sampling(record), *removed(record, cleaned)]
    findings += [finding for one in CHECKS for finding in one(kept, motion)]
    order = ("error", "warning", "info")
    return tuple(sorted(findings, key=lambda finding: order.index(finding.severity)))

"""What was found, in one sentence and three numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from msd_ident.diagnosis import Diagnosis
from msd_ident.report import marked, words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.sections.section import Section
from msd_ident.workflow.identification import Identification


@dataclass(frozen=True)
class Card:
    """A number that matters: what it is, the number, and what to make of it."""

    label: str
    value: Marked
    remark: str
    role: str = "measured"


def diagnosis_verdict(found: Diagnosis) -> Section:
    """The verdict of a diagnosis: sentence, cards and warnings."""
    context = {
        "verdict": found.verdict,
        "pill": f"{found.verdict}: {words.VERDICTS[found.verdict]}",
        "headline": words.headline(found),
        "summary": found.summary,
        "cards": list(_cards(found)),
        "warnings": found.warnings,
        "open": (),
    }
    return Section("verdict", "Verdict", context)


def _cards(found: Diagnosis) -> Iterator[Card]:
    scale = length_scale(max(found.noise_floor, 1e-3 * found.base.see), found.records[0].position_unit)
    floors = number(found.base_adequacy.ratio, 3)
    before = marked.length("base.see_m", found.base.see, scale)
    yield Card("error of the base model", before, f"SEE of m, b, k alone: {floors} noise floors", "base")
    if found.causes:
        after = marked.length("extended.see_m", found.extended.see, scale)
        floors = number(found.adequacy.ratio, 3)
        less = f"{number(found.see_reduction_percent, 3)} % less: {floors} noise floors"
        yield Card("error of the extended model", after, less, "extended")
    yield _left(found)
    floor = marked.length("noise_floor_m", found.noise_floor, scale)
    share = f"smallest error of any model: {words.percent(found.left.noise_percent)} of the motion"
    yield Card("noise floor", floor, share, "noise")
    held = found.heldout
    if found.causes and math.isfinite(held.reduction_percent):
        gained = Marked("gain.heldout_reduction_percent", held.reduction_percent, f"{held.reduction_percent:.1f} %")
        low, high = held.interval_percent
        yield Card("better on unseen data", gained, f"95 % interval {low:.1f} to {high:.1f} %", "law")


def _left(found: Diagnosis) -> Card:
    """What is left after the extended model."""
    left = found.left.extended
    _, force = words.remainder(found)
    value = Marked("remainder.extended.motion_percent", left.motion_percent, f"{number(left.motion_percent, 2)} %")
    of = " of" if math.isnan(left.force) else ""
    seen = f"missing force{of}" if left.seen else f"not detected; any slow missing force is{of}"
    return Card("of the motion unexplained", value, f"{seen} {force}", "extended")


def identification_verdict(found: Identification) -> Section:
    """What an identification found: sentence, cards, warnings and what is open."""
    scale = length_scale(max(found.noise_floor, 1e-3 * found.original.see), found.records[0].position_unit)
    before = marked.length("original.see_m", found.original.see, scale)
    after = marked.length("refined.see_m", found.refined.see, scale)
    reduction = found.see_reduction_percent
    less = f"{number(reduction, 3)} % less (eq. 15)" if math.isfinite(reduction) else found.refined.method
    floor = marked.length("noise_floor_m", found.noise_floor, scale)
    near = found.refined.see <= 2.0 * found.noise_floor
    context = {
        "verdict": "explained" if near else "ambiguous",
        "pill": "identified" if near else "identified, but incomplete",
        "headline": "Mass, damping, stiffness and dry friction explain the motion to within the noise."
        if near
        else "The model follows the motion, but its error exceeds the noise: run msd diagnose to find what it lacks.",
        "summary": found.route,
        "cards": [
            Card("error of the original model", before, found.original.method, "base"),
            Card("error of the joint refit", after, less, "extended"),
            Card("noise floor", floor, "smallest error of any model", "noise"),
        ],
        "warnings": found.warnings,
        "open": found.open,
    }
    return Section("verdict", "Result", context)

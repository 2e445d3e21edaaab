"""What to measure next, where something is still to be decided."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from msd_ident.design.deciding_measurements import IN_VAIN
from msd_ident.design.profile_file import from_tree
from msd_ident.quantity import probability
from msd_ident.report import words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.plot import Panel, Plot, Series
from msd_ident.report.sections.section import Section
from msd_ident.report.thinning import thinned


def next_experiment(proposal: Mapping[str, Any], position_unit: str) -> Section:
    """The proposed experiment: its sentence, what it decides, other measurements, the force to push with."""
    context = {
        "sentence": proposal.get("sentence", ""),
        "rows": list(_rows(proposal, position_unit)),
        "measurements": list(proposal.get("measurements", ())),
    }
    plots = (_force(proposal["profile"]),) if proposal.get("profile") and _worthwhile(proposal) else ()
    return Section("next_experiment", "Next experiment", context, plots)


def _worthwhile(proposal: Mapping[str, Any]) -> bool:
    """Whether the profile is one to play."""
    return float(proposal["probability_of_decision"]) >= IN_VAIN


def _force(tree: Mapping[str, Any]) -> Plot:
    """Force over time."""
    profile = from_tree(tree)
    time = np.linspace(0.0, profile.duration, max(int(profile.duration * profile.rate), 2))
    line = Series("force", "law", *thinned(time, profile.force_at(time)), legend=False)
    return Plot("profile", "Force to push with", "time [s]", (Panel(f"force [{profile.unit}]", (line,)),), 220)


def _rows(proposal: Mapping[str, Any], unit: str) -> Iterator[tuple[str, Marked | str]]:
    if _worthwhile(proposal):
        yield "duration", _mark("duration_s", proposal["duration_s"], f"{number(proposal['duration_s'])} s")
    chance = proposal["probability_of_decision"]
    yield "probability that it decides", _mark("probability_of_decision", chance, probability(chance))
    for name, value in proposal.get("decided", {}).items():
        yield f"… if it is {words.effects(name)}", _mark(f"decided.{name}", value, probability(value))
    if not _worthwhile(proposal):
        return
    if "travel_m" in proposal:
        low, high = proposal["travel_m"]
        scale = length_scale(max(abs(low), abs(high)), unit)
        yield "travel", f"{number(scale.factor * low, 3)} to {number(scale.factor * high, 3)} {scale.unit}"
    if "peak_speed_m_s" in proposal:
        speed = proposal["peak_speed_m_s"]
        yield "highest speed", _mark("peak_speed_m_s", speed, f"{number(speed, 3)} {unit}/s")


def _mark(key: str, value: float, text: str) -> Marked:
    return Marked(f"next_experiment.{key}", float(value), text)

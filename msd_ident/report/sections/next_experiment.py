"""What to measure next, where something is still to be decided."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from msd_ident.design.profile_file import from_tree
from msd_ident.report import words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.plot import Panel, Plot, Series
from msd_ident.report.sections.section import Section
from msd_ident.report.thinning import thinned


class NextExperiment(Section):
    """The proposed experiment: its sentence, what it decides, the force to push with."""

    slug = "next_experiment"
    title = "Next experiment"

    def __init__(self, proposal: Mapping[str, Any], position_unit: str) -> None:
        self._proposal, self._unit = proposal, position_unit

    @cached_property
    def plots(self) -> tuple[Plot, ...]:
        """Force over time."""
        if not self._proposal.get("profile"):
            return ()
        profile = from_tree(self._proposal["profile"])
        time = np.linspace(0.0, profile.duration, max(int(profile.duration * profile.rate), 2))
        line = Series("force", "law", *thinned(time, profile.force_at(time)), legend=False)
        return (Plot("profile", "Force to push with", "time [s]", (Panel(f"force [{profile.unit}]", (line,)),), 220),)

    def context(self) -> Mapping[str, Any]:
        """Sentence, rows, other measurements."""
        return {
            "sentence": self._proposal.get("sentence", ""),
            "rows": list(self._rows()),
            "measurements": list(self._proposal.get("measurements", ())),
        }

    def _rows(self) -> Iterator[tuple[str, Marked | str]]:
        proposal = self._proposal
        yield "duration", self._mark("duration_s", f"{number(proposal['duration_s'])} s")
        chance = proposal["probability_of_decision"]
        yield "probability that it decides", self._mark("probability_of_decision", words.probability(chance))
        for name, value in proposal.get("decided", {}).items():
            yield f"… if it is {words.effects(name)}", self._mark(f"decided.{name}", words.probability(value))
        if "travel_m" in proposal:
            low, high = proposal["travel_m"]
            scale = length_scale(max(abs(low), abs(high)), self._unit)
            yield "travel", f"{number(scale.factor * low, 3)} to {number(scale.factor * high, 3)} {scale.unit}"
        if "peak_speed_m_s" in proposal:
            yield (
                "highest speed",
                self._mark("peak_speed_m_s", f"{number(proposal['peak_speed_m_s'], 3)} {self._unit}/s"),
            )

    def _mark(self, key: str, text: str) -> Marked:
        found: Any = self._proposal
        for part in key.split(".", 1):
            found = found[part]
        return Marked(f"next_experiment.{key}", float(found), text)

"""A user's own simulation against a record: outcome, what is wrong with it, the force that it lacks."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from msd_ident.diagnosis.nonlinear_laws import Beyond
from msd_ident.external import Comparison
from msd_ident.report import marked, words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.sections.missing_force import ForceSection
from msd_ident.report.sections.parameters import Column
from msd_ident.report.sections.section import ResultSection
from msd_ident.report.sections.verdict import Card
from msd_ident.workflow.explained_motion import percent_text

if TYPE_CHECKING:
    from msd_ident.external import Difference

_METHOD = "The same laws were fitted to the record and to the simulated positions, and compared."


class Outcome(ResultSection[Comparison]):
    """How well the simulation does, and how well it would do."""

    slug = "verdict"
    title = "Outcome"

    def context(self) -> Mapping[str, Any]:
        """Sentence, cards and warnings."""
        found = self._found
        floor, count = found.diagnosis.noise_floor, len(found.differences)
        scale = length_scale(max(floor, 1e-3 * found.see), found.records[0].position_unit)
        percent = Marked("explained_percent", found.explained_percent, f"{percent_text(found.explained_percent)} %")
        ratio = f"SEE: {number(found.see / floor, 3)} noise floors" if floor > 0.0 else "SEE"
        cards = [
            Card("motion explained", percent, "of its variance, by your simulation", "base"),
            Card("error of your simulation", marked.length("see_m", found.see, scale), ratio, "base"),
            Card("error when corrected", marked.length("corrected_see_m", found.rig.see, scale),
                 "SEE of the rig's model", "extended"),
            Card("noise floor", marked.length("noise_floor_m", floor, scale), "smallest error of any model", "noise"),
        ]  # fmt: skip
        return {
            "verdict": "ambiguous" if count else "explained",
            "pill": f"{count} difference{'s' if count > 1 else ''}" if count else "no difference",
            "headline": found.sentence,
            "summary": f"{found.how} {_METHOD}",
            "cards": cards,
            "warnings": found.warnings,
            "open": (),
        }


class Differences(ResultSection[Comparison]):
    """A row for each thing that the simulation has other than the rig, the largest part of the motion first."""

    slug = "differences"
    title = "What to correct"

    def context(self) -> Mapping[str, Any]:
        """The rows."""
        return {"rows": [self._row(index, one) for index, one in enumerate(self._found.differences)]}

    def _row(self, index: int, one: Difference) -> dict[str, Any]:
        key, unit = f"differences.{index}", self._found.records[0].position_unit
        sure = one.probability == one.probability
        off = one.percent
        return {
            "sentence": one.sentence,
            "name": words.parameter(one.name)[0] if one.kind == "value" else words.effect(one.name),
            "rig": marked.quantity(f"{key}.rig", one.rig),
            "simulation": marked.quantity(f"{key}.simulation", one.simulation),
            "unit": "" if one.rig.unit == "1" else one.rig.unit,
            "off": f"{off.value:+.3g} ± {1.96 * off.std:.2g} %" if one.kind == "value" and off.known else "–",
            "does": marked.length(f"{key}.motion_rms_m", one.does, length_scale(one.does, unit)),
            "probability": Marked(f"{key}.probability", one.probability, one.probability_text) if sure else "–",
        }


class LackingForce(ForceSection[Comparison]):
    """The force that would correct the simulation at each instant, as measured and as the differences make it."""

    slug = "lacking_force"
    title = "The force that the simulation lacks"

    model = "model of the rig"

    @cached_property
    def force(self) -> Beyond:
        """The force, and what the differences make of it."""
        found = self._found
        return Beyond(found.missing, found.named if found.differences else (), (), len(found.differences))

    def context(self) -> Mapping[str, Any]:
        """Records with their plots, the size of the force and what it goes with."""
        found = self._found
        size = Marked("missing_force_rms", found.missing_size, number(found.missing_size, 3))
        return {
            "records": self.by_record,
            "size": size,
            "unit": found.records[0].force_unit,
            "goes_with": [
                (signal, Marked(f"missing_force_depends_on.{signal}", share, f"{100.0 * share:.0f} %"))
                for signal, share in found.depends_on.items()
            ],
            "named": bool(found.differences),
        }


def comparison_columns(found: Comparison) -> tuple[Column, ...]:
    """The same structure fitted to the simulation's positions and to the rig's."""
    return (
        Column("your simulation", "base", "models.simulation", found.theirs.quantities, found.theirs.see,
               found.theirs.model),
        Column("rig", "extended", "models.rig", found.rig.quantities, found.rig.see, found.rig.model),
    )  # fmt: skip

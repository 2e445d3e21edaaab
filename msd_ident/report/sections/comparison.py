"""A user's own simulation against a record: outcome, what is wrong with it, the force that it lacks."""

from __future__ import annotations

from typing import Any

from msd_ident.diagnosis.nonlinear_laws import Beyond
from msd_ident.external import Comparison, Difference
from msd_ident.quantity import probability
from msd_ident.report import marked, words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.plots import Detail
from msd_ident.report.sections.missing_force import by_record, flat
from msd_ident.report.sections.parameters import Column
from msd_ident.report.sections.section import Section
from msd_ident.report.sections.verdict import Card
from msd_ident.workflow.explained_motion import percent_text

_METHOD = "The same laws were fitted to the record and to the simulated positions, and compared."


def outcome(found: Comparison) -> Section:
    """How well the simulation does, and how well it would do."""
    floor, count = found.diagnosis.noise_floor, len(found.differences)
    scale = length_scale(max(floor, 1e-3 * found.see), found.records[0].position_unit)
    percent = Marked("explained_percent", found.explained_percent, f"{percent_text(found.explained_percent)} %")
    ratio = f"SEE: {number(found.see / floor, 3)} noise floors" if floor > 0.0 else "SEE"
    corrected = marked.length("corrected_see_m", found.rig.see, scale)
    cards = [
        Card("motion explained", percent, "of its variance, by your simulation", "base"),
        Card("error of your simulation", marked.length("see_m", found.see, scale), ratio, "base"),
        Card("error when corrected", corrected, "SEE of the rig's model", "extended"),
        Card("noise floor", marked.length("noise_floor_m", floor, scale), "smallest error of any model", "noise"),
    ]
    context = {
        "verdict": "ambiguous" if count else "explained",
        "pill": f"{count} difference{'s' if count > 1 else ''}" if count else "no difference",
        "headline": found.sentence,
        "summary": f"{found.how} {_METHOD}",
        "cards": cards,
        "warnings": found.warnings,
        "open": (),
    }
    return Section("verdict", "Outcome", context)


def differences(found: Comparison) -> Section:
    """A row for each thing that the simulation has other than the rig, the largest part of the motion first."""
    unit = found.records[0].position_unit
    rows = [_row(f"differences.{index}", one, unit) for index, one in enumerate(found.differences)]
    return Section("differences", "What to correct", {"rows": rows})


def _row(key: str, one: Difference, position_unit: str) -> dict[str, Any]:
    sure = one.probability == one.probability
    off = one.percent
    return {
        "sentence": one.sentence,
        "name": words.parameter(one.name)[0] if one.kind == "value" else words.effect(one.name),
        "rig": marked.quantity(f"{key}.rig", one.rig),
        "simulation": marked.quantity(f"{key}.simulation", one.simulation),
        "unit": "" if one.rig.unit == "1" else one.rig.unit,
        "off": f"{off.value:+.3g} ± {1.96 * off.std:.2g} %" if one.kind == "value" and off.known else "–",
        "does": marked.length(f"{key}.motion_rms_m", one.does, length_scale(one.does, position_unit)),
        "probability": Marked(f"{key}.probability", one.probability, probability(one.probability)) if sure else "–",
    }


def lacking_force(found: Comparison, detail: Detail) -> Section:
    """The force that would correct the simulation at each instant, as measured and as the differences make it."""
    force = Beyond(found.missing, found.named if found.differences else (), (), len(found.differences))
    drawn = by_record(force, found.records[0].force_unit, found.records, detail, "model of the rig")
    context = {
        "records": drawn,
        "size": Marked("missing_force_rms", found.missing_size, number(found.missing_size, 3)),
        "unit": found.records[0].force_unit,
        "goes_with": [
            (signal, Marked(f"missing_force_depends_on.{signal}", share, f"{100.0 * share:.0f} %"))
            for signal, share in found.depends_on.items()
        ],
        "named": bool(found.differences),
    }
    return Section("lacking_force", "The force that the simulation lacks", context, flat(drawn))


def comparison_columns(found: Comparison) -> tuple[Column, ...]:
    """The same structure fitted to the simulation's positions and to the rig's."""
    theirs, rig = found.theirs, found.rig
    return (
        Column("your simulation", "base", "models.simulation", theirs.quantities, theirs.see, theirs.model),
        Column("rig", "extended", "models.rig", rig.quantities, rig.see, rig.model),
    )

"""Compares the diagnosis of a measured rig with its known causes and published values."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.real.rigs import Rig
from msd_ident.diagnosis import Diagnosis
from msd_ident.model.effects import by_name

#: Probability from which on a cause is stated as certain.
SURE = 0.9
#: How far above the SEE of the manual fit counts as reached.
REACHED = 1.5
#: Columns of the table that a row fills.
HEADS = "verdict | named causes with p (~ tied with) | result | published values, as found | SEE"


@dataclass(frozen=True)
class Row:
    """What was said about one rig.

    Attributes:
        rig: its name.
        extra: whether it stands outside the totals.
        verdict: of the diagnosis.
        causes: name, probability and ties of what was named.
        missed: groups of causes of which none was named, e.g. ``coulomb_friction|hysteresis``.
        false: causes named that the rig cannot have, with their probability.
        false_findings: codes of findings that are not true.
        values: what was compared, the value found (NaN without one), whether it meets the reference.
        see: of the extended model, in ``unit``.
        expert: SEE of the expert; NaN where none stands.
        seconds: processor time [s].
        lacks: the law that the library does not have, or nothing.
    """

    rig: str
    extra: bool
    verdict: str
    causes: tuple[tuple[str, float, tuple[str, ...]], ...]
    missed: tuple[str, ...]
    false: tuple[tuple[str, float], ...]
    false_findings: tuple[str, ...]
    values: tuple[tuple[str, float, bool], ...]
    see: float
    expert: float
    unit: str
    seconds: float
    lacks: str = ""

    @property
    def surely_false(self) -> bool:
        """Whether a cause that the rig cannot have is stated as certain."""
        return any(p > SURE for _, p in self.false)

    @property
    def right(self) -> bool:
        """Named what acts, nothing false that is stated as certain, references met."""
        met = all(met for _, _, met in self.values)
        return not (self.missed or self.surely_false or self.false_findings) and met

    @property
    def reached(self) -> bool | None:
        """Whether the SEE is at most 1.5 times that of the manual fit; ``None`` where none stands."""
        return None if math.isnan(self.expert) else self.see <= REACHED * self.expert


def score(rig: Rig, found: Diagnosis, seconds: float) -> Row:
    """Compare a diagnosis with what is true about the rig."""
    causes = tuple((cause.name, cause.probability, tuple(cause.tied_with)) for cause in found.causes)
    said = {_kind(name) for name, _, _ in causes} | {_kind(one) for _, _, ties in causes for one in ties}
    return Row(
        rig=rig.name,
        extra=rig.extra,
        verdict=found.verdict,
        causes=causes,
        missed=tuple("|".join(sorted(group)) for group in rig.acts if not group & said),
        false=tuple((name, p) for name, p, _ in causes if _kind(name) in rig.false),
        false_findings=tuple(sorted(rig.false_findings & {finding.code for finding in found.findings})),
        values=_values(rig, {name: quantity.value for name, quantity in found.extended.quantities.items()}),
        see=found.extended.see,
        expert=_expert(rig, found),
        unit=found.records[0].position_unit,
        seconds=seconds,
        lacks=rig.lacks,
    )


def _kind(law: str) -> str:
    """The cause whose law it is: what is true of a rig is said of causes."""
    return by_name(law).cause()


def refused(rig: Rig, error: str) -> Row:
    """A record that was not diagnosed: nothing is named and no reference met."""
    missed = tuple("|".join(sorted(group)) for group in rig.acts) or ("refused",)
    values = tuple((reference.what, math.nan, False) for reference in rig.references)
    expert = math.nan if rig.expert_see is None else rig.expert_see
    said = f"refused: {error}"
    return Row(rig.name, rig.extra, said, (), missed, (), (), values, math.nan, expert, "", 0.0, rig.lacks)


def _values(rig: Rig, quantities: Mapping[str, float]) -> tuple[tuple[str, float, bool], ...]:
    values = []
    for reference in rig.references:
        try:
            value = reference.of(quantities)
        except (KeyError, ZeroDivisionError):
            value = math.nan
        values.append((reference.what, value, reference.met(value)))
    return tuple(values)


def _expert(rig: Rig, found: Diagnosis) -> float:
    """SEE of the manual fit in the position unit, NaN where there is none.

    A share is one of the root mean square about the sensor's zero: no linear model of the record that has one leaves
    less than 11.8 % of the deviation about the mean (9.1 % of this), and its authors' linear model leaves 7.9 %.
    """
    if rig.expert_share is not None:
        return rig.expert_share * float(np.sqrt(np.mean(np.square(found.records[0].position))))
    return math.nan if rig.expert_see is None else rig.expert_see


def totals(rows: Sequence[Row]) -> list[str]:
    """Main and further records: rows that are right, that have a false cause, and that reach the SEE."""
    lines = []
    for title, chosen in (("main", [r for r in rows if not r.extra]), ("further", [r for r in rows if r.extra])):
        if chosen:
            compared = [row.reached for row in chosen if row.reached is not None and not row.lacks]
            lines.append(
                f"{title}: right {sum(row.right for row in chosen)} of {len(chosen)}; false cause with p > {SURE:g} in "
                f"{sum(row.surely_false for row in chosen)}; SEE at most {REACHED:g} times that of the "
                f"manual fit in {sum(compared)} of {len(compared)}; {sum(row.seconds for row in chosen):.0f} s of "
                "processor time"
            )
    return lines


def line(row: Row) -> str:
    """One row of the table, in Markdown."""
    causes = ", ".join(f"{name} {p:.3f}" + (f" ~ {'/'.join(ties)}" if ties else "") for name, p, ties in row.causes)
    values = "; ".join(f"{_short(what)} {value:.4g}{'' if met else ' ✗'}" for what, value, met in row.values)
    see = f"{row.see:.3g} {row.unit}" + ("" if row.reached is None else f" ({row.see / row.expert:.2f}×)")
    cells = (row.rig, row.verdict, causes or "–", judgement(row), values or "–", see, f"{row.seconds:.1f} s")
    return "| " + " | ".join(cells) + " |"


def judgement(row: Row) -> str:
    """Right, or everything that is not."""
    if row.right:
        return "right"
    wrong = [f"false cause ({name}, p {p:.3f})" for name, p in row.false]
    wrong += [f"false finding ({code})" for code in row.false_findings]
    wrong += ["no cause named"] if row.missed and not row.causes else [f"not named ({one})" for one in row.missed]
    wrong += ["published value missed"] if not all(met for _, _, met in row.values) else []
    return ", ".join(wrong)


def _short(what: str) -> str:
    return re.sub(r" \[.*\]", "", what)

"""What differs between groups of records, in numbers and in a sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from msd_ident.comparison.estimates import Estimate, Measured, estimate, structure
from msd_ident.comparison.hypotheses import GROUP, Design, Hypothesis, Posterior, design, posterior
from msd_ident.comparison.joint import JointFit, joint_fit
from msd_ident.errors import DataError, UsageError
from msd_ident.parallel import each
from msd_ident.quantity import probability

SCHEMA = "msd.compare/1"
#: Probability from which a difference is named, and from which a rival is worth a word.
CERTAIN, RIVAL = 0.95, 0.05
#: Factor of a standard deviation that the 95 % interval reaches.
_WIDE = 1.96


@dataclass(frozen=True)
class Difference:
    """One parameter, and whether it differs.

    Attributes:
        parameter: its name.
        unit: of the values.
        values: by group.
        probability: that it differs between the groups themselves.
        rivals: covariate → probability that the parameter differs with it.
        percent: by group but the first: relative difference to the first, and half its 95 % interval [%].
        resolution: difference between groups that these records would show: half a 95 % interval [%].
        kind: ``shared``, ``differs`` (between the groups), ``explained`` (by a covariate), ``tied`` (by one of several
            things) or ``open`` (the data does not tell it).
        tied_with: covariates or other parameters that could stand in its place.
    """

    parameter: str
    unit: str
    values: Mapping[str, float]
    probability: float
    rivals: Mapping[str, float]
    percent: Mapping[str, tuple[float, float]]
    resolution: float
    kind: str
    tied_with: tuple[str, ...] = ()


@dataclass(frozen=True)
class Comparison:
    """What was found.

    Attributes:
        by: the column that is compared by.
        groups: name → number of records; the first is what the others are compared with.
        effects: of the common model.
        differences: every parameter.
        estimates: of each record.
        repeatability: by parameter, relative scatter between records of a group [%]; NaN without a second record.
        joint: joint fits with and without what differs: the leading one first, then each of its parameters shared.
        warnings: what a reader must know.
    """

    by: str
    groups: Mapping[str, int]
    effects: tuple[str, ...]
    differences: tuple[Difference, ...]
    estimates: tuple[Estimate, ...]
    repeatability: Mapping[str, float]
    joint: tuple[JointFit, ...]
    warnings: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """What differs, in words."""
        parts = [text for one in self.differences if (text := self._part(one))]
        rest = [one for one in self.differences if one.kind == "shared"]
        if not parts:
            worst = max((one.resolution for one in rest), default=math.nan)
            loose = ", ".join(f"{one.parameter} ±{one.resolution:.2g} %" for one in rest)
            return f"Nothing differs beyond ±{worst:.2g} % ({loose})"
        agrees = f"; the rest agrees ({', '.join(one.parameter for one in rest)})" if rest else ""
        return "; ".join(parts) + agrees

    def _part(self, one: Difference) -> str:
        if one.kind in ("shared", "open"):
            return "" if one.kind == "shared" else f"{one.parameter} is not determined by these records"
        if one.kind == "explained":
            return f"{one.parameter} varies with {' and '.join(one.tied_with)}, not with the {self.by}"
        sizes = [
            f"{_with_half(abs(size), half)} {'lower' if size < 0.0 else 'higher'} on {self.by} {group}"
            for group, (size, half) in one.percent.items()
        ]
        text = f"{one.parameter} is {', '.join(sizes)}"
        if one.kind == "differs":
            return f"{text} (p {probability(one.probability)})"
        return f"{text}, or it is {' or '.join(one.tied_with)}: these records cannot tell"

    def to_json_dict(self) -> dict[str, Any]:
        """The contract ``msd.compare/1``."""
        return {
            "schema": SCHEMA,
            "by": self.by,
            "groups": dict(self.groups),
            "sentence": self.sentence,
            "effects": list(self.effects),
            "parameters": [
                {
                    "name": one.parameter,
                    "kind": one.kind,
                    "probability": one.probability,
                    "unit": one.unit,
                    "values": dict(one.values),
                    "percent": {group: list(size) for group, size in one.percent.items()},
                    "resolution_percent": one.resolution,
                    "rivals": dict(one.rivals),
                    "tied_with": list(one.tied_with),
                    "repeatability_percent": self.repeatability[one.parameter],
                }
                for one in self.differences
            ],
            "joint_fits": [
                {"differing": list(one.differing), "chi2": one.chi2, "converged": one.converged} for one in self.joint
            ],
            "warnings": list(self.warnings),
        }


def compare(measured: Sequence[Measured], by: str, remarks: Sequence[str] = ()) -> Comparison:
    """Compare groups of records.

    Args:
        measured: records, each with its group; in one pair of units.
        by: what the groups are, a word: robot, joint, day.
        remarks: what a reader must know already.

    Raises:
        UsageError: fewer than two groups.
        DataError: no common model, or no record that carries it in some group.
    """
    groups = tuple(sorted({one.group for one in measured}))
    if len(groups) < 2:
        raise UsageError(
            f"all records have the {by} {groups[0] if groups else '–'}; expected at least two to compare: give another "
            "--by, or --label"
        )
    model = structure(measured)
    fixed = frozenset(name for one in measured for name in one.fixed)
    estimates, failed = _estimates(measured, model, fixed)
    counts = {group: sum(one.source.group == group for one in estimates) for group in groups}
    empty = next((group for group, count in counts.items() if not count), None)
    if empty is not None:
        raise DataError(f"no record of {by} {empty} can be fitted ({failed[0]}); expected at least one")
    made = design(estimates, groups)
    found = posterior(made)
    differences = tuple(_difference(name, made, found, estimates) for name in made.names)
    differences = _tied_parameters(differences, found)
    differing = [one.parameter for one in differences if one.kind in ("differs", "tied")]
    tau = {name: 100.0 * float(value) for name, value in zip(made.names, made.repeatability, strict=True)}
    return Comparison(
        by, counts, model.effect_names, differences, tuple(estimates), tau,
        _joint(estimates, groups, differing), (*remarks, *failed, *_warnings(made, counts, by)),
    )  # fmt: skip


def _with_half(size: float, half: float) -> str:
    """A size and half its interval [%], as many digits of both behind the point as the first digit of the half has."""
    if not 0.0 < half < math.inf:
        return f"{size:.2g} % ± {half:.1g}"
    digits = max(-math.floor(math.log10(float(f"{half:.1g}"))), 0)
    return f"{size:.{digits}f} % ± {half:.{digits}f}"


def _estimates(measured: Sequence[Measured], model: Any, fixed: frozenset[str]) -> tuple[list[Estimate], list[str]]:
    failed: list[str] = []

    def work(one: Measured) -> Estimate | None:
        try:
            return estimate(one, model, fixed)
        except DataError as error:
            failed.append(str(error))
            return None

    found = [one for one in each(work, list(measured)) if one is not None]
    if not found:
        raise DataError(f"no record can be fitted ({failed[0]}); expected some of one rig's kind")
    free = found[0].fit.free
    return [one for one in found if one.fit.free == free], failed


def _difference(name: str, made: Design, found: Posterior, estimates: Sequence[Estimate]) -> Difference:
    factors = tuple(made.columns)
    odds = {factor: found.of((name, factor)) for factor in factors}
    any_of = found.of(*((name, factor) for factor in factors))
    rivals = {factor: p for factor, p in odds.items() if factor != GROUP}
    kind, tied = "shared", tuple[str, ...]()
    if odds[GROUP] >= CERTAIN:
        kind = "differs"
    elif any_of >= CERTAIN:
        named = tuple(factor for factor, p in rivals.items() if p >= CERTAIN)
        kind = "explained" if odds[GROUP] < RIVAL or named else "tied"
        tied = named if kind == "explained" and named else tuple(f for f, p in rivals.items() if p >= RIVAL)
    whole = frozenset((other, GROUP) for other in made.names)
    resolution = _WIDE * 100.0 * float(np.max(made.coefficients(whole)[name, GROUP][1]))
    if resolution > 1e3:
        kind = "open"
    place = made.names.index(name)
    pooled = _by_group(place, made, estimates)
    return Difference(
        parameter=name,
        unit=estimates[0].fit.quantities[name].unit,
        values=pooled,
        probability=odds[GROUP],
        rivals=rivals,
        percent=_percent(name, made, found, kind),
        resolution=resolution,
        kind=kind,
        tied_with=tied,
    )


def _by_group(place: int, made: Design, estimates: Sequence[Estimate]) -> dict[str, float]:
    """Weighted mean of a parameter in each group."""
    found = {}
    for group in made.groups:
        of = [i for i, one in enumerate(estimates) if one.source.group == group]
        weights = 1.0 / made.covariances[of, place, place]
        found[group] = float(made.reference[place] * (1.0 + np.average(made.values[of, place], weights=weights)))
    return found


def _percent(name: str, made: Design, found: Posterior, kind: str) -> dict[str, tuple[float, float]]:
    """Differences to the first group under the likeliest hypothesis in which there are any."""
    best: Hypothesis = next((one for one in found.hypotheses if (name, GROUP) in one), frozenset({(name, GROUP)}))
    mean, std = made.coefficients(best)[name, GROUP]
    sizes = {
        group: (100.0 * float(size), _WIDE * 100.0 * float(half))
        for group, size, half in zip(made.groups[1:], mean, std, strict=True)
    }
    if kind in ("differs", "tied"):  # of several groups, those that do differ
        return {group: (size, half) for group, (size, half) in sizes.items() if abs(size) > half} or sizes
    return sizes


def _tied_parameters(differences: Sequence[Difference], found: Posterior) -> tuple[Difference, ...]:
    """Parameters of which one differs, and nobody can say which."""
    open_ones = [one for one in differences if one.kind == "shared" and one.probability >= RIVAL]
    marked = list(differences)
    for one in open_ones:
        for other in open_ones:
            pairs = ((one.parameter, GROUP), (other.parameter, GROUP))
            if one.parameter < other.parameter and found.of(*pairs) >= CERTAIN:
                for mine, its in ((one, other), (other, one)):
                    place = next(i for i, found_ in enumerate(marked) if found_.parameter == mine.parameter)
                    tied = (*marked[place].tied_with, its.parameter)
                    marked[place] = replace(marked[place], kind="tied", tied_with=tied)
    return tuple(marked)


def _joint(estimates: Sequence[Estimate], groups: Sequence[str], differing: Sequence[str]) -> tuple[JointFit, ...]:
    """Joint fits: with what differs, then with each of it shared; with all shared where nothing does."""
    if not differing:
        return (joint_fit(estimates, groups, ()),)
    without = [[name for name in differing if name != other] for other in differing]
    return tuple(joint_fit(estimates, groups, names) for names in (differing, *without))


def _warnings(made: Design, counts: Mapping[str, int], by: str) -> tuple[str, ...]:
    warnings = []
    if max(counts.values()) == 1:
        warnings.append(
            f"One record of each {by}: the repeatability is not known, so a difference between two records counts "
            f"as a difference between two {by}s; record each several times."
        )
    missing = [name for name in ("temperature", "load") if name not in made.columns]
    if missing:
        warnings.append(
            f"No {' and no '.join(missing)} that varies was recorded, so neither can be excluded as the reason."
        )
    return tuple(warnings)

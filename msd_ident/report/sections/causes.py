"""Which causes, how sure, what they change, and what was tried and rejected."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from msd_ident.diagnosis import Cause, Diagnosis
from msd_ident.model.base_model import FRICTION_FORCE, PLANT
from msd_ident.quantity import probability
from msd_ident.report import marked, words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import number
from msd_ident.report.plots import probability_plot
from msd_ident.report.sections.section import Section
from msd_ident.selection.candidate_models import CandidateModel

#: Causes in a picture: the likeliest, so many at most.
_LIKELY, _MOST = 1e-3, 8


@dataclass(frozen=True)
class Bar:
    """One cause of a group that the data joins: its probability as a bar; the number is in the JSON for named ones."""

    name: str
    meaning: str
    percent: float
    text: Marked | str
    parameters: tuple[tuple[str, str, Marked], ...]


@dataclass(frozen=True)
class Group:
    """A cause and those tied with it, and how probable it is that one of them acts."""

    bars: tuple[Bar, ...]
    one_acts: Marked


@dataclass(frozen=True)
class Change:
    """An explanation still standing: m, b, k and µ (or Fc) in it, and how far they are from the base model's."""

    name: str
    probability: str
    cells: tuple[tuple[str, str], ...]


def causes(found: Diagnosis) -> Section:
    """Bars in groups, rows of changes, rows of what was tried and rejected; in files the likeliest causes as bars."""
    context = {
        "groups": [_group(found, index, cause) for index, cause in enumerate(found.causes)],
        "changes": list(_changes(found)),
        "units": [found.base.quantities[name].unit for name in PLANT],
        "rejected": [
            (words.effect(one.name), words.meaning(one.name), probability(one.probability), one.reason)
            for one in found.tried
            if not one.held
        ],
        "unexplained": found.verdict == "unexplained",
        "spread": [(words.parameter(name), number(low), number(high)) for name, (low, high) in found.spread.items()],
    }
    likely = [one for one in found.tried if one.held or one.probability > _LIKELY][:_MOST]
    bars = probability_plot([words.effect(one.name) for one in likely], [one.probability for one in likely])
    return Section("causes", "Causes", context, beside=(bars,) if likely else ())


def _group(found: Diagnosis, index: int, cause: Cause) -> Group:
    key = f"causes.{index}"
    either = Marked(f"{key}.tied_probability", cause.tied_probability, probability(cause.tied_probability))
    return Group(tuple(_bars(found, key, cause)), either)


def _bars(found: Diagnosis, key: str, cause: Cause) -> Iterator[Bar]:
    sure = Marked(f"{key}.probability", cause.probability, probability(cause.probability))
    parameters = tuple(
        (*words.parameter(name), _with_unit(marked.quantity(f"{key}.parameters.{name}", quantity), quantity.unit))
        for name, quantity in cause.parameters.items()
    )
    yield Bar(words.effect(cause.name), words.meaning(cause.name), 100.0 * cause.probability, sure, parameters)
    chances = {one.name: one.probability for one in found.tried}
    for name in cause.tied_with:
        chance = chances.get(name, 0.0)
        yield Bar(words.effect(name), words.meaning(name), 100.0 * chance, probability(chance), ())


def _changes(found: Diagnosis) -> Iterator[Change]:
    base = {name: found.base.quantities[name].value for name in PLANT}
    yield Change("base model", "", (*((number(value), "") for value in base.values()), ("–", "")))
    for contender in found.contenders:
        if contender.causes:
            yield _change(base, contender)


def _change(base: Mapping[str, float], contender: CandidateModel) -> Change:
    model, cells = contender.model, []
    for name, before in base.items():
        after = model[name]
        cells.append((number(after), f"{100.0 * (after / before - 1.0):+.2g} %" if before else ""))
    rubbing = FRICTION_FORCE in model.names
    cells.append((f"{number(model[FRICTION_FORCE], 3)}" if rubbing else "–", ""))
    name = words.listed([words.effect(cause) for cause in contender.causes])
    return Change(name, probability(contender.probability), tuple(cells))


def _with_unit(found: Marked, unit: str) -> Marked:
    return found if unit == "1" else Marked(found.key, found.value, f"{found.text} {unit}")

"""Sentences on why a named cause is not certain."""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_ident.estimate.levels import FEWEST
from msd_ident.model.effects import by_name, spoken
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.certainty import CERTAIN_ODDS, certain
from msd_ident.selection.hypothesis import COULOMB, HOLDING_COULOMB, Causes, kinds
from msd_ident.selection.ranking import Ranking


def sentences(ranking: Ranking) -> tuple[str, ...]:
    """A sentence for each named cause that is not certain, with the reason: e.g. it may be another form of the law of
    the others.
    """
    named, caveats = ranking.best.causes, ranking.leader_caveats
    unsure = [name for name in sorted(named) if not certain(ranking.of_cause(name))]
    said = [_another_form(ranking, name, part) for name, part in sorted(caveats.further.items()) if name in unsure]
    if caveats.leaves:
        said.append(
            f"what is left is {100.0 * caveats.leaves:.0f} % of what {_explaining(named)}: the rig follows "
            "another law, so no named cause is certain."
        )
    if caveats.missed and unsure:
        said.append(
            f"left-out data is missed by {caveats.missed:.2g} times the error of the fit: the laws follow this record, "
            f"and hold less on another, so {_are(unsure)} not certain."
        )
    said += [
        f"what is left is {100.0 * part:.0f} % of what is left without {spoken(name)}, and may move like it, so it is "
        "not certain."
        for name, part in _unclear(ranking).items()
    ]
    said += [
        f"hardly anything of {spoken(name)} is seen in motion: it holds the cart where it rests, and a force that acts "
        "only while the drive is on, or off, could do the same, so it is not certain. Pull the cart slowly."
        for name in unsure
        if name in caveats.held
    ]
    said += [
        f"{' and '.join(map(spoken, sorted(other)))} without {spoken(name)} leave{'s' if len(other) == 1 else ''} so "
        f"little more than what is named that {spoken(name)} is not certain."
        for name, other in _near_without(ranking).items()
    ]
    said += [
        f"this data leaves open how strong {spoken(name)} is, because other numbers of the model can take its place: "
        "it is as likely that it does not act."
        for name in unsure
        if name in caveats.open
    ]
    said += [*_slow(ranking, unsure), *_sampled(ranking, unsure), *_aging(ranking, unsure), *_steered(ranking, unsure)]
    said += [*_free_together(caveats, unsure), *_unfinished(ranking, unsure)]
    if ranking.balanced and unsure:
        said.append(
            "a controller holds an unstable motion, and what disturbs the rig moves its force too, which friction also "
            "does: no cause is certain. Release the joint below its axis, or push it there."
        )
    if not ranking.rich:
        said += [
            f"over one decay {spoken(name)} moves like a sensor that settles, so it is not certain. Push again later "
            "in the record."
            for name in unsure
            if by_name(name).creeps_as
        ]
    if ranking.foretold and (doubted := [one for one in sorted(named) if by_name(one).cause() not in ranking.called]):
        causes = " and ".join(map(spoken, doubted))
        said.append(f"left-out data calls for {causes}, but the evidence does not, so {_are(doubted)} not certain.")
    return tuple(sentence[0].upper() + sentence[1:] for sentence in said)


def _unfinished(ranking: Ranking, unsure: Sequence[str]) -> list[str]:
    """Why no cause is certain of a search that ended before all sets were tried."""
    if not (ranking.unfinished and unsure):
        return []
    return [
        "the record is long, and all causes leave far more than noise: the search ended after "
        f"{ranking.unfinished} sets of causes, so no cause is certain. Give it a part with --start and --end to try "
        "all."
    ]


def _free_together(caveats: Caveats, unsure: Sequence[str]) -> list[str]:
    """Why named laws are not certain that together come near any other of their kind; empty where there are none."""
    said = []
    if not caveats.filters().isdisjoint(unsure):
        said.append(
            f"{', '.join(map(spoken, sorted(caveats.filters())))} are linear filters of the force: together they come "
            "near any other filter, so none of them is certain."
        )
    if not caveats.bent().isdisjoint(unsure):
        said.append(
            f"{' and '.join(map(spoken, sorted(caveats.bent())))} are curves over the speed that bend freely: together "
            "they come near any other curve, so none of them is certain."
        )
    said += [
        f"{spoken(name)} is a curve over the speed that bends freely, and one of another cause in its place leaves "
        "only noise too: the rig's curve may be a third one, so it is not certain."
        for name in sorted(caveats.bending.intersection(unsure))
    ]
    return said


def _another_form(ranking: Ranking, name: str, part: float) -> str:
    """Why a cause is not certain that explains little, ``part``, beyond the others, or a curve beside another curve."""
    named = ranking.best.causes
    if first := sorted(one for one in named if name in ranking.leader_caveats.curved_by(one)):
        filters = any(by_name(one).filters_force() for one in first) and by_name(name).filters_force()
        are, other = ("linear filters of the force", "filter") if filters else ("curves over the position", "curve")
        return (
            f"{spoken(name)} and {' and '.join(map(spoken, first))} are {are}, and each explains much that the others "
            f"do not: together they come near any other {other}, so none of them is certain."
        )
    rest = named - {name}
    limit = rest | {COULOMB}
    if not rest or (name in HOLDING_COULOMB and any(one.causes == limit for one in ranking.sets)):
        rest = limit  # with which it is compared
    return (
        f"{spoken(name)} explains {max(100.0 * part, 1.0):.0f} % of what {_explaining(rest)}: another form of that law "
        "could do the same, so it is not certain that it is a cause of its own."
    )


def _are(names: Sequence[str]) -> str:
    """``A is``, or ``A and B are``."""
    return f"{' and '.join(map(spoken, names))} {'is' if len(names) == 1 else 'are'}"


def _explaining(causes: Causes) -> str:
    """``A explains``, or ``A and B explain``."""
    return f"{' and '.join(spoken(name) for name in sorted(causes))} explain{'s' if len(causes) == 1 else ''}"


def _slow(ranking: Ranking, unsure: Sequence[str]) -> list[str]:
    """Why named causes of which the records hold too few periods are not certain; empty where there are none."""
    slow = [name for name in unsure if name in ranking.leader_caveats.slow]
    along = [name for name in slow if ranking.best.model.effect(name).repeats_after()]
    return [
        *(
            f"the record is shorter than a period of {spoken(name)}: a slow change of another kind could do the same, "
            "so it is not certain. Record longer."
            for name in slow
            if name not in along
        ),
        *(
            f"the motion is shorter than two periods of {spoken(name)}, so it does not show that it repeats: a bend of "
            "another kind could do the same, so it is not certain. Move further."
            for name in along
        ),
        *(
            f"the record holds fewer than {FEWEST} periods of {spoken(name)}, and more than noise is left: another "
            "force that comes and goes could do the same, so it is not certain. Record longer."
            for name in unsure
            if name in ranking.leader_caveats.seldom and name not in slow
        ),
    ]


def _sampled(ranking: Ranking, unsure: Sequence[str]) -> list[str]:
    """Why named causes that explain little under a force of few samples are not certain; empty where there are none."""
    return [
        f"{spoken(name)} explains no more than twice what the force may do between its samples, which is not measured: "
        "it is not certain. Sample the force faster, or filter force and position alike."
        for name in unsure
        if name in ranking.leader_caveats.sampled
    ]


def _steered(ranking: Ranking, unsure: Sequence[str]) -> list[str]:
    """Why named laws that push back at a place are not certain under a controller; empty without one."""
    return [
        f"a controller brings the cart to the same places, so nothing tells {spoken(name)} from what holds the cart "
        "there: it is not certain. Push with a force that does not depend on the position."
        for name in unsure
        if ranking.steered and by_name(name).is_spring()
    ]


def _aging(ranking: Ranking, unsure: Sequence[str]) -> list[str]:
    """Why a named stiffness or friction that changes with time is not certain; empty where none is named or nothing
    speaks against it.
    """
    aging = [by_name(name) for name in unsure if by_name(name).ages()]
    springs = [effect for effect in aging if effect.ages_spring()]
    if not ranking.rich:
        kinds_named = [*(["stiffness"] if springs else []), *(["friction"] if len(aging) > len(springs) else [])]
        return [
            f"in this motion the amplitude changes with time, so a {kind} that changes with time may be one that "
            "changes with the amplitude: it is not certain. Push again later in the record, with the same force."
            for kind in kinds_named
        ]
    if not springs or ranking.leader_caveats.exact:
        return []
    return [
        "more than noise is left, so a mass that changes with time could do what a stiffness that changes with time "
        "does: it is not certain. Weigh the moving mass before and after."
    ]


def _near_without(ranking: Ranking) -> dict[str, Causes]:
    """Named causes that are not certain because of a set without them (``Caveats.instead``), each with the nearest; of
    these, those of which no other sentence tells, nor a tie.
    """
    named, found = ranking.best.causes, {}
    for name, others in sorted(ranking.leader_caveats.instead.items()):
        odds, other = min(((odds, sorted(other)) for other, odds in others.items()), default=(math.inf, []))
        told = name in _unclear(ranking) or not kinds(other) <= kinds(named)
        if odds < CERTAIN_ODDS and not told and not certain(ranking.of_cause(name)):
            found[name] = frozenset(other)
    return found


def _unclear(ranking: Ranking) -> dict[str, float]:
    """Named causes that are not certain because of what the leading set leaves, each with the rms of that as a part of
    what is left without the cause.
    """
    caveats = ranking.leader_caveats
    if caveats.exact or caveats.leaves or caveats.missed:
        return {}
    return {
        name: 1.0 / math.sqrt(1.0 + clear)
        for name, clear in sorted(caveats.clear.items())
        if name not in caveats.further and clear < CERTAIN_ODDS and not certain(ranking.of_cause(name))
    }

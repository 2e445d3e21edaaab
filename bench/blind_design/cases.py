"""One blind investigation: a rig by lot, a first step, designed experiments; then its result is checked.

The rig is reached through a player that gets a profile and gives a record. It is an ordinary cart at rest before each
run; limits are watched on what truly happened, not on what the encoder says.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from msd_ident.data.record import Record
from msd_ident.design import Limits, Profile, Segment
from msd_ident.diagnosis import Diagnosis
from msd_ident.workflow import pipeline
from msd_ident.workflow.investigation import Budget, Loop, Ran, Step
from msd_sim import api, lottery

#: Longest experiment [s], and travel in static deflections of the full force.
LONGEST, TRAVEL = 20.0, 2.5
_LONGER = 3.0


@dataclass(frozen=True)
class Case:
    """What is drawn: seed, hidden effect or none, Coulomb friction beside it."""

    seed: int
    hidden: str | None
    beside: bool


class BlindRig:
    """A rig by lot that plays profiles; ``worst`` is the greatest part of any limit that was truly used."""

    def __init__(self, draw: lottery.Draw) -> None:
        self.draw, self.worst, self.runs = draw, 0.0, 0

    def play(self, profile: Profile, limits: Limits) -> Ran:
        """Play a profile."""
        self.runs += 1
        at, force = profile.commands
        spec = {key: value for key, value in self.draw.spec.items() if key != "experiment"}
        spec |= {"force_time": at, "force": force, "duration": profile.duration}
        made = api.simulate(spec | {"seed": int(self.draw.spec["seed"]) + self.runs})
        moved = made.motion.position - made.motion.position[0]
        used = [np.max(moved) / limits.travel[1], np.min(moved) / limits.travel[0]]
        used += [np.max(force) / limits.force[1], np.min(force) / limits.force[0], profile.duration / limits.duration]
        self.worst = max(self.worst, *map(float, used))
        name = f"run {self.runs}"
        return Ran(Record(time=made.time, position=made.position, force_time=at, force=force, name=name))


@dataclass(frozen=True)
class Outcome:
    """What an investigation found, and what is true.

    Attributes:
        first: verdict and names after the step.
        tied: whether the step left the truth open: another name, a tie, or nothing at all.
        found: names at the end.
        verdict: at the end.
        expected: probability of a decision that the first design stated, nan without one.
        decided: whether the diagnosis after it was a decision (adequate or explained).
        true_after_one: whether it then was the truth.
        random_decided, random_true: the same after random steps three times as long in the place of that design.
        worst: greatest part of a limit that was used.
        runs: experiments after the step.
        seconds, design_seconds: processor time of all, and of the slowest design.
    """

    case: Case
    truth: tuple[str, ...]
    first: tuple[str, tuple[str, ...]]
    tied: bool
    found: tuple[str, ...]
    verdict: str
    expected: float
    purpose: str
    decided: bool
    true_after_one: bool
    random_decided: bool | None
    random_true: bool | None
    worst: float
    runs: int
    measurements: tuple[str, ...]
    seconds: float
    design_seconds: float

    @property
    def right(self) -> bool:
        """Whether the truth stands alone at the end."""
        return self.found == self.truth and self.verdict in ("adequate", "explained")

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)

    @classmethod
    def from_json_dict(cls, values: Mapping[str, Any]) -> Outcome:
        """What ``to_json_dict`` gave, from JSON: lists are tuples again."""
        verdict, found = values["first"]
        plain = {key: tuple(value) if isinstance(value, list) else value for key, value in values.items()}
        return cls(**{**plain, "case": Case(**values["case"]), "first": (verdict, tuple(found))})


def names(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Causes named, those that are tied with their rivals."""
    return tuple(sorted("|".join((one.name, *one.tied_with)) for one in diagnosis.causes))


def limits_of(spec: Mapping[str, Any], force: float) -> Limits:
    """Limits of a rig by lot."""
    travel = TRAVEL * force / float(spec["stiffness"])
    return Limits((-force, force), (-travel, travel), LONGEST)


def run(case: Case, compare: bool) -> Outcome | None:
    """Draw, step, go on only where the step leaves the truth open; ``compare`` plays random steps too."""
    draw = lottery.draw(case.seed, case.hidden, case.beside, "step")
    force = float(draw.spec["experiment"]["force"])
    limits, truth = limits_of(draw.spec, force), tuple(sorted(draw.truth))
    rig = BlindRig(draw)
    began = time.process_time()
    first = Profile((Segment("hold", 0.3), Segment("step", 2.7, force=force)), "one step")
    loop = _Timed(rig, limits, Budget(2, 2.0 * LONGEST + 3.0))
    looked = loop.look(first)
    tied = names(looked) != truth or looked.verdict not in ("adequate", "explained")
    if not tied:
        return None
    found = loop.run(first)
    seconds = time.process_time() - began
    after = found.steps[1] if len(found.steps) > 1 else None
    random = _random(draw, rig, found.steps[0], after, limits) if compare and after is not None else None
    return Outcome(
        case=case, truth=truth, first=(looked.verdict, names(looked)), tied=tied, found=names(found.diagnosis),
        verdict=found.diagnosis.verdict,
        expected=after.proposal.probability if after and after.proposal else math.nan,
        purpose=after.purpose if after else "",
        decided=after is not None and after.diagnosis.verdict in ("adequate", "explained"),
        true_after_one=after is not None and names(after.diagnosis) == truth,
        random_decided=None if random is None else random.verdict in ("adequate", "explained"),
        random_true=None if random is None else names(random) == truth,
        worst=rig.worst, runs=len(found.steps) - 1, measurements=found.measurements,
        seconds=seconds, design_seconds=loop.slowest,
    )  # fmt: skip


class _Timed(Loop):
    """A loop that keeps the time of its slowest design, and does not run the first step twice."""

    slowest: float = 0.0

    def look(self, first: Profile) -> Diagnosis:
        """Run and diagnose the first step."""
        self._play("a first look", first, None)
        return self.steps[0].diagnosis

    def _play(self, purpose: str, profile: Profile, proposal: Any) -> None:
        if proposal is None and self.steps:
            return
        super()._play(purpose, profile, proposal)

    def _next(self) -> tuple[Any, str]:
        began = time.process_time()
        found = super()._next()
        self.slowest = max(self.slowest, time.process_time() - began)
        return found


def _random(draw: lottery.Draw, rig: BlindRig, first: Step, designed: Step, limits: Limits) -> Diagnosis:
    """Random steps three times as long as the designed experiment, in its place."""
    duration = _LONGER * designed.profile.duration
    rng = np.random.default_rng([draw.seed, 5])
    reach = 0.45 * limits.travel[1] * float(draw.spec["stiffness"])
    holds = [Segment("hold", 0.3)]
    while sum(part.duration for part in holds) < duration:
        size = float(rng.uniform(-1.0, 1.0)) * min(limits.force[1], 0.5 * reach)
        holds.append(Segment("step", float(rng.uniform(0.05, 1.0)), force=size))
    profile = Profile(tuple(holds), "random steps")
    other = BlindRig(draw)
    other.runs = 50
    ran = other.play(profile, limits)
    return pipeline.diagnose([first.ran.record, ran.record])

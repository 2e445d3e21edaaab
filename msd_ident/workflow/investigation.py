"""Loop of experiments: run, diagnose all together, design the next, until one explanation or no budget remains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np

from msd_ident.data.record import Record
from msd_ident.design import Limits, Profile, Proposal, Segment, check, design, signs_doubt
from msd_ident.diagnosis import Diagnosis, same_plant
from msd_ident.errors import DataError, UsageError
from msd_ident.model.base_model import OFFSET
from msd_ident.workflow import pipeline

#: Below this probability of a decision an experiment is not worth running.
HOPELESS = 0.1
#: Part of the force limit that the gentle step on an unknown rig has, and part of the travel that a step may plan on.
_PROBE, _PLANNED = 0.05, 0.5
#: A rig that went less than this part of the travel may have stuck: the gentle step is repeated, this much stronger.
_MOVED, _STRONGER = 0.02, 5.0
#: Probability of showing what hides from which on a look is enough for what a linear spring shows as another zero.
_SURE, _SHIFT = 0.9, frozenset({OFFSET})
_REST, _LONGEST_STEP = 0.3, 3.0
_STANDS, _NOTHING = "one explanation stands", "no experiment was found that would tell more"
_FIRST, _GENTLE = "a first look", "a gentle step that sizes the first experiment"


@dataclass(frozen=True)
class Ran:
    """One experiment as it was run.

    Attributes:
        record: what was measured.
        path: of the bag; empty where none was written.
        stopped: why it ended early; empty when it was played to its end.
        jitter: greatest delay of a command [s].
    """

    record: Record
    path: str = ""
    stopped: str = ""
    jitter: float = 0.0


class Rig(Protocol):
    """Something that profiles can be played on."""

    def play(self, profile: Profile, limits: Limits) -> Ran:
        """Play one profile and watch the limits. The cart is at rest at the start.

        Args:
            profile: force over time.
            limits: what the rig allows.
        """


@dataclass(frozen=True)
class Budget:
    """How much an investigation may use.

    Attributes:
        runs: experiments after the first one.
        seconds: duration of all experiments together [s], with that of the gentle step before them.
    """

    runs: int = 2
    seconds: float = 120.0


@dataclass(frozen=True)
class Trial:
    """A gentle step that sizes the first experiment; it is not diagnosed.

    Attributes:
        profile: what was played.
        ran: what came of it.
        went: how far the rig went [m or rad].
    """

    purpose: ClassVar[str] = _GENTLE
    profile: Profile
    ran: Ran
    went: float

    def to_json_dict(self) -> dict[str, Any]:
        """A journal's entry."""
        return {
            "purpose": self.purpose,
            "profile": self.profile.name,
            "duration_s": self.profile.duration,
            "peak_force": max(self.profile.extremes, key=abs),
            "bag": self.ran.path,
            "travel_m": self.went,
        }


@dataclass(frozen=True)
class Step:
    """One experiment of an investigation.

    Attributes:
        purpose: why it was run.
        profile: what was played.
        proposal: its design; ``None`` for the first.
        ran: what came of it.
        diagnosis: of all records so far.
    """

    purpose: str
    profile: Profile
    proposal: Proposal | None
    ran: Ran
    diagnosis: Diagnosis

    def to_json_dict(self) -> dict[str, Any]:
        """A journal's entry."""
        return {
            "purpose": self.purpose,
            "profile": self.profile.name,
            "duration_s": self.profile.duration,
            "expected_decision": None if self.proposal is None else self.proposal.probability,
            "bag": self.ran.path,
            "stopped": self.ran.stopped,
            "jitter_s": self.ran.jitter,
            "verdict": self.diagnosis.verdict,
            "causes": [
                {"name": one.name, "probability": one.probability, "tied_with": list(one.tied_with)}
                for one in self.diagnosis.causes
            ],
            "summary": self.diagnosis.summary,
        }


@dataclass(frozen=True)
class Investigation:
    """The experiments of an investigation and their result.

    Attributes:
        steps: the experiments in order.
        stands: whether one explanation remains.
        sentence: how it ended.
        measurements: explanations that no profile distinguishes, and what to measure for them.
        trials: the gentle steps before the first experiment, in order.
    """

    steps: tuple[Step, ...]
    stands: bool
    sentence: str
    measurements: tuple[str, ...] = ()
    trials: tuple[Trial, ...] = ()

    @property
    def diagnosis(self) -> Diagnosis:
        """Of all records."""
        return self.steps[-1].diagnosis

    def to_json_dict(self) -> dict[str, Any]:
        """The journal."""
        return {
            "schema": "msd.investigation/1",
            "stands": self.stands,
            "sentence": self.sentence,
            "measurements": list(self.measurements),
            "trials": [trial.to_json_dict() for trial in self.trials],
            "steps": [step.to_json_dict() for step in self.steps],
            "diagnosis": self.diagnosis.to_json_dict(),
        }


#: Asked before each run with its purpose and profile; False ends the investigation.
Ask = Callable[[str, Profile], bool]
Tell = Callable[[Step | Trial], None]


def always(purpose: str, profile: Profile) -> bool:
    """Answer of ``ask`` that lets everything run."""
    return True


def nobody(step: Step | Trial) -> None:
    """Callback ``tell`` that does nothing."""


@dataclass
class Loop:
    """One investigation in progress.

    Attributes:
        rig: where experiments are run.
        limits: of the rig.
        budget: what may be used.
        options: how records are diagnosed.
        ask: called before each run with its purpose and profile, also before the gentle step that sizes a first
            experiment; it is run if the answer is True.
        tell: called after each experiment, and after each gentle step.
        records: measured so far.
        steps: experiments so far.
        measurements: explanations that no profile distinguishes, and what to measure for them.
        trials: gentle steps before the first experiment.
        checked: whether an experiment was proposed that would probably show causes which the data hides.
    """

    rig: Rig
    limits: Limits
    budget: Budget = Budget()
    options: pipeline.Options = pipeline.Options()
    ask: Ask = always
    tell: Tell = nobody
    records: list[Record] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    measurements: tuple[str, ...] = ()
    trials: list[Trial] = field(default_factory=list)
    checked: bool = False

    def run(self, first: Profile | None = None) -> Investigation:
        """Run experiments until one explanation remains, no profile decides, the budget is spent, or ``ask`` declines.

        Args:
            first: the first experiment; if None, a step whose size follows from a gentle one.

        Raises:
            UsageError: the first profile is beyond the limits or declined, the gentle step is declined, or the limits
                leave no room.
            DataError: nothing moves, the gentle step was stopped, or the records are not those of one rig.
        """
        profile, spent = (first, 0.0) if first is not None else self._sized()
        self.limits.check(profile)
        if not self.ask(_FIRST, profile):
            raise UsageError("the first experiment was declined; expected a yes to begin")
        self._play(_FIRST, profile, None)
        spent += profile.duration
        for _ in range(self.budget.runs):
            looked = self.checked
            if said := signs_doubt(self.steps[-1].diagnosis):
                return self.ended(False, f"no further experiment was designed. {said}")
            proposal, purpose = self._next()
            if proposal is None:
                return self.ended(self._settled, _STANDS if self._settled else _NOTHING)
            self.measurements = proposal.measurements
            against = self._against(proposal, purpose, spent)
            if against and looked and self._settled:
                break  # a further look would have been a gain, but what stands does so without it
            if against:
                return self.ended(False, against)
            self._play(purpose, proposal.profile, proposal)
            spent += proposal.profile.duration
        return self.ended(self._settled, _STANDS if self._settled else "the budget is spent")

    @property
    def _settled(self) -> bool:
        """Whether nothing is tied or open."""
        return self.steps[-1].diagnosis.verdict in ("adequate", "explained")

    def _against(self, proposal: Proposal, purpose: str, spent: float) -> str:
        """Why an experiment is not run; empty when it is."""
        if proposal.probability < HOPELESS:
            return "no profile within the limits decides between the tied causes"
        if spent + proposal.profile.duration > self.budget.seconds:
            return "the next experiment would take longer than the budget allows"
        return "" if self.ask(purpose, proposal.profile) else "the next experiment was declined"

    def _sized(self) -> tuple[Profile, float]:
        """A step that uses half the travel, judged by how far gentle ones go; and how long those took [s]."""
        force = _PROBE * self.limits.reach
        sign = 1.0 if self.limits.force[1] >= -self.limits.force[0] else -1.0
        hold = min(_LONGEST_STEP, 0.4 * self.limits.duration - _REST)
        if hold <= 0.0:
            raise UsageError(f"limits: duration is {self.limits.duration:g} s; expected at least a second")
        room = min(abs(x) for x in self.limits.travel if x != 0.0)
        spent = 0.0
        while True:
            gentle = stepped(sign * force, hold)
            went = self._tried(gentle)
            spent += gentle.duration
            if went >= _MOVED * room or force >= self.limits.reach:
                break
            force = min(_STRONGER * force, self.limits.reach)
        factor = min(_PLANNED * room / max(went, 1e-12), self.limits.reach / force)
        return stepped(sign * force * factor, hold), spent

    def _tried(self, gentle: Profile) -> float:
        """How far the rig goes in a gentle step [m or rad]."""
        if not self.ask(_GENTLE, gentle):
            raise UsageError(
                "the gentle step was declined; expected a yes to begin, or a first experiment whose size is known: "
                "give it with --first"
            )
        ran = self.rig.play(gentle, self.limits)
        if ran.stopped:
            force = max(gentle.extremes, key=abs)
            raise DataError(
                f"the gentle step of {force:g} {gentle.unit} was stopped: {ran.stopped}; expected it to be "
                "played to its end: correct the rig or its limits, or give a first experiment with --first"
            )
        went = float(np.max(np.abs(ran.record.position - ran.record.position[0])))
        self.trials.append(Trial(gentle, ran, went))
        self.tell(self.trials[-1])
        return went

    def _play(self, purpose: str, profile: Profile, proposal: Proposal | None) -> None:
        ran = self.rig.play(profile, self.limits)
        self.records.append(ran.record)
        try:
            earlier = self.steps[-1].diagnosis if self.steps else None
            diagnosis = pipeline.diagnose(self.records, self.options, earlier=earlier)
            same_plant.check(diagnosis)
        except DataError as error:
            if ran.stopped:
                raise DataError(f"{profile.name!r} was stopped: {ran.stopped}; what was recorded: {error}") from None
            raise
        self.steps.append(Step(purpose, profile, proposal, ran, diagnosis))
        self.tell(self.steps[-1])

    def _next(self) -> tuple[Proposal | None, str]:
        """What to run next, and why; ``None`` when one explanation stands and nothing could hide behind it.

        Where no profile parts what is tied, none of it may be the truth: what hides is looked for then too.
        """
        diagnosis = self.steps[-1].diagnosis
        tied = design(diagnosis, self.limits)
        ties = "" if tied is None else f"to tell {' from '.join(tied.names)}"
        if tied is not None and tied.probability >= HOPELESS:
            return tied, ties
        hidden = check(diagnosis, self.limits)
        # After a look that was likely to show it, a force offset alone is not worth another.
        if hidden is None or (self.checked and set(hidden.names[1:]) <= _SHIFT):
            return tied, ties
        self.checked |= hidden.probability >= _SURE
        return hidden, f"to see what could hide: {', '.join(hidden.names[1:])}"

    def ended(self, stands: bool, why: str) -> Investigation:
        """The experiments so far: whether one explanation stands, and why they ended."""
        sentence = f"{why}: {self.steps[-1].diagnosis.summary}"
        return Investigation(tuple(self.steps), stands, sentence, self.measurements, tuple(self.trials))


def stepped(force: float, hold: float) -> Profile:
    """Profile of rest, a step and a release.

    Args:
        force: of the step [N].
        hold: duration of the step and of the rest after it [s].
    """
    parts = (Segment("hold", _REST), Segment("step", hold, force=force), Segment("release", hold))
    return Profile(parts, "step and release")

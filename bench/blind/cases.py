"""One blind case: a random rig writes a record, the diagnosis gets only the path of the file, and the result is
compared with the truth.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
import traceback
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from bench.blind import rigs
from bench.blind.rigs import Author, Sealed
from bench.blind.truth import STIFFNESS_BEYOND, allowed, same
from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.errors import MsdError
from msd_ident.estimate import fit
from msd_ident.io import SourceOptions, read
from msd_ident.model import Plant
from msd_ident.model.base_model import OFFSET
from msd_ident.model.effects import by_name
from msd_ident.model.rest import AT_REST
from msd_ident.quantity import Z95, Quantity
from msd_ident.workflow import pipeline
from msd_sim import foreign, lottery
from msd_sim.effects import ALL

#: What is compared of the plant.
PLANT = ("mass", "damping", "stiffness")
#: Verdicts where there is no diagnosis: the record is not taken, or the program fails.
REFUSED, CRASHED = "refused", "crashed"
#: What is hidden where the rig's author draws several faults.
SEVERAL = "several"
#: Kinds of cases with laws that the library does not have.
UNKNOWN = ("odd", "variant", "variant_pair")


@dataclass(frozen=True)
class Case:
    """What is drawn.

    Attributes:
        seed: of everything.
        hidden: the effect, or none; ``SEVERAL`` of a rig with several.
        beside: whether Coulomb friction acts beside it.
        experiment, rate: what is done, samples a second [Hz].
        other: a second hidden effect, or none.
        ranges, noise: of the strengths and of the encoder, as the lottery has them.
        author: who made the rig; MuJoCo's have their own names of what may be hidden.
    """

    seed: int
    hidden: str | None
    beside: bool
    experiment: str = "steps"
    rate: float = 1000.0
    other: str | None = None
    ranges: lottery.Ranges = "narrow"
    noise: lottery.Noise = "white"
    author: Author = "own"

    @property
    def kind(self) -> str:
        """``clean``, ``single``, ``beside`` (Coulomb friction), ``pair``, ``several``, ``odd``, ``variant`` or
        ``variant_pair``.
        """
        if self.hidden is None:
            return "clean"
        if self.author == "several":
            return SEVERAL
        if self.author == "mujoco":
            return "beside" if self.beside and self.hidden != "frictionloss" else "single"
        if self.hidden in lottery.ODDITIES:
            return "odd"
        if self.hidden in lottery.VARIANTS or self.hidden in foreign.LAWS:
            return "variant" if self.other is None else "variant_pair"
        if self.other is not None:
            return "pair"
        return "beside" if self.beside and not ALL[self.hidden].dry_friction else "single"

    @property
    def words(self) -> frozenset[str]:
        """What ``--only`` may ask for."""
        return frozenset({self.kind, self.experiment, self.noise, f"{self.rate:g}", self.hidden or "nothing"})


@dataclass(frozen=True)
class Outcome:
    """What the diagnosis said, and what it cost.

    ``base_floors`` and ``extended_floors`` are residuals in noise floors, ``without_floors`` what the truth leaves when
    refitted without that one of its effects which is seen least. ``removed`` is the share of the removable error that
    the extension removed on left-out data. ``beside`` are causes of rival sets that are not named, each with its own
    probability. ``named`` has each cause with its probability, with what is tied with it, and the probability that one
    of these acts. ``plant_error`` is the larger relative error of mass and stiffness, ``plant_stated`` what of it lies
    outside their intervals and the stated range over all that fits alike; ``plant`` has mass, damping and
    stiffness with their standard deviation (NaN: open) and their truth.
    """

    case: Case
    truth: tuple[str, ...]
    odd: bool
    strength: Mapping[str, float]
    verdict: str
    named: tuple[tuple[str, float, tuple[str, ...], float], ...]
    base_floors: float
    extended_floors: float
    without_floors: float
    heldout_floors: float
    removed: float
    seconds: float
    processor_seconds: float = math.nan
    beside: tuple[tuple[str, float], ...] = ()
    plant_error: float = math.nan
    plant_stated: float = math.nan
    plant: tuple[tuple[str, float, float, float], ...] = ()

    def to_json_dict(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)

    @classmethod
    def from_json_dict(cls, values: Mapping[str, Any]) -> Outcome:
        """The inverse of ``to_json_dict``."""
        named = tuple((name, p, tuple(tied), either) for name, p, tied, either in values["named"])
        beside = tuple((name, probability) for name, probability in values.get("beside", ()))
        case = Case(**values["case"])
        plant = tuple((name, *numbers) for name, *numbers in values.get("plant", ()))
        own = {"case": case, "truth": tuple(values["truth"]), "named": named, "beside": beside, "plant": plant}
        return cls(**{**values, **own})

    @property
    def names(self) -> frozenset[str]:
        """Causes named."""
        return frozenset(name for name, *_ in self.named)

    def counts_as(self, name: str) -> bool:
        """Whether a cause is named, or tied with one that is; ties of more than three do not count."""
        return any(name == one or (name in ties and len(ties) <= 2) for one, _, ties, _ in self.named)

    @property
    def diagnosed(self) -> bool:
        """Whether there is a diagnosis."""
        return self.verdict not in (REFUSED, CRASHED)

    @property
    def exact(self) -> bool:
        """The named set is the true set or one equivalent to it; a cause tied with a true one counts as that. Without a
        diagnosis nothing is right, not even that nothing is hidden.
        """
        return self.diagnosed and any(
            len(self.named) == len(one) and all(self.counts_as(name) for name in one)
            for one in same(frozenset(self.truth))
        )

    @property
    def false(self) -> tuple[tuple[str, float], ...]:
        """Causes named that are not in the rig, with their probability, whatever the verdict."""
        right = allowed(frozenset(self.truth))
        return tuple((name, p) for name, p, *_ in self.named if name not in right)


def sealed(case: Case) -> Sealed:
    """The rig of a case."""
    if case.author == "mujoco":
        return rigs.mujoco(case.seed, case.hidden, case.beside, case.experiment)
    if case.author == "several":
        return rigs.several(case.seed, case.experiment)
    if case.author == "foreign":
        return rigs.foreign_rig(case.seed, str(case.hidden), case.experiment, case.other)
    draw = lottery.draw(
        case.seed, case.hidden, case.beside, case.experiment, case.rate,
        other=case.other, ranges=case.ranges, noise=case.noise,
    )  # fmt: skip
    return rigs.own(draw)


def run(case: Case) -> Outcome:
    """Draw, write, diagnose, open the envelope. Where this fails the case counts, with nothing named."""
    rig, began = sealed(case), time.perf_counter()
    try:
        return _diagnosed(case, rig)
    except MsdError as error:
        print(f"{case} is refused: {error}", file=sys.stderr)
        return _undiagnosed(case, rig, REFUSED, time.perf_counter() - began)
    except Exception:  # a study goes on, and counts what failed
        print(f"{case} fails:\n{traceback.format_exc(limit=-3)}", file=sys.stderr)
        return _undiagnosed(case, rig, CRASHED, time.perf_counter() - began)


def _diagnosed(case: Case, rig: Sealed) -> Outcome:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.csv"
        noise = rig.write(path)
        began = time.perf_counter(), time.process_time()
        record = read(path, SourceOptions())
        diagnosis = pipeline.diagnose([record])
        seconds = time.perf_counter() - began[0], time.process_time() - began[1]
    return _opened(case, rig, noise, record, diagnosis, seconds)


def _undiagnosed(case: Case, rig: Sealed, verdict: str, seconds: float) -> Outcome:
    """A record without a diagnosis counts as one of which all is left, nothing is named and m and k are not found."""
    return Outcome(
        case=case,
        truth=tuple(sorted(rig.truth)),
        odd=case.kind in UNKNOWN,
        strength=rig.strength,
        verdict=verdict,
        named=(),
        base_floors=math.inf,
        extended_floors=math.inf,
        without_floors=math.inf,
        heldout_floors=math.inf,
        removed=math.nan,
        seconds=seconds,
        plant_error=math.inf,
        plant_stated=math.inf,
    )


def _opened(
    case: Case, rig: Sealed, noise: float, record: Record, diagnosis: Diagnosis, seconds: tuple[float, float]
) -> Outcome:
    removable = diagnosis.heldout.see_base**2 - noise**2
    left = max(diagnosis.heldout.see_extended**2 - noise**2, 0.0)
    base = diagnosis.base.see / noise
    return Outcome(
        case=case,
        truth=tuple(sorted(rig.truth)),
        odd=case.kind in UNKNOWN,
        strength=rig.strength,
        verdict=diagnosis.verdict,
        named=tuple(
            (_kind(c.name), c.probability, tuple(map(_kind, c.tied_with)), c.tied_probability) for c in diagnosis.causes
        ),
        base_floors=base,
        extended_floors=diagnosis.extended.see / noise,
        without_floors=_least_seen(rig, record) / noise if case.kind in ("beside", "pair") else base,
        heldout_floors=diagnosis.heldout.see_extended / noise,
        removed=1.0 - math.sqrt(left / removable) if removable > 0.0 else math.nan,
        seconds=seconds[0],
        processor_seconds=seconds[1],
        beside=_beside(diagnosis),
        plant_error=_plant_error(rig, diagnosis),
        plant_stated=_plant_stated(rig, diagnosis),
        plant=_plant(rig, diagnosis),
    )


def _kind(law: str) -> str:
    """The cause whose law it is: a curve of another form is the same thing on a rig."""
    return by_name(law).cause()


def _beside(diagnosis: Diagnosis) -> tuple[tuple[str, float], ...]:
    """Causes of the rival sets that are not named, and the probability that each acts."""
    named = {_kind(cause.name) for cause in diagnosis.causes}
    others = sorted({_kind(name) for rival in diagnosis.rivals for name in rival.causes} - named)
    rivals = [({_kind(name) for name in rival.causes}, rival.probability) for rival in diagnosis.rivals]
    return tuple((name, sum(p for causes, p in rivals if name in causes)) for name in others)


def _plant(rig: Sealed, diagnosis: Diagnosis) -> tuple[tuple[str, float, float, float], ...]:
    """Name, value, standard deviation and truth; of a free decay, which has no newtons, nothing."""
    if rig.experiment == "release":
        return ()
    found = [(name, _found(rig, diagnosis, name)) for name in PLANT]
    return tuple((name, quantity.value, quantity.std, rig.plant[name]) for name, quantity in found)


def _found(rig: Sealed, diagnosis: Diagnosis, name: str) -> Quantity:
    """A parameter of the plant. The stiffness of a rig without a constant force is that at rest."""
    quantities = diagnosis.extended.quantities
    if name == "stiffness" and (rig.at_rest or OFFSET not in rig.truth):
        return diagnosis.derived.get(AT_REST, quantities[name])
    return quantities[name]


def _plant_error(rig: Sealed, diagnosis: Diagnosis) -> float:
    """Larger relative error of mass and stiffness; a free decay knows their ratio only."""
    found = {name: _found(rig, diagnosis, name).value for name in ("mass", "stiffness")}
    return max(abs(value / truth - 1.0) for value, truth in _plant_and_truth(rig, diagnosis, found))


def _plant_stated(rig: Sealed, diagnosis: Diagnosis) -> float:
    """The same of what is stated: from the nearest end of the 95 % interval and of the range over all that fits alike,
    0 inside.
    """
    ends = []
    for side in (-1.0, 1.0):
        found = {}
        for name in ("mass", "stiffness"):
            quantity = _found(rig, diagnosis, name)
            half = Z95 * quantity.std if math.isfinite(quantity.std) else 0.0
            stated = (quantity.value + side * half, *diagnosis.spread.get(name, ()))
            found[name] = max(stated) if side > 0.0 else min(stated)
        ends.append(found)
    low, high = (_plant_and_truth(rig, diagnosis, one) for one in ends)
    return max(
        max(least / truth - 1.0, 1.0 - most / truth, 0.0) for (least, truth), (most, _) in zip(low, high, strict=True)
    )


def _plant_and_truth(rig: Sealed, diagnosis: Diagnosis, found: Mapping[str, float]) -> tuple[tuple[float, float], ...]:
    """Mass and stiffness with their truths; of a free decay the stiffness over the diagnosed mass."""
    names = [name for law in rig.truth for name in STIFFNESS_BEYOND.get(law, ())]
    quantities = diagnosis.extended.quantities
    stiffness = found["stiffness"] + sum(quantities[name].value for name in names if name in quantities)
    if rig.experiment == "release":
        mass = diagnosis.extended.quantities["mass"].value
        return ((stiffness / mass, rig.plant["stiffness"] / rig.plant["mass"]),)
    return ((found["mass"], rig.plant["mass"]), (stiffness, rig.plant["stiffness"]))


def _least_seen(rig: Sealed, record: Record) -> float:
    """SEE [m] of the truth without that one of its effects of which the record shows least."""
    return min(_without(rig, name, record) for name in rig.truth)


def _without(rig: Sealed, missing: str, record: Record) -> float:
    """SEE [m] of the truth without one of its effects, refitted."""
    model = Plant(*(rig.plant[name] for name in PLANT))
    for name in sorted(rig.truth - {missing}):
        law, given = rig.laws[name]
        model = model + by_name(law).from_values({p.name: given[p.name] for p in by_name(law).parameters})
    return fit(model, record).see

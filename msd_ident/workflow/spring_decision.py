"""Decide whether a spring acts if no response shows it.

A regression of the force on the motion decides where it leaves no doubt. Else two fits do, one with a spring and one
without. Their model may lack what else acts, so a diagnosis may decide otherwise (``needless_spring``,
``hidden_spring``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from msd_ident.data.autoregressive import log_likelihood
from msd_ident.data.noise import noise_floor
from msd_ident.data.quality import steered
from msd_ident.data.quality.relation import without_spring
from msd_ident.data.record import Record
from msd_ident.data.turns import turned_away
from msd_ident.estimate import FitResult, fit
from msd_ident.estimate.levels import BEYOND_DOUBT, MOST_OF, TENTH
from msd_ident.estimate.objective import Loss
from msd_ident.estimate.single_tone import common_tone, stiffness_at
from msd_ident.model import Model
from msd_ident.model.base_model import DryFriction, Offset
from msd_ident.model.effects import spoken
from msd_ident.quantity import Z95, Quantity, two_digits
from msd_ident.residuals.unexplained import Remainders
from msd_ident.tuning import fixed
from msd_ident.workflow import known_parameters
from msd_ident.workflow.explained_motion import percent_text
from msd_ident.workflow.options import Options
from msd_ident.workflow.preparation import Prepared

_MANY = fixed(1000, "interface", "odds beyond which a number says no more to a reader")
#: An error so many times smaller than without a spring decides, even where the data leaves the stiffness open.
_PLAIN = 0.2
#: In a regression of the force on the motion, as parts of the force's variation: what a model with a spring leaves at
#: most, what one without leaves at least, and how many times more, for a spring to be plain. Measured: driven axes
#: without a spring, with stops, drag, cogging and friction, leave at most 1.6 times as much (the axis of EMPS as much;
#: a disc under a controller 6 times as much, but 0.0003); 45 in 57 of the same rigs with a spring are plain.
_LEFT, _LACKS, _MORE = 0.2, 0.02, 5.0
#: A stiffness that the data knows is taken to act where it takes a fifth of the error away.
_NOTICEABLE = 0.8
#: Or where it adds so much log-likelihood and carries this part of the
#: force. Measured: a cart under a position controller 249 and 0.59, the springless axis of EMPS 61 and 0.0004.
SPRING_GAIN, SPRING_SHARE = 10.0, 0.05


@dataclass(frozen=True)
class Decision:
    """Whether the plant has a spring.

    Attributes:
        sprung: the answer.
        said: a sentence on why, if the data was asked.
        doubtful: whether two fits made it, of models that may lack what else acts.
    """

    sprung: bool
    said: tuple[str, ...] = ()
    doubtful: bool = False


def has_spring(prepared: Prepared, options: Options) -> Decision:
    """Whether the plant has a spring.

    The user's options decide, else a known stiffness, else whether a response gives a standard form, else the phase of
    a single tone, else a regression of the force where it leaves no doubt, else two fits.

    Args:
        prepared: records of one rig.
        options: of the user.
    """
    if options.model != "auto":
        return Decision(options.model == "spring")
    if (told := known_parameters.values(options.known).get("stiffness")) is not None:
        return Decision(told > 0.0)
    if prepared.form is not None:
        return Decision(True)
    if turns := max(map(turned_away, prepared.records)):
        said = f"The joint turns {turns:.0f} times, as no spring does: none is assumed."
        return Decision(False, (f"{said} If there is one, use --model spring.",))
    if (of_a_tone := by_tone(prepared.records)) is not None:
        return of_a_tone
    if not steered(prepared.findings) and (said := plain(prepared.records)):
        return Decision(True, (said,))
    sprung, said = decide(prepared.records, prepared.plant, options.loss)
    return Decision(sprung, (said,), doubtful=True)


def by_tone(records: Sequence[Record]) -> Decision | None:
    """The decision for records of a single tone, which show only k - m ω²; None for others.

    Below 0 a mass alone does that, above 0 only a spring, or a weight that hangs. Two fits would be told apart by what
    their models lack.

    Args:
        records: prepared records of one rig.
    """
    omega = common_tone(records)
    if not omega:
        return None
    shown = stiffness_at(records, omega)
    unit = f"{records[0].force_unit}/{records[0].position_unit}"
    tone = (
        f"Force and motion are a single tone of {omega / (2.0 * math.pi):.3g} Hz with k - m·omega² = {shown:.3g} {unit}"
    )
    if shown > 0.0:
        said = f"{tone}: a spring is assumed. If there is none, use --model no_spring."
    else:
        weight = (
            "" if records[0].position_unit == "m" else "; a weight over the axis of a joint would do what mass does"
        )
        said = f"{tone}, which needs no spring, and none is assumed{weight}. If there is one, use --model spring."
    return Decision(shown > 0.0, (said,))


def plain(records: tuple[Record, ...]) -> str:
    """A sentence if every record shows the spring plainly in a regression of its force on its motion, else nothing.

    Nothing is simulated: a cart without the spring that it has sticks and slips at every reading, which takes ten times
    as long.

    Args:
        records: prepared records of one rig; a controller makes the force follow the position, which looks the same.
    """
    shares = [without_spring(record, noise_floor(record)) for record in records]
    if not all(1.0 - sprung < _LEFT and 1.0 - free > max(_LACKS, _MORE * (1.0 - sprung)) for sprung, free in shares):
        return ""
    sprung, free = min(shares)
    return (
        "No response shows whether a spring acts; a spring is assumed: with one the motion accounts for "
        f"{percent_text(100.0 * min(sprung, 1.0))} % of the force's variation, without one for "
        f"{100.0 * max(free, 0.0):.0f} %. If there is none, use --model no_spring."
    )


def decide(records: tuple[Record, ...], plant: Model, loss: Loss = "linear") -> tuple[bool, str]:
    """Whether the plant has a spring, and a sentence with the odds and the option that overrides the decision.

    Args:
        records: prepared records of one rig.
        plant: that the fits start from.
        loss: as for the fit.
    """
    scale: tuple[str, ...] = ()
    if not any(np.any(record.force_at(record.time)) for record in records):
        # Without a force only ratios are known: left free, the mass would leave every stiffness open.
        plant, scale = plant.with_values(plant.values / plant.mass), ("mass",)
    base = plant + DryFriction(0.0)
    if any(np.ptp(record.force_at(record.time)) for record in records):
        base += Offset(0.0)  # beside a force that never changes it would be another size of that force
    free = fit(base.with_values({"stiffness": 0.0}), records, fixed=("stiffness", *scale), zero="known", loss=loss)
    held = fit(free.model, records, fixed=scale, zero="known", loss=loss)
    sprung = held.see < _PLAIN * free.see or _holds(held, free, records)
    return sprung, _sentence(sprung, held, free, records)


def hidden_spring(found: FitResult, records: tuple[Record, ...]) -> str:
    """Whether a spring does what a law of an angle does in a model without one.

    Near a place such a law is a spring, and a constant force. Without a spring it would be called certain for either.

    Args:
        found: the model of a diagnosis without a spring.
        records: its records.

    Returns:
        A sentence if a spring in that law's place, which the data knows, leaves an error less than twice as large; else
        nothing.
    """
    turned = [effect for effect in found.model.effects if effect.angular]
    if not turned:
        return ""
    names = " and ".join(spoken(effect.name) for effect in turned)
    plain = found.model.without(*(effect.name for effect in turned))
    held = [name for name in plain.names if name not in (*found.free, "stiffness")]
    slope = turned[0].values[0]
    starts = [plain.with_values({"stiffness": part * slope}) for part in (1.0, TENTH, TENTH**2)]
    sprung = fit(starts[0], records, fixed=held, starts=starts[1:])
    stiffness = sprung.quantities["stiffness"]
    if sprung.see > found.see / MOST_OF or not (stiffness.known and stiffness.low > 0.0):
        return ""
    return (
        f"No response shows a spring, but one of {stiffness.value:.3g} {stiffness.unit} does what {names} would do: a "
        "spring is assumed. If there is none, use --model no_spring."
    )


def needless_spring(found: FitResult, left: Remainders | None = None) -> str:
    """A sentence if the model of a diagnosis with a spring leaves open whether there is one, else nothing.

    Two fits took what the model lacked, such as friction with a curve, for a spring. Beside a missing force that may be
    as large as the spring's, the interval of its stiffness says nothing: it is that of a model that is right.

    Args:
        found: the model of a diagnosis with a spring.
        left: what that model leaves, if the record shows it.
    """
    stiffness = found.quantities["stiffness"]
    if stiffness.known and stiffness.low > 0.0:
        if left is None:
            return ""
        carried, missing = stiffness.value * left.motion_rms, left.extended
        if not carried < missing.force_interval[1]:
            return ""
        return (
            "No response shows a spring, and none is assumed: beside the causes that a diagnosis finds, it would carry "
            f"{carried:.2g} {left.force_unit} rms, and a force of {missing.force_interval[0]:.2g} to "
            f"{missing.force_interval[1]:.2g} {left.force_unit} rms was still missing. If there is one, use --model "
            "spring."
        )
    fitted = f"is {stiffness.value:.3g} ± {Z95 * stiffness.std:.2g} {stiffness.unit} (95 %)" if stiffness.known else ""
    return (
        f"No response shows a spring, and none is assumed: beside the causes that a diagnosis finds, its stiffness "
        f"{fitted or 'stays open'}. If there is one, use --model spring."
    )


def _holds(held: FitResult, free: FitResult, records: tuple[Record, ...]) -> bool:
    """Whether the data knows a stiffness, which matters: to the error, or to the forces and the one-step errors.

    A controller that holds the cart where the spring would leaves little of the spring in the error.
    """
    stiffness = held.quantities["stiffness"]
    if not (stiffness.known and stiffness.low > 0.0):
        return False
    gain = sum(map(log_likelihood, held.residuals)) - sum(map(log_likelihood, free.residuals))
    return held.see < _NOTICEABLE * free.see or (gain > SPRING_GAIN and _share(held, records) > SPRING_SHARE)


def _share(held: FitResult, records: tuple[Record, ...]) -> float:
    """Range of the spring's force over that of the applied force."""
    travel = max(float(np.ptp(record.position)) for record in records)
    applied = max(float(np.ptp(record.force)) for record in records)
    if applied == 0.0:  # a force that never changes has stepped in the first line, or acted before
        before = [float(record.force_at([np.nextafter(record.time[0], -np.inf)])[0]) for record in records]
        applied = max(abs(float(record.force[0]) - was) for record, was in zip(records, before, strict=True))
    return held.model["stiffness"] * travel / applied if applied > 0.0 else math.inf


def _sentence(sprung: bool, held: FitResult, free: FitResult, records: tuple[Record, ...]) -> str:
    """The decision with its odds, and the option that overrides it."""
    stiffness, share = held.quantities["stiffness"], 100.0 * _share(held, records)
    fitted = f"fitted with dry friction alone, its stiffness is {stiffness.value:.3g}"
    found = f"{fitted} {stiffness.unit}, which the data leaves open"
    if stiffness.known:
        forced = math.isfinite(share)
        # The odds are those of a model that is right but for its spring: beside a large error they are no odds.
        certain = held.see < BEYOND_DOUBT * held.noise_floor if sprung else stiffness.low <= 0.0
        likelier = f", {_likelihood(stiffness)}" if certain else ""
        found = (
            f"{fitted} ± {Z95 * stiffness.std:.2g} {stiffness.unit} (95 %)"
            f"{'' if forced else ' for one unit of mass'}{likelier}"
            f"{_carried(share) if forced else ''}"
        )
    # A model with a spring holds the one without: a smaller error there is a fit that did not come to its end.
    change = f"without it the error is {_times(max(free.see / held.see, 1.0))}as large"
    if sprung:
        said = f"No response shows whether a spring acts; a spring is assumed: {found}, and {change}. If there is none,"
        return f"{said} use --model no_spring."
    said = f"No response shows a spring, and none is assumed: {found}, and {change}. If there is one,"
    return f"{said} use --model spring."


def _carried(share: float) -> str:
    """What a spring carries, in words: at resonance more than is applied."""
    if share > 200.0:
        return f"; its force is {two_digits(0.01 * share)} times the applied one"
    return f"; it carries {two_digits(share)} % of the force"


def _likelihood(stiffness: Quantity) -> str:
    """How likely a known stiffness is, compared with none: the likelihood ratio of a normal distribution, in words."""
    deviations = abs(stiffness.value) / stiffness.std if stiffness.std > 0.0 else math.inf
    if deviations > BEYOND_DOUBT:
        return "beyond doubt not 0"
    times = math.exp(0.5 * deviations**2)
    return f"more than {_MANY:g} times as likely as none" if times > _MANY else f"{_times(times)}as likely as none"


def _times(ratio: float) -> str:
    """``3.2 times``, with the space that follows; empty where the ratio is printed as 1."""
    said = two_digits(ratio)
    return "" if said == "1" else f"{said} times "

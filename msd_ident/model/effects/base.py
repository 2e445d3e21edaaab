"""What every physical effect says about itself."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Literal, cast

from msd_ident.errors import UsageError
from msd_ident.model.declarations import PLACE, TIME, Harmonic, Parameter, RecordScales

if TYPE_CHECKING:
    import numpy as np
    from typing_extensions import Self

    from msd_ident.data.record import Record
    from msd_ident.model.plant import FloatArray, Model

#: Names that a law may take as arguments besides parameter and memory names.
ARGUMENTS = ("t", "x", "v", "speed", "direction", "spring_force", "driven", "lagged_v", "u")

#: Those of a force law that make it depend on more than the place.
_NOT_PLACE = frozenset(ARGUMENTS) - {"x"}

#: Sides of a knee, see ``Effect.knee``.
BOTH, ABOVE, OUTSIDE = "both", "above", "outside"
#: Knee of a law that is not smooth at x = 0.
AT_ZERO = ("0", "0", ABOVE)

#: Factor by which the numbers of a law drawn by lot are larger or smaller than where a search would start.
LOT = 5.0

#: What an effect without a law of its own is to the structure, see ``Effect.structure``.
PLAY, LAG, DELAY, SECOND_MASS, COMMAND_LOOP = "play", "lag", "delay", "second mass", "command loop"
#: Beside a law: its ``lagged_v`` [m/s] follows the velocity, from 0 at the start, with the effect's last parameter [s]
#: as time constant. Several effects may have it, all with one name for the time constant and of one family.
VELOCITY_LAG = "velocity lag"

#: As the amplitude falls, the damping ratio rises, or falls; the frequency rises, or falls: see ``Effect.ring_down``.
RUBS, DRAGS, SOFTENS, HARDENS = "rubs", "drags", "softens", "hardens"

#: Kinds of law that an effect may have, see ``Effect``.
KINDS = ("constant", "disturbance", "force", "friction", "breakaway", "input_map", "reading")


class Effect:
    """Base of all effects: a frozen dataclass whose fields are its parameters.

    Every effect sets ``name`` (that of its file), ``parameters``, ``acts_on``, ``law``, ``source``, ``neutral`` and
    ``guess``; all else has a default. The docstrings of its module, of its class and of ``guess`` stand on its page of
    the documentation.

    A law is a static method that numba can compile; its argument names say what it is given: the time
    ``t`` [s], position ``x`` [m], velocity ``v`` [m/s], ``speed`` = abs(v), ``direction`` = the sign of the
    motion (0 at rest), ``spring_force`` [N] of the linear spring (behind its backlash), ``driven`` (1 while a force is
    commanded, else 0), ``lagged_v`` [m/s] (see ``VELOCITY_LAG``), a commanded force ``u`` [N], any parameter of the
    effect or of the plant, any of its ``memory``.
    Exports copy a law's source, so it uses nothing but its arguments, ``math`` and built-in functions.
    The kernel looks for

    - ``force(...)`` [N]: on the left-hand side of m x'' + b x' + k x + force = F, smooth between guards;
    - ``constant(...)`` [N]: the same for a force that depends on parameters alone;
    - ``disturbance(t, ...)`` [N]: the same for a force that depends on time alone;
    - ``friction(...)`` [N]: dry friction while sliding, against the motion, and ``breakaway(...)`` [N] at rest;
    - ``reversal_NAME(...)``: the new value of NAME in ``memory`` when the motion turns at x, one function for each
      name: all are given the values before the turn and the ``direction`` that ends. A record begins with such a call,
      in which ``direction`` is 0;
    - ``input_map(...)`` [N]: the force that a commanded ``u`` becomes, at ``t`` too if the law is not ``steady``;
    - ``reading(...)`` [m]: what the sensor makes of x.

    Of several maps or readings in a model, each is given what the one before made, in the order of their names.

    An effect without any of these changes the structure (backlash, lag, time offset, ...), names its part in that as
    ``structure``, and the kernel itself carries it.
    """

    name: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    acts_on: ClassVar[Literal["force", "input", "sensor"]]
    law: ClassVar[str]
    source: ClassVar[str]
    #: The effect vanishes, exactly, when all these parameters have these values.
    neutral: ClassVar[tuple[tuple[str, float], ...]]
    #: Effects of one family replace each other; a model holds one of them at most.
    family: ClassVar[str] = ""
    #: The effect whose cause this is another law of: the same thing on a rig, in another form. Empty for a cause's
    #: first, simple law.
    form_of: ClassVar[str] = ""
    #: A form is tried where its simple law explains something, and from there; one that stands alone is tried anyway.
    stands_alone: ClassVar[bool] = False
    #: Causes that it may be mistaken for: like a form, it is tried where a law of one of these explains something, and
    #: in the place of another one that may be mistaken for it.
    mistaken_for: ClassVar[tuple[str, ...]] = ()
    #: It bends the spring's characteristic: names of the position [m] and of the further stiffness [N/m] beyond it,
    #: and which side is beyond: ``BOTH`` (of the mirrored position too), ``ABOVE`` or ``OUTSIDE`` (seen from zero), or
    #: the name of the distance [m] from that position beyond which it is, on either side.
    knee: ClassVar[tuple[str, str, str] | None] = None
    #: At its knee the force begins with a jump, which a solver without located events smears over a step.
    jumps: ClassVar[bool] = False
    #: It acts on the linear spring, so that it means nothing without one.
    needs_spring: ClassVar[bool] = False
    #: Person, or persons joined by hyphens, with whom its name begins, as people write them.
    eponym: ClassVar[str] = ""
    #: Its position is an angle: it means nothing on a slide.
    angular: ClassVar[bool] = False
    #: It only ever takes energy out of the motion.
    dissipative: ClassVar[bool] = False
    #: Its force fades after a push: over one decay it moves like a sensor that settles.
    creeps: ClassVar[bool] = False
    #: Turning all forces and positions round turns the motion round.
    mirror: ClassVar[bool] = True
    #: Its law does not know what time it is: a record moved in time moves the motion, and that is all.
    steady: ClassVar[bool] = True
    #: The motion stays piecewise linear with it, so the exact path of the solver carries it.
    piecewise_linear: ClassVar[bool] = False
    #: Odds, before any data, that it acts on a rig.
    prior_odds: ClassVar[float] = 1.0 / 20.0
    #: Parameters that are as sharp as the data holds them, however roughly the law holds: frequencies, pitches, phases.
    exact: ClassVar[tuple[str, ...]] = ()
    #: Parameters that state something and are never fitted.
    held: ClassVar[tuple[str, ...]] = ()
    #: Its force law is not smooth at v = 0, so the solver stops there.
    turns: ClassVar[bool] = False
    #: Start values of what the law remembers from the last reversal: (name, value) pairs. No other effect uses these
    #: names: they share one vector.
    memory: ClassVar[tuple[tuple[str, float], ...]] = ()
    #: Its part in the structure, one effect each, with the parameters in this order: ``PLAY`` of the spring (half of it
    #: [m]), ``LAG`` of the force (time constant [s]), ``DELAY`` of the force ([s]), ``SECOND_MASS`` on the first (mass
    #: [kg], stiffness [N/m], damping [N·s/m] between them), ``COMMAND_LOOP`` of the force (half its width [N], the
    #: change of the command that crosses it [N]). Empty for an effect with a law, but for ``VELOCITY_LAG``.
    structure: ClassVar[str] = ""
    #: Its harmonic term, which is found by a scan and not by going down from anywhere.
    harmonic: ClassVar[Harmonic | None] = None
    #: It holds Coulomb's friction as a limit: name of the parameter that becomes its force.
    dry_limit: ClassVar[str] = ""
    #: It limits the force: name of the parameter that does [N].
    limits_force: ClassVar[str] = ""
    #: It acts on the spring so that the spring's zero is seen, beside those whose force depends on the place.
    shows_zero: ClassVar[bool] = False
    #: Ring-down that it makes (``RUBS``, ``DRAGS``, ``SOFTENS``, ``HARDENS``): signs of its strength, the first
    #: parameter in ``neutral``, for which it may. Time counts too: over a decay the amplitude falls with it.
    ring_down: ClassVar[Mapping[str, tuple[int, ...]]] = {}
    #: What else a rig may have that moves the readings as it does, and what no record tells from it: with an article.
    or_else: ClassVar[str] = ""
    #: What to measure, without any force profile, to know whether it acts.
    measured_by: ClassVar[str] = ""

    def __post_init__(self) -> None:
        for parameter in self.parameters:
            value = float(getattr(self, parameter.name))
            object.__setattr__(self, parameter.name, value)
            if math.isnan(value) or not parameter.lower <= value <= parameter.upper:
                raise UsageError(
                    f"{self.name}: {parameter.name} is {value:g} {parameter.unit}; expected "
                    f"{parameter.lower:g} to {parameter.upper:g} {parameter.unit}"
                )

    @property
    def values(self) -> tuple[float, ...]:
        """Parameter values in the order of ``parameters``."""
        return tuple(float(getattr(self, parameter.name)) for parameter in self.parameters)

    @classmethod
    def from_values(cls, values: dict[str, float]) -> Self:
        """The effect with those of ``values`` that are its own parameters."""
        return cls(**{parameter.name: values[parameter.name] for parameter in cls.parameters})

    @classmethod
    def within_bounds(cls, *values: float) -> Self:
        """The effect with these values, or with the nearest ones that their bounds allow."""
        pairs = zip(cls.parameters, values, strict=True)
        return cls(*(min(max(value, parameter.lower), parameter.upper) for parameter, value in pairs))

    @classmethod
    def guess(cls, record: Record, plant: Model) -> tuple[Self, ...]:
        """Starting values from data: one per valley that a search should visit, the likeliest first.

        Args:
            record: the measurement.
            plant: a fitted or roughly known model without this effect.
        """
        raise NotImplementedError

    @classmethod
    def from_residual(cls, record: Record, residual: FloatArray) -> tuple[Self, ...]:
        """Starting values from what a model without the effect leaves, in place of ``guess``; none unless the residual
        shows the effect as it is.

        Args:
            record: the measurement, with positions from the relaxed spring.
            residual: (n,) model − data [m].
        """
        del record, residual
        return ()

    @classmethod
    def from_dry_friction(cls, force: float, record: Record, plant: Model) -> tuple[Self, ...]:
        """Starting values next to a fitted Coulomb friction of ``force`` [N], which the law holds as a limit."""
        raise NotImplementedError

    @classmethod
    def limited(cls, limit: float) -> Self:
        """The effect with nothing but a limit of the force [N] (see ``limits_force``)."""
        return cls(**{**dict(cls.neutral), cls.limits_force: limit})

    @property
    def holding(self) -> float:
        """Force [N] by which the cart may stand off the balance of all others."""
        return sum(value for parameter, value in zip(self.parameters, self.values, strict=True) if parameter.holds)

    def rubs(self, speed: float) -> float:
        """Dry friction [N] at a speed [m/s], at position 0 with the spring relaxed; NaN without such a law."""
        law = self.laws().get("friction")
        if law is None:
            return math.nan
        given = dict(zip((p.name for p in self.parameters), self.values, strict=True)) | dict(self.memory)
        given |= {**dict.fromkeys(ARGUMENTS, 0.0), "v": speed, "speed": speed, "direction": 1.0}
        return float(law(*(given[name] for name in arguments(law))))

    def keeps_gain(self) -> bool:
        """Whether some range of commands acts on the plant with a gain of 1, change for change."""
        return True

    def pushes(self, u: float, t: float = 0.0) -> float:
        """Force [N] that it makes of a command u [N] at a time t [s]."""
        law = self.laws().get("input_map")
        if law is None:
            return u
        given = dict(zip((p.name for p in self.parameters), self.values, strict=True)) | {"u": u, "t": t}
        return float(law(*(given[name] for name in arguments(law))))

    def longest_period(self) -> float:
        """Longest period [s] of a motion that it brings by itself; 0 if it brings none."""
        least = min((abs(frequency) for frequency in self.tones()), default=math.inf)
        return 2.0 * math.pi / least if least > 0.0 else math.inf

    def repeats_after(self) -> float:
        """Pitch [m] of what it repeats along the travel, of several their rms by power; 0 if it repeats nothing."""
        return float(getattr(self, self.harmonic.scanned)) if self.harmonic and self.harmonic.over == PLACE else 0.0

    def tones(self) -> tuple[float, ...]:
        """Angular frequencies [rad/s] of its harmonic terms over time."""
        if self.harmonic is None or self.harmonic.over != TIME:
            return ()
        return (float(getattr(self, self.harmonic.scanned)),)

    @classmethod
    def ages_spring(cls) -> bool:
        """Whether it changes the linear spring with time."""
        return cls.needs_spring and not cls.steady

    def idle(self) -> frozenset[str]:
        """Parameters that are not to be fitted: they state something, or stand for the absence of a part of the effect
        (a limit at infinity).
        """
        pairs = zip(self.parameters, self.values, strict=True)
        return frozenset(parameter.name for parameter, value in pairs if math.isinf(value)) | frozenset(self.held)

    @classmethod
    def ripple(cls) -> Harmonic | None:
        """Its only term, if that is a harmonic one over the travel."""
        return cls.harmonic if cls.harmonic is not None and cls.harmonic.over == PLACE and not cls.form_of else None

    def is_dry_friction(self) -> bool:
        """Whether its values leave nothing of it but Coulomb's friction."""
        return False

    @classmethod
    def is_shape_beside(cls, others: Iterable[type[Effect]]) -> bool:
        """Whether beside these laws it may be nothing but another shape of them, which no data tells."""
        del others
        return False

    def same_as_beside(self, model: Model) -> str:
        """A sentence: what it is the same thing as beside another effect of the model; empty where it is not."""
        del model
        return ""

    def same_as(self, model: Model) -> str:
        """A sentence: what no data of this kind tells it apart from in this model; empty where that is nothing."""
        del model
        return ""

    @classmethod
    def remembers(cls) -> bool:
        """Whether its force depends on more than time, position and velocity of the instant."""
        return bool(cls.memory) or cls.structure in (LAG, DELAY, SECOND_MASS, COMMAND_LOOP, VELOCITY_LAG)

    @classmethod
    def asks_drive(cls) -> bool:
        """Whether its force depends on whether any is commanded."""
        return any("driven" in arguments(law) for law in cls.laws().values())

    @classmethod
    def cause(cls) -> str:
        """Name of the cause that acts where this law does."""
        return cls.form_of or cls.name

    @classmethod
    def alike(cls, other: type[Effect]) -> bool:
        """Whether both are laws of one cause, one may be mistaken for the other's cause, or both for the same cause."""
        mistaken = cls.cause() in other.mistaken_for or other.cause() in cls.mistaken_for
        same = not set(cls.mistaken_for).isdisjoint(other.mistaken_for)
        return cls.cause() == other.cause() or mistaken or same

    @classmethod
    def placed(cls) -> bool:
        """Whether its force depends on where the cart is, so that a position's zero is seen without a spring too."""
        laws = [law for kind, law in cls.laws().items() if kind in ("force", "friction")]
        return cls.knee not in (None, AT_ZERO) or (not cls.memory and any("x" in arguments(law) for law in laws))

    @classmethod
    def is_scale(cls) -> bool:
        """Whether its reading is a curve over the position: a sensor of another shape."""
        reading = cls.laws().get("reading")
        given = arguments(reading) if reading is not None else ()
        return "x" in given and "t" not in given

    @classmethod
    def bends_as(cls, other: type[Effect]) -> bool:
        """Whether both are curves over the position, of the spring or of the sensor: two of them come near a third."""
        return (cls.is_spring() and other.is_spring()) or (cls.is_scale() and other.is_scale())

    @classmethod
    def is_spring(cls) -> bool:
        """Whether its force is a curve over the position: a spring of another shape."""
        bends = cls.structure == PLAY or cls.knee not in (None, AT_ZERO)
        force = cls.laws().get("force")
        return bends or (force is not None and not cls.memory and "x" in arguments(force))

    @classmethod
    @cache
    def stores_only(cls) -> bool:
        """Whether its force depends on the place alone, so that it stores energy and takes none out."""
        laws = cls.laws()
        given = [name for law in laws.values() for name in arguments(law)]
        placed = set(laws) == {"force"} and "x" in given and not set(given) & _NOT_PLACE and not cls.memory
        return not cls.structure and placed

    @classmethod
    def adds_up(cls) -> bool:
        """Whether the motions that two forces make beside it add up, at all times alike."""
        if cls.acts_on == "input" or cls.structure == SECOND_MASS:
            return True
        steady = cls.structure == VELOCITY_LAG and not cls.asks_drive()
        given = set(cls.laws())
        return steady or (not cls.structure and bool(given) and given <= {"constant", "disturbance"})

    @classmethod
    def is_linear(cls) -> bool:
        """Whether all its parameters enter the equation of motion linearly."""
        return all(parameter.regressor for parameter in cls.parameters)

    @classmethod
    def fits(cls, record: Record) -> bool:
        """Whether the law can act on a rig that gave this record, and be seen in it."""
        return not cls.angular or record.position_unit == "rad"

    @classmethod
    def resolvable(cls, seen: RecordScales) -> dict[str, tuple[float, float]]:
        """Ranges of parameters, by name, within which the samples of these records can tell them.

        Parameters that are not named keep their bounds.
        """
        del seen
        return {}

    @classmethod
    def from_simple(cls, simple: Effect, record: Record, plant: Model) -> tuple[Self, ...]:
        """Starting values next to the cause's simple law, as it was fitted."""
        del simple
        return cls.guess(record, plant)

    def simple_values(self) -> dict[str, float]:
        """Values of parameters of the cause's simple law, by name, at which that law is nearest to this one.

        Parameters that both laws have need not be named.
        """
        return {}

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """The model to start from with this effect, which has fewer numbers, in the place of another one of its effects
        that may imitate it; None where it cannot.

        Args:
            other: an effect of the model.
            model: as it was fitted.
        """
        del other, model
        return None

    def zero_in(self, model: Model) -> float:
        """Position [m] in a fitted model, one of whose effects it takes the place of, from which it counts."""
        del model
        return 0.0

    @classmethod
    def is_all_of(cls, other: Effect, model: Model) -> bool:
        """Whether another effect of the model, with the values that it has, comes to this one and nothing more."""
        del other, model
        return False

    def neighbours(self, records: Sequence[Record]) -> tuple[Self, ...]:
        """Where a fit that ended here may find deeper valleys next to its own; none unless the effect is known for it.

        Args:
            records: the measurements that it was fitted to.
        """
        del records
        return ()

    def by_lot(self, rng: np.random.Generator, record: Record, plant: Model) -> Self:
        """The law with numbers that a rig may have: any angle, either sign, all else up to ``LOT`` times more or less.

        Args:
            rng: draws them.
            record, plant: as of ``guess``, from which this one comes.
        """
        del record, plant
        drawn = []
        for parameter, value in zip(self.parameters, self.values, strict=True):
            factor = math.exp(rng.uniform(-math.log(LOT), math.log(LOT)))
            sign = 1.0 if parameter.lower == 0.0 or rng.random() < 0.5 else -1.0
            angle = rng.uniform(-math.pi, math.pi)
            drawn.append(angle if parameter.is_phase else sign * factor * value)
        return self.within_bounds(*drawn)

    @classmethod
    def laws(cls) -> dict[str, Callable[..., float]]:
        """The compiled-in laws that this effect has, by kind."""
        kinds = (*KINDS, *(f"reversal_{m}" for m, _ in cls.memory))
        return {kind: cast("Callable[..., float]", law) for kind in kinds if (law := _static(cls, kind)) is not None}


@cache
def arguments(law: Callable[..., float]) -> tuple[str, ...]:
    """Names of what a law is a function of."""
    return tuple(inspect.signature(law).parameters)


def _static(cls: type[Effect], kind: str) -> Any:
    return getattr(cls, kind, None)

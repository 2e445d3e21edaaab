"""What an effect declares about its law, and what kind of law follows from that."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, ClassVar, Literal, cast

from msd_ident.model.declarations import PLACE, Harmonic, Parameter

#: Names that a law may take as arguments besides parameter and memory names.
ARGUMENTS = (
    "t", "x", "v", "speed", "direction", "spring_force", "driven", "lagged_v", "second_v", "u", "net", "piece_x",
)  # fmt: skip

#: Those of a force law that make it depend on more than the place.
_NOT_PLACE = frozenset(ARGUMENTS) - {"x", "piece_x"}

#: Sides of a knee, see ``Effect.knee``.
BOTH, ABOVE, OUTSIDE = "both", "above", "outside"
#: Knee of a law that is not smooth at x = 0.
AT_ZERO = ("0", "0", ABOVE)

#: What an effect without a law of its own is to the structure, see ``Effect.structure``.
PLAY, LAG, DELAY, SECOND_MASS, COMMAND_LOOP = "play", "lag", "delay", "second mass", "command loop"
#: How many of such an effect's parameters, the first ones, the structure has.
STRUCTURAL = {PLAY: 1, LAG: 1, DELAY: 1, SECOND_MASS: 3, COMMAND_LOOP: 2}
#: Beside a law: its ``lagged_v`` [m/s] follows the velocity, from 0 at the start, with the effect's last parameter [s]
#: as time constant. Several effects may have it, all with one name for the time constant and of one family.
VELOCITY_LAG = "velocity lag"

#: As the amplitude falls, the damping ratio rises, or falls; the frequency rises, or falls: see ``Effect.ring_down``.
RUBS, DRAGS, SOFTENS, HARDENS = "rubs", "drags", "softens", "hardens"

#: Kinds of law that an effect may have, see ``Effect``.
KINDS = (
    "constant",
    "disturbance",
    "force",
    "friction",
    "breakaway",
    "second_force",
    "contact",
    "contact_at_rest",
    "grip",
    "input_map",
    "reading",
)


class Law:
    """What every effect declares, with the defaults; ``base.Effect`` says what each law is given."""

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
    #: Person, or persons joined by hyphens, whom its name holds, as people write them.
    eponym: ClassVar[str] = ""
    #: Its position is an angle: it means nothing on a slide.
    angular: ClassVar[bool] = False
    #: It only ever takes energy out of the motion.
    dissipative: ClassVar[bool] = False
    #: The place of rest settles after a push: over one decay it moves as this law of another cause does.
    creeps_as: ClassVar[str] = ""
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
    #: Its part in the structure, that of one effect of a model. Its first parameters are, in this order and with the
    #: same names in all effects that have this part: ``PLAY`` of the spring (half of it [m]), ``LAG`` of the force
    #: (time constant [s]), ``DELAY`` of the force ([s]), ``SECOND_MASS`` on the first (mass [kg], stiffness [N/m],
    #: damping [N·s/m] between them), ``COMMAND_LOOP`` of the force (half its width [N], the change of the command that
    #: crosses it [N]). Empty for an effect with a law, but for ``VELOCITY_LAG`` and for a ``SECOND_MASS`` with a force
    #: on it.
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

    @classmethod
    def ages(cls) -> bool:
        """Whether it changes the linear spring, or what takes energy out, with time."""
        return not cls.steady and (cls.needs_spring or cls.dissipative)

    @classmethod
    def ages_spring(cls) -> bool:
        """Whether it changes the linear spring with time."""
        return cls.needs_spring and not cls.steady

    @classmethod
    def ripple(cls) -> Harmonic | None:
        """Its only term, if that is a harmonic one over the travel."""
        return cls.harmonic if cls.harmonic is not None and cls.harmonic.over == PLACE and not cls.form_of else None

    @classmethod
    def remembers(cls) -> bool:
        """Whether its force depends on more than time, position and velocity of the instant."""
        return bool(cls.memory) or cls.structure in (LAG, DELAY, SECOND_MASS, COMMAND_LOOP, VELOCITY_LAG)

    @classmethod
    def asks_drive(cls) -> bool:
        """Whether its force depends on the one that is commanded, or on whether any is."""
        force = cls.laws().get("force")
        return force is not None and not {"driven", "u"}.isdisjoint(arguments(force))

    @classmethod
    def asks_speed(cls) -> bool:
        """Whether its force or friction depends on how fast the cart is, and not on its direction alone."""
        acting = [law for kind, law in cls.laws().items() if kind in ("force", "friction", "contact")]
        return any({"v", "speed", "lagged_v"} & set(arguments(law)) for law in acting)

    @classmethod
    def is_curve_over_speed(cls) -> bool:
        """Whether its force depends on the speed alone, and is against the motion alike in both directions."""
        laws = cls.laws()
        given = {name for law in laws.values() for name in arguments(law)} & set(ARGUMENTS)
        dry = set(laws) <= {"force", "friction", "breakaway"} and bool(set(laws) & {"force", "friction"})
        return dry and cls.mirror and given <= {"v", "speed", "direction"} and not (cls.memory or cls.structure)

    @classmethod
    def cause(cls) -> str:
        """Name of the cause that acts where this law does."""
        return cls.form_of or cls.name

    @classmethod
    def alike(cls, other: type[Law]) -> bool:
        """Whether both are laws of one cause, one may be mistaken for the other's cause, or both for the same cause."""
        mistaken = cls.cause() in other.mistaken_for or other.cause() in cls.mistaken_for
        same = not set(cls.mistaken_for).isdisjoint(other.mistaken_for)
        return cls.cause() == other.cause() or mistaken or same

    @classmethod
    def has_knee(cls) -> bool:
        """Whether its spring bends somewhere else than at zero: a stop, or another slope beyond a place."""
        return cls.knee not in (None, AT_ZERO)

    @classmethod
    def stops(cls) -> bool:
        """Whether its spring pushes beyond a place and never pulls, unlike one that may bend either way."""
        stiffness = cls.knee[1] if cls.knee is not None and cls.has_knee() else ""
        return any(parameter.name == stiffness and parameter.lower >= 0.0 for parameter in cls.parameters)

    @classmethod
    def placed(cls) -> bool:
        """Whether its force depends on where the cart is, so that a position's zero is seen without a spring too."""
        laws = [law for kind, law in cls.laws().items() if kind in ("force", "friction", "contact")]
        return cls.has_knee() or (not cls.memory and any("x" in arguments(law) for law in laws))

    @classmethod
    def is_scale(cls) -> bool:
        """Whether its reading is a curve over the position: a sensor of another shape."""
        reading = cls.laws().get("reading")
        given = arguments(reading) if reading is not None else ()
        return "x" in given and "t" not in given

    @classmethod
    def filters_force(cls) -> bool:
        """Whether it is linear and changes how the force gets to the reading: late, slowly, or past the mass."""
        reading = cls.laws().get("reading")
        return cls.structure in (LAG, DELAY) or (reading is not None and "u" in arguments(reading))

    @classmethod
    def bends_as(cls, other: type[Law]) -> bool:
        """Whether both are curves over the position, of the spring or of the sensor, or linear filters of the force:
        two of them come near a third.
        """
        alike = (
            (cls.is_spring, other.is_spring),
            (cls.is_scale, other.is_scale),
            (cls.filters_force, other.filters_force),
        )
        return any(one() and two() for one, two in alike)

    @classmethod
    def is_spring(cls) -> bool:
        """Whether its force is a curve over the position: a spring of another shape."""
        bends = cls.structure == PLAY or cls.has_knee()
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
        if cls.acts_on == "input" or (cls.structure == SECOND_MASS and not cls.laws()):
            return True
        steady = cls.structure == VELOCITY_LAG and not cls.asks_drive()
        given = set(cls.laws())
        return steady or (not cls.structure and bool(given) and given <= {"constant", "disturbance"})

    @classmethod
    def is_linear(cls) -> bool:
        """Whether all its parameters enter the equation of motion linearly."""
        return all(parameter.regressor for parameter in cls.parameters)

    @classmethod
    def laws(cls) -> dict[str, Callable[..., float]]:
        """The compiled-in laws that this effect has, by kind."""
        kinds = (*KINDS, *(f"reversal_{m}" for m, _ in cls.memory))
        return {kind: cast("Callable[..., float]", law) for kind in kinds if (law := _static(cls, kind)) is not None}


@cache
def arguments(law: Callable[..., float]) -> tuple[str, ...]:
    """Names of what a law is a function of."""
    return tuple(inspect.signature(law).parameters)


def _static(cls: type[Law], kind: str) -> Any:
    return getattr(cls, kind, None)

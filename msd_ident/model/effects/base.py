"""What every physical effect says about itself."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from msd_ident.errors import UsageError
from msd_ident.model.declarations import PLACE, TIME, RecordScales
from msd_ident.model.effects.law import ABOVE, ARGUMENTS, AT_ZERO, BOTH, OUTSIDE, Law, arguments

if TYPE_CHECKING:
    import numpy as np
    from typing_extensions import Self

    from msd_ident.data.record import Record
    from msd_ident.model.plant import FloatArray, Model

#: Factor by which the numbers of a law drawn by lot are larger or smaller than where a search would start.
LOT = 5.0


class Effect(Law):
    """Base of all effects: a frozen dataclass whose fields are its parameters.

    Every effect sets ``name`` (that of its file), ``parameters``, ``acts_on``, ``law``, ``source``, ``neutral`` and
    ``guess``; all else has a default. The docstrings of its module, of its class and of ``guess`` stand on its page of
    the documentation.

    A law is a static method that numba can compile; its argument names say what it is given: the time
    ``t`` [s], position ``x`` [m], velocity ``v`` [m/s], ``speed`` = abs(v), ``direction`` = the sign of the
    motion (0 at rest), ``spring_force`` [N] of the linear spring (behind its backlash), ``driven`` (1 while a force is
    commanded, else 0), ``lagged_v`` [m/s] (see ``VELOCITY_LAG``), ``second_v`` [m/s] of the second mass, a commanded
    force ``u`` [N], the ``net`` force [N], ``piece_x`` [m], a place on the same side of all knees as the step (see
    ``knee``), any parameter of the effect or of the plant, any of its ``memory``. A force that begins with a jump at a
    knee asks ``piece_x`` whether it acts: a step that ends at the knee must not see beyond it.
    Exports copy a law's source, so it uses nothing but its arguments, ``math`` and built-in functions.
    The kernel looks for

    - ``force(...)`` [N]: on the left-hand side of m x'' + b x' + k x + force = F, smooth between guards;
    - ``constant(...)`` [N]: the same for a force that depends on parameters alone;
    - ``disturbance(t, ...)`` [N]: the same for a force that depends on time alone;
    - ``friction(...)`` [N]: dry friction while sliding, against the motion, and ``breakaway(...)`` [N] at rest;
    - ``second_force(...)`` [N]: against the second mass alone, beside what it hangs on;
    - ``reversal_NAME(...)``: the new value of NAME in ``memory`` when the motion turns at x, one function for each
      name: all are given the values before the turn and the ``direction`` that ends. A record begins with such a call,
      in which ``direction`` is 0;
    - ``contact(...)`` [N]: the force that moves the mass, of the ``net`` force on the cart, dry friction included,
      while it moves: what a contact leaves of it, or what does the same to another inertia;
      ``contact_at_rest(...)`` [N]: what dry friction has to hold of the net force of all else at rest;
    - ``grip(...)``: of a force with two formulas beyond its knee, tells by its sign which one holds;
    - ``input_map(...)`` [N]: the force that a commanded ``u`` becomes, at ``t`` too if the law is not ``steady``;
    - ``reading(...)`` [m]: what the sensor makes of x, while a force ``u`` [N] is on the cart.

    Of several maps or readings in a model, each is given what the one before made, in the order of their names.

    An effect without any of these changes the structure (backlash, lag, time offset, ...), names its part in that as
    ``structure``, and the kernel itself carries it.
    """

    def __post_init__(self) -> None:
        for parameter in self.parameters:
            value = float(getattr(self, parameter.name))
            object.__setattr__(self, parameter.name, value)
            if math.isnan(value) or not parameter.lower <= value <= parameter.upper:
                raise UsageError(
                    f"{self.name}: {parameter.name} is {value:g} {parameter.unit}; expected "
                    f"{parameter.lower:g} to {parameter.upper:g} {parameter.unit}"
                )

    @cached_property
    def values(self) -> tuple[float, ...]:
        """Parameter values in the order of ``parameters``."""
        return tuple(float(getattr(self, parameter.name)) for parameter in self.parameters)

    @classmethod
    def curve_over_speed(cls) -> Callable[[float, Sequence[float]], float]:
        """Force [N] against a motion in the positive direction, of a speed [m/s] and the effect's values, for a law of
        the speed alone (``is_curve_over_speed``).
        """
        names = [parameter.name for parameter in cls.parameters]
        given = {"v": 0, "speed": 0, "direction": 1} | {name: 2 + i for i, name in enumerate(names)}
        acting = [law for kind, law in cls.laws().items() if kind in ("force", "friction")]
        terms = [(law, [given[name] for name in arguments(law)]) for law in acting]

        def force(speed: float, values: Sequence[float]) -> float:
            known = (speed, 1.0, *values)
            return sum(law(*[known[place] for place in places]) for law, places in terms)

        return force

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
        return self._law_value(law, {"v": speed, "speed": speed, "direction": 1.0})

    def _law_value(self, law: Callable[..., float], given: Mapping[str, float]) -> float:
        """What a law of it is with its values, as the motion begins; arguments that are not given are 0."""
        values = {p.name: value for p, value in zip(self.parameters, self.values, strict=True)}
        known = {**dict.fromkeys(ARGUMENTS, 0.0), **values, **dict(self.memory), **given}
        return float(law(*(known[name] for name in arguments(law))))

    def knee_places(self) -> tuple[tuple[float, float], ...]:
        """Position [m] of each of its knees, and the sign of the side that is beyond (see ``Law.knee``)."""
        if self.knee is None or self.knee == AT_ZERO:
            return ()
        place, side = float(getattr(self, self.knee[0])), self.knee[2]
        if side in (BOTH, ABOVE, OUTSIDE):
            above = (place, math.copysign(1.0, place) if side == OUTSIDE else 1.0)
            return (above, (-place, -1.0)) if side == BOTH else (above,)
        reach = float(getattr(self, side))
        return (place + reach, 1.0), (place - reach, -1.0)

    def begins_with(self, x: float, v: float, net: float) -> float:
        """Jump of its force [N] where a motion at v [m/s] passes a knee at x [m]; ``net``: all other forces [N]."""
        ahead = math.copysign(1.0, v)
        beyond = x + ahead * (1.0 + abs(x))
        given = {"x": x, "v": v, "speed": abs(v), "direction": ahead, "net": net, "piece_x": beyond}
        laws, without = self.laws(), {"force": 0.0, "contact": net}
        return sum(self._law_value(laws[kind], given) - before for kind, before in without.items() if kind in laws)

    def keeps_gain(self) -> bool:
        """Whether some range of commands acts on the plant with a gain of 1, change for change."""
        return True

    def pushes(self, u: float, t: float = 0.0) -> float:
        """Force [N] that it makes of a command u [N] at a time t [s]."""
        law = self.laws().get("input_map")
        if law is None:
            return u
        return self._law_value(law, {"u": u, "t": t})

    def longest_period(self) -> float:
        """Longest period [s] of a motion that it brings by itself; 0 if it brings none."""
        least = min((abs(frequency) for frequency in self.tones()), default=math.inf)
        return 2.0 * math.pi / least if least > 0.0 else math.inf

    @classmethod
    def belongs_to_a_place(cls) -> bool:
        """Whether it acts like a spring or a stop at a place that does not come again, turn for turn."""
        repeats = cls.angular or (cls.harmonic is not None and cls.harmonic.over == PLACE)
        return (cls.is_spring() or cls.stops()) and not repeats

    def repeats_after(self) -> float:
        """Pitch [m] of what it repeats along the travel, of several their rms by power; 0 if it repeats nothing."""
        return float(getattr(self, self.harmonic.scanned)) if self.harmonic and self.harmonic.over == PLACE else 0.0

    def tones(self) -> tuple[float, ...]:
        """Angular frequencies [rad/s] of its harmonic terms over time."""
        if self.harmonic is None or self.harmonic.over != TIME:
            return ()
        return (float(getattr(self, self.harmonic.scanned)),)

    def idle(self) -> frozenset[str]:
        """Parameters that are not to be fitted: they state something, or stand for the absence of a part of the effect
        (a limit at infinity).
        """
        pairs = zip(self.parameters, self.values, strict=True)
        return frozenset(parameter.name for parameter, value in pairs if math.isinf(value)) | frozenset(self.held)

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

    @classmethod
    def from_simple_and_residual(
        cls, simple: Effect, record: Record, plant: Model, residual: FloatArray
    ) -> tuple[Self, ...]:
        """The same, where what a model with the simple law leaves tells more: ``residual`` (n,), model − data [m]."""
        del residual
        return cls.from_simple(simple, record, plant)

    def simple_values(self) -> dict[str, float]:
        """Values of parameters of the cause's simple law, by name, at which that law is nearest to this one.

        Parameters that both laws have need not be named.
        """
        return {}

    @classmethod
    def in_place_of(cls, other: Effect, model: Model) -> Model | None:
        """The model to start from with this effect, which has no more numbers, in the place of another one of its
        effects that may imitate it; None where it cannot.

        Args:
            other: an effect of the model.
            model: as it was fitted.
        """
        del other, model
        return None

    @classmethod
    def moving_as(cls, other: Effect, model: Model) -> Effect | None:
        """This law in the place of an effect of a fitted model, whose motion it gives where the mass carries little of
        the force; None where it never does.

        Args:
            other: an effect of the model, of another cause.
            model: as it was fitted.
        """
        del other, model
        return None

    def may_be(self, speed: float, exact: bool) -> tuple[str, ...]:
        """Causes of which it may be another form with its present values, the simplest first.

        Args:
            speed: that the motion reaches at most [m/s].
            exact: whether the model leaves only noise.
        """
        del speed, exact
        return ()

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
            sign = 1.0 if parameter.lower >= 0.0 or rng.random() < 0.5 else -1.0
            angle = rng.uniform(-math.pi, math.pi)
            drawn.append(angle if parameter.is_phase else sign * factor * value)
        return self.within_bounds(*drawn)

"""Plant and Model: m x'' + b x' + k x + effects = F, built by adding."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from msd_ident.errors import UsageError
from msd_ident.model.declarations import Parameter
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import STRUCTURAL

FloatArray = npt.NDArray[np.float64]

PLANT_PARAMETERS = (
    Parameter(
        "mass", "m", "kg", 0.0, math.inf, "moving mass",
        advice="weigh the moving mass, or shake it at high frequency", inertia=True,
    ),
    Parameter(
        "damping", "b", "N·s/m", 0.0, math.inf, "viscous damping",
        advice="let it ring down over amplitudes of at least 3:1", most=1e3,
    ),
    Parameter(
        "stiffness", "k", "N/m", 0.0, math.inf, "spring stiffness",
        advice="hold a constant force until it rests",
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Model:
    """A mass on a linear spring and damper, with any effects that go together.

    Attributes:
        mass: m [kg], above 0.
        damping: b [N·s/m].
        stiffness: k [N/m], 0 where there is no spring.
        effects: what else acts; kept in the order of their names.

    Raises:
        UsageError: a value outside its bounds, or effects that make no sense together.
    """

    mass: float
    damping: float
    stiffness: float
    effects: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        for parameter in PLANT_PARAMETERS:
            value = float(getattr(self, parameter.name))
            object.__setattr__(self, parameter.name, value)
            if not (parameter.lower <= value < math.inf) or (parameter.name == "mass" and value == 0.0):
                raise UsageError(
                    f"plant: {parameter.name} is {value:g} {parameter.unit}; expected a finite value "
                    f"{'above' if parameter.name == 'mass' else 'from'} 0"
                )
        object.__setattr__(self, "effects", tuple(sorted(self.effects, key=lambda effect: effect.name)))
        _check_together(self.effects)

    def __add__(self, effect: Effect) -> Model:
        if not isinstance(effect, Effect):
            return NotImplemented
        if effect.needs_spring and self.stiffness == 0.0:
            raise UsageError(
                f"{effect.name} acts on the spring, and the plant has none (stiffness 0); expected a stiffness "
                f"above 0: give the plant a spring or drop {effect.name}"
            )
        return replace(self, effects=(*self.effects, effect))

    @cached_property
    def effect_names(self) -> tuple[str, ...]:
        """Canonical names of the effects, sorted."""
        return tuple(effect.name for effect in self.effects)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """All parameters: mass, damping, stiffness, then those of each effect in turn."""
        return PLANT_PARAMETERS + tuple(p for effect in self.effects for p in effect.parameters)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of ``parameters``."""
        return tuple(parameter.name for parameter in self.parameters)

    @cached_property
    def values(self) -> FloatArray:
        """Values of ``parameters``, (p,); not to be written to."""
        own = (self.mass, self.damping, self.stiffness)
        values = np.array(own + tuple(v for effect in self.effects for v in effect.values), dtype=np.float64)
        values.setflags(write=False)
        return values

    def with_values(self, values: Mapping[str, float] | npt.ArrayLike) -> Model:
        """The same model with other values: some by name, or all in the order of ``names``."""
        new = dict(zip(self.names, self.values.tolist(), strict=True))
        if isinstance(values, Mapping):
            for name, value in values.items():
                if name not in new:
                    raise UsageError(f"the model has no parameter {name!r}; expected one of {', '.join(new)}")
                new[name] = float(value)
        else:
            vector = np.asarray(values, dtype=np.float64)
            if vector.shape != (len(new),):
                raise UsageError(f"{vector.size} values for {len(new)} parameters; expected {', '.join(new)}")
            new = dict(zip(new, vector.tolist(), strict=True))
        return Model(
            mass=new["mass"],
            damping=new["damping"],
            stiffness=new["stiffness"],
            effects=tuple(type(effect).from_values(new) for effect in self.effects),
        )

    def without(self, *names: str) -> Model:
        """The same model without the effects of these names."""
        return replace(self, effects=tuple(effect for effect in self.effects if effect.name not in names))

    def has(self, name: str) -> bool:
        """Whether an effect of this name acts."""
        return name in self.effect_names

    def structure(self, role: str) -> tuple[float, ...]:
        """Values in the structure of the effect with this part (``Effect.structure``); empty where none has it."""
        return next((one.values[: STRUCTURAL.get(role)] for one in self.effects if one.structure == role), ())

    def effect(self, name: str) -> Effect:
        """The effect of this name."""
        for effect in self.effects:
            if effect.name == name:
                return effect
        raise UsageError(f"the model has no effect {name!r}; it has {', '.join(self.effect_names) or 'none'}")

    def __getitem__(self, name: str) -> float:
        for parameter, value in zip(self.parameters, self.values, strict=True):
            if parameter.name == name:
                return float(value)
        raise UsageError(f"the model has no parameter {name!r}; expected one of {', '.join(self.names)}")


def Plant(mass: float, damping: float, stiffness: float) -> Model:  # noqa: N802 - reads as the thing it makes
    """The bare plant m x'' + b x' + k x = F; add effects with ``+``."""
    return Model(mass=mass, damping=damping, stiffness=stiffness)


def _check_together(effects: tuple[Effect, ...]) -> None:
    for first, second in zip(effects, effects[1:], strict=False):
        if first.name == second.name:
            raise UsageError(f"{first.name} stands in the model twice; expected once: change its values instead")
    for i, one in enumerate(effects):
        for other in effects[i + 1 :]:
            shared = one.family if one.family == other.family else ""
            shared = shared or (one.cause().replace("_", " ") if one.cause() == other.cause() else "")
            if shared:
                raise UsageError(
                    f"{one.name} and {other.name} are both {shared} laws; expected one at most: "
                    f"drop {one.name} or {other.name}"
                )

"""What is exported: a saved model with the choices that every target shares."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from msd_ident.errors import UsageError
from msd_ident.estimate.parameter_units import unit_in
from msd_ident.model import Model
from msd_ident.model.parameters import PARAMETERS
from msd_ident.workflow.saved_model import ONLY_RATIOS, SavedModel

if TYPE_CHECKING:
    from msd_ident.export.posterior import Draws

#: Position unit → how a joint of that unit moves.
MOTIONS = {"m": "prismatic", "rad": "revolute"}
#: Forces that are newtons, or newton metres.
FORCES = ("N", "N·m")


@dataclass(frozen=True)
class Plan:
    """A model on its way into a file.

    Attributes:
        saved: the result that it comes from.
        model: what is written: that of the result, or the nearest that the target can say.
        joint: name of the joint.
        zero: position of the joint at which the spring is relaxed, in the position unit; readings are joint positions.
        period: sample period of the record [s].
        steps: steps of a solver for each sample period of the record.
        force_scale: newtons per force unit of the record, where a mass was given later; 1 otherwise.
        rows: lines for the header: how the target carries each effect, and what was put in place of others.
        draws: parameter sets, where the target writes some.
    """

    saved: SavedModel
    model: Model
    joint: str = "x"
    zero: float = 0.0
    period: float = 1e-3
    steps: int = 1
    force_scale: float = 1.0
    rows: tuple[str, ...] = ()
    draws: Draws | None = None

    @property
    def step(self) -> float:
        """Time step of a solver [s]."""
        return self.period / self.steps

    @property
    def revolute(self) -> bool:
        """Whether the joint turns."""
        return self.saved.position_unit == "rad"

    @cached_property
    def values(self) -> dict[str, float]:
        """Parameter name → value of what is written."""
        return dict(zip(self.model.names, self.model.values.tolist(), strict=True))

    def value(self, name: str, otherwise: float = 0.0) -> float:
        """Value of a parameter of the written model.

        Args:
            name: of the parameter.
            otherwise: returned if the model does not have it.
        """
        return self.values.get(name, otherwise)


def check_units(saved: SavedModel) -> None:
    """Refuse positions that no joint has.

    Raises:
        UsageError: the result is neither in metres nor in radians.
    """
    if saved.position_unit not in MOTIONS:
        raise UsageError(
            f"the result's positions are in {saved.position_unit}; expected m or rad, which a joint moves in: identify "
            "again with --position-scale and --position-unit"
        )


def check_joint(name: str) -> None:
    """Refuse a joint's name that no file can hold.

    Raises:
        UsageError: it is empty, or holds signs that cannot be printed.
    """
    if not name.strip() or not name.isprintable():
        raise UsageError(f"--joint {name!r}; expected a name that can be read: give the joint's own, e.g. --joint cart")


def check_scale(saved: SavedModel, target: str, instead: str) -> None:
    """Refuse a target that needs newtons where the result has none.

    Args:
        saved: the result.
        target: name of the target.
        instead: targets whose motion is right all the same.

    Raises:
        UsageError: forces are in volts and the like, or those of an assumed mass.
    """
    if saved.force_unit not in FORCES:
        found = f"forces are in {saved.force_unit}"
    elif saved.scale_assumed:
        found = ONLY_RATIOS
    else:
        return
    raise UsageError(
        f"{target} needs newtons, and in this result {found}; expected a force scale: give the moving mass with "
        f"--mass, or export to {instead}, whose motion is right without"
    )


def scaled(saved: SavedModel, mass: float) -> tuple[Model, float]:
    """The model in newtons, from a mass that the user gives for a result without a force scale.

    Args:
        saved: the result.
        mass: moving mass [kg], or moment of inertia [kg·m²].

    Returns:
        The model with this mass and all forces scaled with it, and newtons per force unit of the record.

    Raises:
        UsageError: the mass is not positive and finite.
    """
    if not 0.0 < mass < math.inf:
        raise UsageError(f"the mass is {mass:g}; expected more than 0, e.g. --mass 0.94")
    factor = mass / saved.model.mass
    values = dict(zip(saved.model.names, saved.model.values.tolist(), strict=True))
    for parameter in saved.model.parameters:
        power = force_power(parameter.unit)
        if power and math.isfinite(values[parameter.name]):
            values[parameter.name] *= factor**power
    return saved.model.with_values(values), factor


def in_newtons(saved: SavedModel) -> SavedModel:
    """The same result with newtons as the unit of its forces, and the units of its parameters that follow from it.

    Its values stay those of the record's force unit: ``scaled`` converts them.
    """
    told = replace(saved, force_unit="N" if saved.position_unit == "m" else "N·m", scale_assumed=False)
    units = {name: unit_in(PARAMETERS[name].unit, told) for name in told.parameters if name in PARAMETERS}
    parameters = {name: replace(own, unit=units.get(name, own.unit)) for name, own in told.parameters.items()}
    return replace(told, parameters=parameters)


def force_power(unit: str) -> int:
    """How often a unit has the force in it: 1 for N, kg and N/m, -1 for 1/N, 0 for m."""
    above, _, below = unit.partition("/")
    return _forces(above) - _forces(below)


def _forces(part: str) -> int:
    return sum(factor.rstrip("²³") in ("N", "kg") for factor in part.split("·"))

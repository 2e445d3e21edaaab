"""The linear part of a model as a transfer function, and the paper's standard form (equations 10 to 13)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from msd_ident.errors import UsageError
from msd_ident.model.effects.law import LAG, SECOND_MASS, VELOCITY_LAG
from msd_ident.model.plant import Model, Plant

if TYPE_CHECKING:
    import control


@dataclass(frozen=True)
class LinearForm:
    """x''/ωn² + (2ζ/ωn) x' + x = K F, equation 10.

    Attributes:
        natural_frequency: ωn [rad/s].
        damping_ratio: ζ.
        static_gain: K [m/N].
    """

    natural_frequency: float
    damping_ratio: float
    static_gain: float


def standard_form(mass: float, damping: float, stiffness: float) -> LinearForm:
    """Standard form of m [kg], b [N·s/m], k [N/m]: equations 11, 12 and 13.

    Raises:
        UsageError: mass or stiffness is not above 0, so there is no natural frequency or no static gain.
    """
    if not (mass > 0.0 and stiffness > 0.0):
        raise UsageError(
            f"mass {mass:g} kg and stiffness {stiffness:g} N/m have no standard form; expected both above 0: "
            "a plant without a spring has no static gain"
        )
    omega = math.sqrt(stiffness / mass)
    return LinearForm(omega, 0.5 * omega * damping / stiffness, 1.0 / stiffness)


def physical(form: LinearForm) -> Model:
    """The plant of a standard form, the same equations backwards."""
    stiffness = 1.0 / form.static_gain
    return Plant(
        mass=stiffness / form.natural_frequency**2,
        damping=2.0 * form.damping_ratio * stiffness / form.natural_frequency,
        stiffness=stiffness,
    )


def transfer_function(model: Model) -> control.TransferFunction:
    """Position over commanded force of all that is linear in the model: plant, second mode, relaxing spring, lag.

    Dry friction and every other effect are left out.
    """
    import control

    s = control.tf("s")
    impedance = model["mass"] * s**2 + model["damping"] * s + model["stiffness"]
    if second := model.structure(SECOND_MASS):
        m2, k2, b2 = second
        coupling = b2 * s + k2
        impedance = impedance + coupling * (m2 * s**2) / (m2 * s**2 + coupling)
    for effect in model.effects:
        if effect.structure == VELOCITY_LAG and not effect.asks_drive():
            damping, time_constant = effect.values
            impedance = impedance + damping * s / (time_constant * s + 1)
    plant = 1 / impedance
    for time_constant in model.structure(LAG):
        plant = plant / (time_constant * s + 1)
    return plant

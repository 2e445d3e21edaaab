"""What counts as the truth about a rig: its effects, and what is the same thing in every experiment of this kind.

``docs/identities.md`` has the reasons.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

#: Effects that bend the spring, so that its zero can be seen.
BENDING = frozenset({"cubic_spring", "asymmetric_spring", "backlash", "end_stop", "cogging"})
#: Laws of dry friction.
DRY = frozenset(
    {"coulomb_friction", "stribeck_friction", "position_dependent_friction", "hysteresis", "load_dependent_friction"}
)

#: What may be said of rigs whose law the library does not have: the effects of the same family.
FAMILIES: Mapping[str, frozenset[str]] = {
    "friction_change": DRY,
    "fading_friction": DRY,
    "eccentric_friction": DRY,
    "mass_drop": frozenset(),
    "magnet": frozenset({"cubic_spring", "asymmetric_spring", "force_offset"}),
    "loose_cable": frozenset(),
    "creeping_spring": frozenset({"hysteresis"}),
    "coarse_actuator": frozenset({"force_gain_nonlinearity"}),
    "encoder_slip": frozenset({"sensor_drift"}),
    # Variants: any law of the family, and what stands for a part of it.
    "rational_stribeck": DRY,
    "exponential_stribeck": DRY,
    "load_friction": DRY,
    "one_sided_stop": frozenset({"end_stop", "bilinear_spring"}),
    "damped_stop": frozenset({"end_stop"}),
    "power_drag": frozenset({"quadratic_drag"}),
    "one_way_damping": frozenset({"direction_dependent_damping"}),
    "drive_brake": frozenset({"drive_damping"}),
    "two_slope_spring": frozenset({"bilinear_spring"}),
    "settling_stiffness": frozenset({"stiffness_drift"}),
    "two_tone_disturbance": frozenset({"periodic_disturbance"}),
    "soft_saturation": frozenset({"force_gain_nonlinearity"}),
    "settling_sensor": frozenset({"sensor_drift"}),
    "sensor_eccentricity": frozenset({"sensor_eccentricity"}),
    "band_limited_force": frozenset({"time_offset", "actuator_lag"}),
}
#: Variants that are no cause: nothing needs to be named.
UNNAMED = frozenset({"band_limited_force"})


def same(effects: frozenset[str]) -> Iterator[frozenset[str]]:
    """The set itself, and all sets of effects that move the cart in the same way.

    A constant force is a shifted zero where the spring is linear. A cubic spring with a constant force is one with an
    asymmetric part about another zero.
    """
    yield effects
    if not effects & BENDING:
        yield effects ^ {"force_offset"}
    if "cubic_spring" in effects and effects & {"force_offset", "asymmetric_spring"}:
        rest = effects - {"force_offset", "asymmetric_spring"}
        yield rest | {"force_offset"}
        yield rest | {"asymmetric_spring"}
        yield rest | {"force_offset", "asymmetric_spring"}


def undecidable(effects: frozenset[str]) -> frozenset[str]:
    """Effects that are in some of the sets that are the same, and not in others."""
    sets = list(same(effects))
    return frozenset().union(*sets) - sets[0].intersection(*sets)


def allowed(effects: frozenset[str]) -> frozenset[str]:
    """All effects that are no error to name: of any set that is the same, and of the family of a law of its own."""
    own = frozenset().union(*(FAMILIES.get(effect, frozenset()) for effect in effects))
    return own.union(*same(effects))

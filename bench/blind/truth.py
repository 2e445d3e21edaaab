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

#: Foreign laws of a spring whose stiffness is that beyond a gap, and the parameters of the laws that say the same (an
#: identity: ``docs/identities.md``), which add to the stiffness in the gap.
STIFFNESS_BEYOND: Mapping[str, tuple[str, ...]] = {"soft_play": ("stop_stiffness", "buffer_stiffness")}

#: A time offset by which the force acts before its stamps, up to half a sample: a matter of the recording, which is
#: noted. To name it is no error, and not to name it neither.
EARLY_FORCE = "early_force"

#: What may be said of rigs whose law the library does not have: the effects of the same family.
FAMILIES: Mapping[str, frozenset[str]] = {
    "friction_change": DRY,
    "fading_friction": DRY,
    "eccentric_friction": DRY,
    "mass_drop": frozenset(),
    "magnet": frozenset({"cubic_spring", "asymmetric_spring", "force_offset"}),
    "loose_cable": frozenset(),
    "creeping_spring": frozenset({"relaxing_spring", "hysteresis"}),
    "coarse_actuator": frozenset({"force_gain_nonlinearity"}),
    "encoder_slip": frozenset({"sensor_drift"}),
    # Forms: any law of the family, and what stands for a part of it.
    "rational_stribeck": DRY,
    "exponential_stribeck": DRY,
    "load_friction": DRY,
    "one_sided_stop": frozenset({"end_stop", "bilinear_spring"}),
    "damped_stop": frozenset({"end_stop"}),
    "power_drag": frozenset({"quadratic_drag"}),
    "one_way_damping": frozenset({"direction_dependent_damping"}),
    "drive_brake": frozenset({"drive_damping"}),
    "slow_brake": frozenset({"drive_damping"}),
    "two_slope_spring": frozenset({"bilinear_spring"}),
    "settling_stiffness": frozenset({"stiffness_drift"}),
    "two_tone_disturbance": frozenset({"periodic_disturbance"}),
    "soft_saturation": frozenset({"force_gain_nonlinearity"}),
    "gain_drift": frozenset({"gain_drift", "stiffness_drift"}),
    "scale_drift": frozenset({"scale_drift", "stiffness_drift"}),
    "sensor_nonlinearity": frozenset({"sensor_nonlinearity"}),
    "settling_sensor": frozenset({"sensor_drift"}),
    "sensor_eccentricity": frozenset({"sensor_eccentricity"}),
    "band_limited_force": frozenset({"time_offset", "actuator_lag"}),
    # Foreign laws of dry friction, stops and springs.
    "lugre": DRY,
    "maxwell_slip": DRY,
    "arctan_stribeck": DRY,
    "tanh_sum_friction": DRY,
    "exponential_turn": DRY,
    "creeping_peak": DRY,
    "logarithmic_friction": DRY,
    "hertz_stop": frozenset({"end_stop"}),
    "padded_stop": frozenset({"end_stop", "bilinear_spring"}),
    "uneven_stops": frozenset({"end_stop"}),
    "exponential_spring": frozenset({"cubic_spring", "asymmetric_spring", "bilinear_spring"}),
    "sinh_spring": frozenset({"cubic_spring"}),
    "saturating_spring": frozenset({"cubic_spring"}),
    "three_slope_spring": frozenset({"bilinear_spring", "cubic_spring", "end_stop"}),
    "linkage_gravity": frozenset({"cubic_spring", "asymmetric_spring", "bilinear_spring", "cogging", "force_offset"}),
    "soft_play": frozenset({"backlash", "end_stop"}),
    "wandering_stiffness": frozenset({"stiffness_drift"}),
    # Of losses, drives and forces.
    "mixed_drag": frozenset({"quadratic_drag"}),
    "saturating_damping": frozenset({"quadratic_drag", "coulomb_friction"}),
    "film_damping": frozenset({"position_dependent_damping"}),
    "torque_speed": frozenset({"drive_damping"}),
    "sharp_saturation": frozenset({"force_gain_nonlinearity"}),
    "smooth_dead_zone": frozenset({"force_gain_nonlinearity"}),
    "remembering_drive": frozenset({"force_gain_nonlinearity"}),
    "second_order_drive": frozenset({"actuator_lag", "time_offset"}),
    "rate_limited_drive": frozenset({"actuator_lag", "time_offset"}),
    "trapezoid_cogging": frozenset({"cogging"}),
    "sawtooth_cogging": frozenset({"cogging"}),
    "three_tones": frozenset({"periodic_disturbance"}),
    "modulated_tone": frozenset({"periodic_disturbance"}),
    "random_force": frozenset(),
    "rubbing_second_mass": DRY | {"second_mode"},
    "sloshing_mass": frozenset({"second_mode"}),
    # Of sensors.
    "settling_and_drifting": frozenset({"sensor_drift"}),
    "walking_zero": frozenset({"sensor_drift"}),
    "missed_counts": frozenset({"sensor_drift"}),
    "elliptic_wheel": frozenset({"sensor_eccentricity"}),
    "coloured_noise": frozenset(),
    "growing_noise": frozenset(),
    "smooth_force": frozenset({"time_offset", "actuator_lag"}),
}
#: No cause of the library is right for these, or none need be named: a relative may be.
UNNAMED = frozenset(
    {
        "band_limited_force", "random_force", "walking_zero", "missed_counts", "coloured_noise", "growing_noise",
        "smooth_force",
    }
)  # fmt: skip


def same(effects: frozenset[str]) -> Iterator[frozenset[str]]:
    """The set itself, and all sets of effects that move the cart in the same way.

    A force that acts a little early counts as no effect, and as a time offset.

    A constant force is a shifted zero where the spring is linear. A cubic spring with a constant force is one with an
    asymmetric part about another zero. Stops beside a constant force are stops off the middle, which are end stops too.
    """
    if EARLY_FORCE in effects:
        yield from same(effects - {EARLY_FORCE})
        yield from same(effects - {EARLY_FORCE} | {"time_offset"})
        return
    yield effects
    if {"end_stop", "force_offset"} <= effects:
        yield effects - {"force_offset"}
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

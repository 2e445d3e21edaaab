"""What can be wrong with a rig: a table of effects, each with its law, its parameters and where it acts.

Laws stand as forces on the left-hand side of m x'' + ... = F unless they say otherwise; the compiled form is in
``kernel.py``. ``KNOWN`` are those that an identifier may be expected to name; ``ODD`` are there to see what it says of
a world that it does not know; ``VARIANTS`` are of a known family, with another law. Any of them may be combined. An
effect that brings dry friction of its own replaces the rig's ``friction_coefficient``; several such effects add up.
"""

from __future__ import annotations

import math

from msd_sim.errors import RigError
from msd_sim.parameter import RigEffect, RigParameter
from msd_sim.parameter import number as _p
from msd_sim.variants import VARIANTS


def _coulomb(
    slot: str, default: float = 0.12, name: str = "coulomb_force", meaning: str = "kinetic dry friction"
) -> RigParameter:
    return _p(name, "N", default, meaning, lower=0.0, slot=slot)


PLANT = (
    _p("mass", "kg", 0.9407, "moving mass", lower=1e-9),
    _p("damping", "N s/m", 3.927, "viscous damping", lower=0.0),
    _p("stiffness", "N/m", 694.1, "spring stiffness; 0 for a rig without a spring", lower=0.0),
)

KNOWN = (
    RigEffect(
        "coulomb_friction",
        "Fc sign(v); at rest it holds up to Fs",
        (
            _coulomb("coulomb_force"),
            _p("static_force", "N", 0.0, "breakaway force Fs; 0: the same as Fc", lower=0.0),
        ),
        dry_friction=True,
    ),
    RigEffect(
        "stribeck_friction",
        "(Fc + (Fs - Fc) exp(-(v/vs)^2)) sign(v); at rest it holds up to Fs",
        (
            _coulomb("stribeck_coulomb"),
            _p("static_force", "N", 0.3, "breakaway force Fs", lower=0.0, slot="stribeck_static"),
            _p("stribeck_velocity", "m/s", 0.02, "velocity scale vs of the drop from Fs to Fc", lower=1e-9),
        ),
        dry_friction=True,
    ),
    RigEffect(
        "position_dependent_friction",
        "Fc (1 + a x) sign(v), nowhere below 0",
        (_coulomb("position_coulomb"), _p("position_friction_slope", "1/m", 10.0, "a", slot="position_slope")),
        dry_friction=True,
    ),
    RigEffect(
        "quadratic_drag", "c v |v|", (_p("drag_coefficient", "N s^2/m^2", 3.0, "drag coefficient c", lower=0.0),)
    ),
    RigEffect("cubic_spring", "k3 x^3", (_p("cubic_stiffness", "N/m^3", 3e5, "hardening (+) or softening (-)"),)),
    RigEffect("asymmetric_spring", "k2 x^2", (_p("quadratic_stiffness", "N/m^2", 2e3, "k2"),)),
    RigEffect(
        "backlash",
        "the linear spring pulls k (x - g) beyond g, k (x + g) below -g, nothing between",
        (_p("backlash_half_width", "m", 0.002, "half-width g of the dead zone", lower=0.0),),
    ),
    RigEffect(
        "end_stop",
        "ks (x - xs) beyond xs, ks (x + xs) below -xs",
        (
            _p("stop_position", "m", 0.02, "distance xs of either stop from zero", lower=1e-9),
            _p("stop_stiffness", "N/m", 5e3, "stiffness ks of the stop", lower=0.0),
        ),
    ),
    RigEffect("force_offset", "F0", (_p("offset_force", "N", 0.5, "constant force F0 on the left-hand side"),)),
    RigEffect(
        "force_gain_nonlinearity",
        "the actuator makes F (1 + beta |F|) of a commanded F, at most Fmax either way",
        (
            _p("gain_slope", "1/N", 0.01, "beta"),
            _p("force_limit", "N", math.inf, "saturation Fmax; inf: none", lower=0.0, upper=math.inf),
        ),
        place="input",
    ),
    RigEffect("actuator_lag", "tau F' + F = commanded", (_p("lag_time", "s", 0.005, "tau", lower=0.0),), place="input"),
    RigEffect(
        "time_offset",
        "the force acts D later than its stamps say",
        (_p("time_offset", "s", 0.003, "D, either sign", slot="-"),),
        place="input",
    ),
    RigEffect(
        "hysteresis",
        "Fh z with z' = (v/L) (1 - sign(v) z), z(0) = 0 (Bouc-Wen)",
        (
            _p("hysteresis_force", "N", 0.4, "largest hysteretic force Fh", lower=0.0),
            _p("hysteresis_length", "m", 0.003, "length scale L", lower=1e-9),
        ),
    ),
    RigEffect(
        "periodic_disturbance",
        "A sin(w t + phi)",
        (
            _p("disturbance_amplitude", "N", 0.3, "A", lower=0.0),
            _p("disturbance_frequency", "rad/s", 60.0, "w", lower=0.0),
            _p("disturbance_phase", "rad", 0.0, "phi"),
        ),
    ),
    RigEffect(
        "cogging",
        "A sin(2 pi x / p + phi)",
        (
            _p("cogging_amplitude", "N", 0.3, "A", lower=0.0),
            _p("cogging_pitch", "m", 0.01, "p", lower=1e-5),
            _p("cogging_phase", "rad", 0.0, "phi"),
        ),
    ),
    RigEffect("stiffness_drift", "k (1 + r t) in place of k", (_p("stiffness_drift_rate", "1/s", 0.01, "r"),)),
    RigEffect(
        "sensor_drift", "the reading is x + r t", (_p("sensor_drift_rate", "m/s", 1e-4, "r", slot="-"),), place="sensor"
    ),
    RigEffect(
        "second_mode",
        "k2 (x - x2) + b2 (x' - x2') with m2 x2'' = k2 (x - x2) + b2 (x' - x2'), x2 starting as x",
        (
            _p("second_mass", "kg", 0.2, "m2", lower=1e-9),
            _p("second_stiffness", "N/m", 800.0, "k2", lower=0.0),
            _p("second_damping", "N s/m", 0.5, "b2", lower=0.0),
        ),
    ),
)

ODD = (
    RigEffect(
        "friction_change",
        "Fc sign(v), with another Fc from an instant on",
        (
            _coulomb("early_coulomb"),
            _coulomb("late_coulomb", 0.5, "later_coulomb_force", "dry friction after the change"),
            _p("change_time", "s", 3.0, "instant of the change", lower=0.0),
        ),
        dry_friction=True,
    ),
    RigEffect(
        "fading_friction",
        "Fc exp(-t/T) sign(v)",
        (_coulomb("fading_coulomb", 0.4), _p("fading_time", "s", 2.0, "T", lower=1e-6)),
        dry_friction=True,
    ),
    RigEffect(
        "eccentric_friction",
        "Fc (1 + a sin(2 pi x / p)) sign(v): a roller out of round",
        (
            _coulomb("eccentric_coulomb", 0.3),
            _p("eccentric_ratio", "", 0.8, "a", lower=-1.0, upper=1.0),
            _p("eccentric_pitch", "m", 0.008, "p", lower=1e-5),
        ),
        dry_friction=True,
    ),
    RigEffect(
        "mass_drop",
        "a part of the load falls off without a push",
        (
            _p("dropped_mass", "kg", 0.2, "mass that falls off", lower=0.0),
            _p("drop_time", "s", 3.0, "instant at which it does", lower=0.0),
        ),
    ),
    RigEffect(
        "magnet",
        "-C / ((d - x)^2 + g^2): pulls towards x = d",
        (
            _p("magnet_strength", "N m^2", 1e-3, "C", lower=0.0),
            _p("magnet_position", "m", 0.04, "d"),
            _p("magnet_gap", "m", 0.003, "closest approach g of the poles", lower=1e-5),
        ),
    ),
    RigEffect(
        "loose_cable",
        "c v while moving up between two places",
        (
            _p("cable_damping", "N s/m", 4.0, "c", lower=0.0),
            _p("cable_start", "m", 0.005, "lower place"),
            _p("cable_end", "m", 0.02, "upper place"),
        ),
    ),
    RigEffect(
        "creeping_spring",
        "kc in series with a dashpot, beside the spring: f' = kc v - f / T (Maxwell)",
        (_p("creep_stiffness", "N/m", 80.0, "kc", lower=0.0), _p("creep_time", "s", 0.5, "T", lower=1e-6)),
    ),
    RigEffect(
        "coarse_actuator",
        "the actuator makes only whole steps of force",
        (_p("force_step", "N", 0.5, "smallest step", lower=0.0, slot="-"),),
        place="input",
    ),
    RigEffect(
        "encoder_slip",
        "the reading jumps once, as when an encoder wheel slips",
        (
            _p("slip_distance", "m", 0.001, "size of the jump", slot="-"),
            _p("slip_time", "s", 2.0, "instant of the jump", lower=0.0, slot="-"),
        ),
        place="sensor",
    ),
)

ALL = {effect.name: effect for effect in KNOWN + ODD + VARIANTS}


def by_name(name: str) -> RigEffect:
    """The effect of that name.

    Raises:
        RigError: there is none.
    """
    if name not in ALL:
        raise RigError(f"no effect {name!r}; expected one of {', '.join(ALL)}")
    return ALL[name]

"""What is true about each measured rig: how to read its record, what acts on it, what cannot, what others published.

Transcribed from the README files beside the data, which lie outside the project (``folder()``) and stay there.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from msd_ident.io import SourceOptions
from msd_ident.model.effects import LIBRARY

#: Values of the extended model's parameters by name, from which a published value is computed.
Values = Mapping[str, float]

#: Laws of dry friction: which of them a record shows is seldom known of a real rig.
DRY = frozenset(
    {"coulomb_friction", "stribeck_friction", "hysteresis", "position_dependent_friction", "load_dependent_friction"}
)
#: Springs that bend little cannot be told apart where the motion stays on one side or the offset is free.
BENT = frozenset({"cubic_spring", "asymmetric_spring"})
#: A resting cart says that nothing shakes it.
SHAKEN = frozenset({"periodic_disturbance"})


@dataclass(frozen=True)
class Reference:
    """A value that others measured.

    Attributes:
        what: name and unit, for the table.
        low, high: ends of the published range; equal where one value stands.
        tolerance: how far outside the range a value may lie and still meet it, relative.
        of: the value of an extended model's parameters; ``KeyError`` where the model has none.
    """

    what: str
    low: float
    high: float
    tolerance: float
    of: Callable[[Values], float]

    def met(self, value: float) -> bool:
        """Whether a value lies within the range and its tolerance."""
        return (1.0 - self.tolerance) * self.low <= value <= (1.0 + self.tolerance) * self.high


@dataclass(frozen=True)
class Rig:
    """A record and the truth about it.

    Attributes:
        path: of the record, below the folder of measured data.
        options: as a user gives them on the command line.
        acts: the causes that must be named, one of each group (a tie with one counts).
        false: causes that this rig cannot have, whatever they repair in a fit. All others may be named.
        false_findings: codes of findings about the data that are not true of this record.
        references: published values.
        expert_see: SEE of a careful fit by hand with the right law, in the position unit; ``None`` where none stands.
        expert_share: the same as a part of the signal's rms.
        lacks: the law of this rig that the library does not have; its SEE is no part of the total then.
        extra: whether the row stands outside the totals.
    """

    path: str
    options: SourceOptions
    acts: tuple[frozenset[str], ...]
    false: frozenset[str]
    false_findings: frozenset[str] = frozenset()
    references: tuple[Reference, ...] = ()
    expert_see: float | None = None
    expert_share: float | None = None
    lacks: str = ""
    extra: bool = False

    @property
    def name(self) -> str:
        """File name without its ending."""
        return Path(self.path).stem


def folder() -> Path:
    """Folder of the measured data, beside the repository unless ``MSD_SHARED_DATA`` names it."""
    repository = Path(__file__).resolve().parents[2]
    return Path(os.environ.get("MSD_SHARED_DATA", repository.parent / "shared" / "data"))


def _one(name: str, value: float, tolerance: float, unit: str) -> Reference:
    """A published value of one parameter."""
    return Reference(f"{name} [{unit}]", value, value, tolerance, lambda values: values[name])


def _spring_over_mass(value: float) -> Reference:
    """k/m [1/s²], which a free decay shows to a tenth of a per cent, and a balance to one."""
    return Reference("k/m [1/s²]", value, value, 0.01, lambda values: values["stiffness"] / values["mass"])


#: Two sensors of one ECP 210: counts, of which 560 are a centimetre.
_ECP2023 = {"position": "encoder", "position_scale": 1.7857e-5}
#: The other one, which counts downwards where a positive voltage moves it.
_ECP210 = {
    "time": "time_s", "position": "encoder_counts", "position_scale": -1.0 / 56000.0, "position_unit": "m",
}  # fmt: skip
_ALL = frozenset(effect.name for effect in LIBRARY)

RIGS: tuple[Rig, ...] = (
    # Electronic mass, spring and damper: a hardening spring and a constant; the band-limited input is measured.
    Rig(
        "real/silverbox_multisine.csv",
        SourceOptions(force="V1", force_unit="V", position="V2", position_unit="V"),
        acts=(BENT,), false=DRY | SHAKEN | {"quadratic_drag", "second_mode"}, expert_see=0.29e-3,
    ),
    # Pulled by hand, let go at about 1.77 s, at rest before and after; presliding over 0.1 to 0.2 mm.
    Rig(
        "real/polimi_decay_stiff.csv", SourceOptions(force="none"), acts=(DRY,), false=SHAKEN,
        references=(
            Reference("ωn [rad/s]", 21.30, 21.30, 0.01, lambda v: (v["stiffness"] / v["mass"]) ** 0.5),
        ),
        expert_see=0.054e-3,
    ),
    # Motor current as force; spring 340 N/m and motor 2.068 N/A are known apart. Some cogging is plausible.
    Rig(
        "real/polimi_pulses_medium.csv",
        SourceOptions(force="current", force_unit="A", force_scale=-1.0, position="position_m"),
        acts=(DRY,), false=SHAKEN,
        references=(_one("stiffness", 164.5, 0.05, "A/m"), _one("mass", 0.908, 0.05, "A·s²/m")),
    ),
    # Pulled by hand and let go.
    Rig(
        "real/ecp2023_release_2.csv", SourceOptions(force="none", **_ECP2023),
        acts=(DRY,), false=_ALL - DRY, expert_see=0.26e-3,
    ),
    # The same cart, driven by a position controller: it has a spring all the same.
    Rig(
        "real/ecp2023_closed_loop.csv", SourceOptions(force="effort_v", force_unit="V", **_ECP2023),
        acts=(), false=frozenset({"cubic_spring", "end_stop"}),
        references=(Reference("stiffness [V/m]", 29.0, 30.0, 0.05, lambda values: values["stiffness"]),),
        expert_see=0.54e-3,
    ),
    # The amplifier brakes while the drive is on (ζ 0.087, then 0.043); stamps are rounded to 1 ms, nothing is lost.
    Rig(
        "real/ecp2025_11_16_25.txt",
        SourceOptions(
            time="Time", force="Control Effort", force_unit="V", position="Encoder 1 Pos", position_unit="count"
        ),
        acts=(DRY, frozenset({"drive_damping"})), false=SHAKEN, false_findings=frozenset({"missing_samples"}),
        expert_share=0.020,
    ),
    # A disc on a spring in air; the spring softens by a thousandth.
    Rig(
        "real/disc_in_air_1.csv", SourceOptions(force="none", time="time", position="position"),
        acts=(frozenset({"quadratic_drag"}),), false=DRY | SHAKEN, expert_see=0.43e-3,
    ),
    # A mass on a coil spring: viscous; the spring softens weakly. k/m from the moving mass and 24.25 N/m, weighed.
    *(
        Rig(
            f"real/hanging_spring_{name}.csv", SourceOptions(force="none"),
            acts=(), false=DRY | SHAKEN | {"cogging", "sensor_drift", "end_stop"},
            references=(_spring_over_mass(ratio),), expert_see=see,
        )
        for name, ratio, see in (("mesh", 173.57, 0.099e-3), ("disc", 167.82, 0.35e-3))
    ),
    # A cart between springs, read at 20 Hz.
    Rig(
        "real/spring_cart_1.csv", SourceOptions(force="none", position="angle_rad", position_unit="rad"),
        acts=(DRY,), false=SHAKEN, expert_see=0.054,
    ),
    # A servo without torque drops a pendulum: m·g·l·sin q softens, and the gear rubs.
    Rig(
        "real/servo_pendulum_drop.csv", SourceOptions(force="none", position="angle_rad", position_unit="rad"),
        acts=(DRY,), false=SHAKEN | {"end_stop"}, expert_see=0.010,
    ),
    # Simulated by the benchmark's authors; its β and γ differ.
    Rig(
        "real/boucwen_train.csv", SourceOptions(),
        acts=(frozenset({"hysteresis"}),), false=frozenset({"end_stop", "second_mode"}),
        references=(
            _one("mass", 2.0, 0.05, "kg"), _one("stiffness", 5e4, 0.05, "N/m"), _one("damping", 10.0, 0.2, "N·s/m"),
        ),
        expert_see=7.4e-6,
    ),
    # A ball screw without a spring; friction dominates, with an offset.
    Rig(
        "emps/emps_train.csv", SourceOptions(),
        acts=(frozenset({"coulomb_friction", "stribeck_friction"}), frozenset({"force_offset"})),
        false=BENT | {"end_stop", "stiffness_drift"},
        references=(
            _one("mass", 95.1089, 0.15, "kg"), _one("damping", 203.5034, 0.15, "N·s/m"),
            _one("coulomb_force", 20.3935, 0.15, "N"),
        ),
        expert_see=2.56e-3, extra=True,
    ),
    # A student's cart with springs, which rings down and stands.
    *(
        Rig(
            f"ecp210/{name}.csv", SourceOptions(force=force, force_unit="V", **_ECP210),
            acts=(DRY,), false=SHAKEN, extra=True,
        )
        for name, force in (("step_1", "control_effort_v"), ("step_2", "control_effort_v"), ("release_1", "none"))
    ),
)  # fmt: skip

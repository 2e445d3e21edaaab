"""Which experiment distinguishes which pair of causes: ``python -m bench.planning`` writes docs/planning.md.

Every pair on one rig, without an earlier record: A is true at the stated size, B is fitted to its motion with all
parameters free. The table has the remaining chi² divided by the duration. The experiments are those of ``msd design``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from msd_ident.design import rival_refits
from msd_ident.design.evaluation import Question
from msd_ident.design.library import TimeScale, family
from msd_ident.design.limits import Limits
from msd_ident.design.prediction import Predictor, Sensing, grid
from msd_ident.design.profile import Profile
from msd_ident.design.safety import fitted_in
from msd_ident.estimate.parameter_units import Magnitudes
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model, Plant
from msd_ident.model.effects import by_name
from msd_ident.selection.candidate_models import CandidateModel

DOCS = Path(__file__).resolve().parent.parent / "docs"
#: The design page's rig: 1 kg on 100 N/m, 0.2 mm of noise at 500 Hz; pushed with up to 10 N for up to 20 s.
PLANT = Plant(1.0, 1.0, 100.0)
SEEN = Sensing(2e-4, 0.0, 0.002)
LIMITS = Limits((-10.0, 10.0), (-0.4, 0.4), 20.0)
SIZES: Mapping[str, Mapping[str, float]] = {
    "coulomb_friction": {"coulomb_force": 0.3},
    "stribeck_friction": {"coulomb_force": 0.3, "static_force": 0.5, "stribeck_velocity": 0.05},
    "quadratic_drag": {"drag_coefficient": 1.0},
    "cubic_spring": {"cubic_stiffness": 300.0},
    "asymmetric_spring": {"quadratic_stiffness": 50.0},
    "backlash": {"backlash_half_width": 0.002},
    "force_offset": {"offset_force": 0.3},
    "force_gain_nonlinearity": {"gain_slope": 0.005, "force_limit": float("inf")},
    "actuator_lag": {"lag_time": 0.01},
    "time_offset": {"time_offset": 0.01},
    "hysteresis": {"hysteresis_force": 0.5, "hysteresis_length": 0.02},
}
#: What makes an effect small, the shares of its size that a refit starts from, and its most steps.
SHRINKING = tuple(name for sizes in SIZES.values() for name in sizes if name not in (
    "stribeck_velocity", "force_limit", "hysteresis_length",
))  # fmt: skip
STARTS, STEPS = (0.02, 0.3, 1.0), 60
PAIRS = (
    ("coulomb_friction", ""), ("quadratic_drag", "coulomb_friction"), ("quadratic_drag", "stribeck_friction"),
    ("stribeck_friction", "backlash"), ("stribeck_friction", "coulomb_friction"), ("time_offset", "actuator_lag"),
    ("cubic_spring", "force_gain_nonlinearity"), ("asymmetric_spring", "cubic_spring"),
    ("hysteresis", "coulomb_friction"), ("backlash", "time_offset"), ("force_gain_nonlinearity", ""),
    ("force_offset", ""),
)  # fmt: skip
CHOSEN = (
    "step, 3 periods", "steps both ways, 3 periods", "steps of two sizes both ways, 3 periods", "small steps both ways",
    "releases both ways", "ramp both ways with dwell, 20", "sweep, 20", "fast sweep, 20", "staircase",
    "small reversals, 3", "pseudo-random train of 0.5 periods, 20", "resonance",
)  # fmt: skip


def contender(name: str, share: float = 1.0) -> CandidateModel:
    """The plant with an effect (or without), about which nothing has been measured; of a share of the stated size."""
    values = {key: value * (share if key in SHRINKING else 1.0) for key, value in SIZES.get(name, {}).items()}
    model: Model = PLANT + by_name(name).from_values(values) if name else PLANT
    free = tuple(p.name for p in model.parameters if np.isfinite(model[p.name]))
    typical = Magnitudes(10.0, 0.1, 0.1)
    scale = np.array([typical.of(p.unit) for p in model.parameters if p.name in free])
    return CandidateModel(
        (name,) if name else (), 1.0, 0.0, 0.0, model, free, scale, np.zeros((len(free),) * 2), (Initial(),)
    )


def chosen(question: Question) -> list[Profile]:
    """The experiments of the table, as strong as the limits allow."""
    made = family(TimeScale(question.period, LIMITS.duration))
    found = []
    for start in CHOSEN:
        unit = next(profile for profile in made if profile.name.startswith(start))
        strong = fitted_in(unit, question.predictors, LIMITS, question.period, SEEN)
        if strong is not None:
            found.append(strong)
    return found


def parted(pair: tuple[str, str], profile: Profile, period: float) -> float:
    """Chi² a second that is left when the first of the pair is true and the second refitted."""
    on = grid(profile, period, SEEN)
    true = Predictor(contender(pair[0]), 10.0 * SEEN.noise).predict(on.record)
    left = []
    for share in STARTS if pair[1] else (1.0,):
        rival = Predictor(contender(pair[1], share), 10.0 * SEEN.noise)
        left.append(rival_refits.refitted(rival, rival.predict(on.record), true, on, SEEN).chi)
    return min(left) / profile.duration


def main() -> int:
    """Compute and write."""
    rival_refits.SHORT = STEPS  # to the end, where a design takes a first look
    question = Question.of([contender(name) for name in ("", *SIZES)], np.ones(len(SIZES) + 1).tolist(), SEEN, LIMITS)
    profiles = chosen(question)
    table = np.array([[parted(pair, profile, question.period) for profile in profiles] for pair in PAIRS])
    names = [profile.name for profile in profiles]
    (DOCS / "planning.md").write_text(page(names, table), encoding="utf-8")
    draw(names, table, DOCS / "images" / "planning.png")
    return 0


def called(pair: tuple[str, str]) -> str:
    """A pair in words."""
    return f"{pair[0]} / {pair[1] or 'none'}"


def page(names: Sequence[str], table: np.ndarray) -> str:
    """The page in Markdown."""
    sizes = "; ".join(
        f"{name} " + ", ".join(f"{p} {v:g}" for p, v in values.items() if np.isfinite(v))
        for name, values in SIZES.items()
    )
    lines = [
        "# Which experiment distinguishes which causes",
        "",
        "Written by `python -m bench.planning`. The first cause of a pair is true. The second is fitted to the motion",
        "of the first, with all parameters free and without an earlier record. The table gives the χ² that remains per",
        "second of the experiment. About 25 in total decide between the two; the largest value of a row is bold. Rig:",
        "1 kg on 100 N/m with 1 N·s/m, 0.2 mm of noise at 500 Hz, at most 10 N and 0.4 m.",
        f"Sizes, in SI units: {sizes}.",
        "",
        "![Remaining χ² per second](images/planning.png)",
        "",
        "| pair | " + " | ".join(names) + " |",
        "|---|" + "---|" * len(names),
    ]
    for pair, row in zip(PAIRS, table, strict=True):
        best = float(row.max())
        cells = [f"**{value:.2g}**" if value == best and best > 0.1 else f"{value:.2g}" for value in row]
        lines.append(f"| {called(pair)} | " + " | ".join(cells) + " |")
    lines += [
        "",
        "With a linear spring, a force offset is a shifted zero, which no profile can tell from the plant alone.",
        "Tilt the rig by a known angle, or turn it round, and read the encoder with the spring relaxed; `msd design",
        "--check` says so. The table is for orientation. `msd design` computes such values for the given rig from",
        "its records.",
    ]
    return "\n".join(lines) + "\n"


def draw(names: Sequence[str], table: np.ndarray, target: Path) -> None:
    """The table as a picture, in decades."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 6.0), layout="constrained")
    axis = figure.subplots()
    image = axis.imshow(np.log10(np.maximum(table, 1e-2)), cmap="viridis", aspect="auto", vmin=-2.0)
    axis.set_xticks(range(len(names)), [name.split(",")[0] for name in names], rotation=35, ha="right", fontsize=8)
    axis.set_yticks(range(len(PAIRS)), [called(pair) for pair in PAIRS], fontsize=8)
    figure.colorbar(image, label="log10 of the remaining χ² per second")
    figure.savefig(target, dpi=120)


if __name__ == "__main__":
    raise SystemExit(main())

"""``python -m bench.sharpening``: how much narrower a designed experiment makes the interval of µ.

python -m bench.sharpening [--rigs 30] [--seed 1] [--docs DIR]

Random rigs with Coulomb friction are pushed with one step and diagnosed; ``sharpen`` designs an experiment for µ within
the rig's limits. Then that experiment, a single step and random steps, all of the same duration, are played on the rig.
Each record is fitted alone, from the same start. The measured intervals are compared, not the predicted ones.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.blind_design.cases import BlindRig, limits_of
from msd_ident.design import Limits, Profile, Segment
from msd_ident.design.evaluation import Question, options
from msd_ident.design.parameter_design import Sharpened, compared, sharpen
from msd_ident.design.prediction import sensing
from msd_ident.diagnosis import Diagnosis
from msd_ident.estimate import fit
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.paper.refinement import GRAVITY
from msd_ident.workflow import pipeline
from msd_sim import lottery

_MU = "friction_coefficient"
_PAGE = """# Narrower intervals by a designed experiment

Written by `python -m bench.sharpening --docs docs`. Random rigs with Coulomb friction are pushed with one step and
diagnosed. `msd design --for friction_coefficient` (here its function) designs an experiment of at most 20 s within the
rig's limits. Three experiments of this duration are played within the same limits: the designed one, a single step, and
random steps. Each record is fitted alone. The *half width* is half of the 95 % interval of µ.

{table}
"""


@dataclass(frozen=True)
class Row:
    """One rig: µ, half intervals after the designed experiment, the step and the random steps, and what was said."""

    seed: int
    mu: float
    designed: float
    step: float
    random: float
    promised: float
    deviation: float
    name: str
    seconds: float

    @property
    def ratio(self) -> float:
        """Designed against a step."""
        return self.designed / self.step


def measured(seed: int) -> Row | None:
    """One rig by lot; None where friction is not seen after a step, so that nobody would ask."""
    draw = lottery.draw(seed, "coulomb_friction", False, "step")
    force = float(draw.spec["experiment"]["force"])
    limits = limits_of(draw.spec, force)
    rig = BlindRig(draw)
    first = rig.play(Profile((Segment("hold", 0.3), Segment("step", 2.7, force=force)), "one step"), limits)
    diagnosis = pipeline.diagnose([first.record])
    known = {name: quantity.value for name, quantity in diagnosis.extended.quantities.items()}
    if "coulomb_force" not in known:
        return None
    began = time.process_time()
    found = sharpen(diagnosis, [_MU], limits)
    seconds = time.process_time() - began
    start = Plant(known["mass"], known["damping"], known["stiffness"])
    rubbing = start + CoulombFriction(known["coulomb_force"])
    widths = [_played(rig, profile, limits, rubbing) for profile in (found.profile, *_others(diagnosis, found, limits))]
    true = float(draw.spec["effects"]["coulomb_friction"]["coulomb_force"]) / (float(draw.spec["mass"]) * GRAVITY)
    (mu, half), (_, step), (_, random) = widths
    return Row(
        seed, true, half, step, random, found.after[_MU], (mu - true) / (half / 1.96), found.profile.name, seconds
    )


def _others(diagnosis: Diagnosis, found: Sharpened, limits: Limits) -> list[Profile]:
    """A step and random steps of the same duration, as large as the limits allow."""
    question = Question.of(diagnosis.contenders[:1], (1.0,), sensing(diagnosis.records, diagnosis.noise_floor), limits)
    return [options(question, [unit])[0].profile for unit in compared(found.profile.duration, question.period)]


def _played(rig: BlindRig, profile: Profile, limits: Limits, model: Model) -> tuple[float, float]:
    """µ and half of its 95 % interval from this record alone."""
    result = fit(model, rig.play(profile, limits).record)
    mu = result.derived(lambda p: p["coulomb_force"] / (p["mass"] * GRAVITY), "1")
    return mu.value, 1.96 * mu.std


def told(rows: list[Row], seed: int) -> str:
    """The table."""
    ratios = np.array([row.ratio for row in rows])
    against = np.array([row.designed / row.random for row in rows])
    right = np.mean([abs(row.deviation) < 1.96 for row in rows])
    promised = np.array([row.promised / row.designed for row in rows])
    lines = [
        f"{len(rows)} rigs, seeds from {seed} on.",
        "",
        "| quantity | result | required |",
        "|---|---|---|",
        f"| half width, designed / single step, median | {np.median(ratios):.2f} | <= 0.5 |",
        f"| the same, 90 % quantile | {np.quantile(ratios, 0.9):.2f} | |",
        f"| rigs in which it is at most 0.5 | {np.sum(ratios <= 0.5)} of {len(rows)} | |",
        f"| half width, designed / random steps, median | {np.median(against):.2f} | |",
        f"| half width, predicted by the design / measured, median | {np.median(promised):.2f} | |",
        f"| 95 % intervals after the designed experiment that contain the true µ | {100.0 * right:.0f} % | |",
        f"| processor time of a design [s], median | {np.median([row.seconds for row in rows]):.2f} | <= 5 |",
        "",
        "| seed | true µ | half width, designed | single step | random steps | designed / single | designed profile |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        lines.append(
            f"| {row.seed} | {row.mu:.3g} | {row.designed:.2g} | {row.step:.2g} | {row.random:.2g} | {row.ratio:.2f} | "
            f"{row.name} |"
        )
    return "\n".join(lines)


def main() -> int:
    """Run and print; exit code 0 whatever it finds."""
    parser = argparse.ArgumentParser(prog="python -m bench.sharpening", description="Intervals of µ.")
    parser.add_argument("--rigs", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--docs", type=Path, help="directory that gets sharpening.md")
    given = parser.parse_args()
    rows: list[Row] = []
    seed = given.seed
    while len(rows) < given.rigs:
        row = measured(seed)
        if row is not None and math.isfinite(row.ratio):
            rows.append(row)
            print(
                f"{len(rows)} seed {seed} {row.ratio:.2f} {row.name} {row.seconds:.1f} s", file=sys.stderr, flush=True
            )
        seed += 1
    text = told(rows, given.seed)
    print(text)
    if given.docs:
        (given.docs / "sharpening.md").write_text(_PAGE.format(table=text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

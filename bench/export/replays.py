"""Drawn rigs exported to MuJoCo and replayed there: what is exact, and what is approximated at a predicted cost."""

from __future__ import annotations

import math
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.export.results import drawn, fitted
from msd_ident.export import Export, Options, export, target

#: What the exact figure is about.
EXACT = ("coulomb_friction", "end_stop", "actuator_lag", "force_offset", "force_gain_nonlinearity")
#: What MuJoCo's XML alone has no element for.
NEAREST = (
    "hysteresis", "stribeck_friction", "position_dependent_friction", "cogging", "stiffness_drift",
    "periodic_disturbance", "sensor_drift",
)  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One rig replayed.

    Attributes:
        seed, hidden: which.
        ours, replayed, predicted, base: SEE [m] of our simulation, of the target, of what was written simulated here,
            and of m, b, k alone in the target.
        coarse: SEE in the target at the record's own step; NaN where it was not asked for.
        steps: of the solver a step of the record.
        seconds: the export with its replay [s].
    """

    seed: int
    hidden: str
    ours: float
    replayed: float
    predicted: float
    base: float
    coarse: float
    steps: int
    seconds: float

    @property
    def ratio(self) -> float:
        """SEE in the target against ours."""
        return self.replayed / self.ours

    @property
    def off(self) -> float:
        """Replayed cost against the predicted one, less 1."""
        return abs(self.replayed / self.predicted - 1.0)


def exact(seed: int, number: int) -> Row:
    """A rig whose every effect MuJoCo has an element or a callback for."""
    return _row(seed, EXACT[number % len(EXACT)], "mujoco", coarse=True)


def approximated(seed: int, number: int) -> Row:
    """A rig with an effect that MuJoCo's XML alone cannot say."""
    return _row(seed, NEAREST[number % len(NEAREST)], "mujoco-xml", coarse=False)


def _row(seed: int, hidden: str, name: str, coarse: bool) -> Row:
    model, record, _ = drawn(seed, hidden)
    result = fitted(model, record)
    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        found = export(result, target(name), Path(folder, "rig.xml"), Options(), (record,))
        seconds = time.perf_counter() - begun
        once = export(result, target(name), Path(folder, "one.xml"), Options(steps=1), (record,)) if coarse else None
    proof = _proof(found)
    return Row(
        seed, hidden, proof.see("ours"), proof.see("target"), proof.see("expected"), proof.see("base"),
        _proof(once).see("target") if once else math.nan, found.plan.steps, seconds,
    )  # fmt: skip


def _proof(found: Export):  # type: ignore[no-untyped-def]
    assert found.proof is not None, found.not_replayed
    return found.proof


def told(rows: list[Row], exactly: bool) -> list[str]:
    """The table by effect, and the totals."""
    lines = [
        "| effect | rigs | SEE in MuJoCo / ours: median | largest | at the record's step: median | largest "
        "| replayed / predicted: median off | largest | steps | m, b, k alone / corrected: median | s |",
        "|---" * 11 + "|",
    ]
    names = dict.fromkeys(row.hidden for row in rows)
    for name in [*names, "all"]:
        part = [row for row in rows if name in ("all", row.hidden)]
        ratio, off = np.array([row.ratio for row in part]), np.array([row.off for row in part])
        coarse = np.array([row.coarse / row.ours for row in part])
        gain, steps = np.median([row.base / row.replayed for row in part]), np.median([row.steps for row in part])
        cells = [
            name, str(len(part)), f"{np.median(ratio):.4f}", f"{ratio.max():.4f}", f"{np.median(coarse):.3f}",
            f"{coarse.max():.2f}", f"{100 * np.median(off):.2f} %", f"{100 * off.max():.2f} %", f"{steps:.0f}",
            f"{gain:.3g}", f"{np.median([row.seconds for row in part]):.2f}",
        ]  # fmt: skip
        lines.append("| " + " | ".join(cells) + " |")
    if exactly:
        count = sum(row.ratio <= 1.1 for row in rows), sum(row.ratio <= 1.02 for row in rows)
        lines.append(f"\nwithin 1.1 times ours: {count[0]} of {len(rows)}; within 1.02: {count[1]}")
        at_step = sum(row.coarse <= 1.1 * row.ours for row in rows)
        lines.append(f"at the record's own step within 1.1 times ours: {at_step} of {len(rows)}")
    else:
        count = sum(row.off <= 0.10 for row in rows), sum(row.off <= 0.05 for row in rows)
        lines.append(f"\nreplayed within 10 % of the predicted cost: {count[0]} of {len(rows)}; 5 %: {count[1]}")
    worst = max(rows, key=lambda row: row.ratio if exactly else row.off)
    lines.append(f"worst: seed {worst.seed} ({worst.hidden}), {worst}")
    return lines

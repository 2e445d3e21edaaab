"""Random rigs exported to MuJoCo and replayed there: error of exact exports, predicted error of approximated ones."""

from __future__ import annotations

import math
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.export.results import drawn, fitted
from msd_ident.data.record import FloatArray
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
        plain: SEE in MuJoCo without the callback file; NaN where that cannot say the model, or was not asked for.
        steps, plain_steps: of the solver a step of the record, with the callback file and without.
        seconds: the export with its replay [s].
    """

    seed: int
    hidden: str
    ours: float
    replayed: float
    predicted: float
    base: float
    coarse: float
    plain: float
    steps: int
    plain_steps: int
    seconds: float

    @property
    def ratio(self) -> float:
        """SEE in the target against ours."""
        return self.replayed / self.ours

    @property
    def off(self) -> float:
        """Relative difference of the replayed SEE and the predicted one."""
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
        bare = export(result, target("mujoco-xml"), Path(folder, "bare.xml"), Options(), (record,)) if coarse else None
    proof = _proof(found)
    said = bare is not None and bare.nearest is None
    return Row(
        seed, hidden, proof.see("ours"), proof.see("target"), proof.see("expected"), proof.see("base"),
        _proof(once).see("target") if once else math.nan, _proof(bare).see("target") if said else math.nan,
        found.plan.steps, bare.plan.steps if said else 0, seconds,
    )  # fmt: skip


def _proof(found: Export):  # type: ignore[no-untyped-def]
    assert found.proof is not None, found.not_replayed
    return found.proof


def told(rows: list[Row], exactly: bool) -> list[str]:
    """The table by effect, and the totals."""
    cells = _exact_cells if exactly else _predicted_cells
    names = dict.fromkeys(row.hidden for row in rows)
    parts = {name: [row for row in rows if name in ("all", row.hidden)] for name in [*names, "all"]}
    table = [{"effect": name, "rigs": str(len(part)), **cells(part)} for name, part in parts.items()]
    lines = ["| " + " | ".join(table[0]) + " |", "|---" * len(table[0]) + "|"]
    lines += ["| " + " | ".join(line.values()) + " |" for line in table]
    totals = _exact_totals if exactly else _predicted_totals
    return [*lines, "", *totals(rows)]


def _exact_cells(part: list[Row]) -> dict[str, str]:
    cells = {}
    for label, name in (("SEE in MuJoCo / msd_ident", "replayed"), ("at the record's step", "coarse"),
                        ("without callbacks", "plain")):  # fmt: skip
        ratios = _ratios(part, name)
        cells[f"{label}: median"] = f"{np.median(ratios):.4f}" if ratios.size else "–"
        cells[f"largest {label}" if name == "replayed" else f"largest, {label}"] = (
            f"{ratios.max():.4f}" if ratios.size else "–"
        )
    without = [row.plain_steps for row in part if row.plain_steps]
    return cells | {
        "steps per sample": f"{np.median([row.steps for row in part]):.0f}",
        "without callbacks": f"{np.median(without):.0f}" if without else "–", **_gain_cells(part),
    }  # fmt: skip


def _predicted_cells(part: list[Row]) -> dict[str, str]:
    off = np.array([row.off for row in part])
    return {
        "difference of replayed and predicted SEE: median": f"{100 * np.median(off):.2f} %",
        "largest": f"{100 * off.max():.2f} %",
        "steps per sample": f"{np.median([row.steps for row in part]):.0f}",
        **_gain_cells(part),
    }


def _gain_cells(part: list[Row]) -> dict[str, str]:
    return {
        "SEE with m, b, k alone / exported: median": f"{np.median([row.base / row.replayed for row in part]):.3g}",
        "export and replay [s]": f"{np.median([row.seconds for row in part]):.2f}",
    }


def _ratios(rows: list[Row], name: str) -> FloatArray:
    """SEE of a replay over ours, of the rigs that have it."""
    found = np.array([getattr(row, name) / row.ours for row in rows])
    return found[np.isfinite(found)]


def _exact_totals(rows: list[Row]) -> list[str]:
    lines = []
    runs = (("the file's step", "replayed"), ("the record's own step", "coarse"), ("without callbacks", "plain"))
    for label, name in runs:
        ratios = _ratios(rows, name)
        within = int(np.sum(ratios <= 1.1)), int(np.sum(ratios <= 1.02))
        lines.append(f"{label}: at most 1.1 times the SEE of msd_ident {within[0]} of {ratios.size}; 1.02 {within[1]}")
    worst = max(rows, key=lambda row: row.ratio)
    slowest = max(rows, key=lambda row: row.seconds)
    lines.append(f"longest export with replay: {slowest.seconds:.2f} s (seed {slowest.seed})")
    return [*lines, f"worst: seed {worst.seed} ({worst.hidden}), {worst}"]


def _predicted_totals(rows: list[Row]) -> list[str]:
    within = [sum(row.off <= bound for row in rows) for bound in (0.10, 0.05, 0.01)]
    worst = max(rows, key=lambda row: row.off)
    return [
        f"replayed SEE within 10 % of the prediction: {within[0]} of {len(rows)}; 5 %: {within[1]}; 1 %: {within[2]}",
        f"worst: seed {worst.seed} ({worst.hidden}), {worst}",
    ]

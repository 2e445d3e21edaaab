"""MuJoCo models with one known error: how often ``msd validate --mujoco`` names it."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from bench.export.results import drawn, fitted
from msd_ident.data.record import Record
from msd_ident.export import target
from msd_ident.export.plan import Plan
from msd_ident.external import MujocoSimulation, compare
from msd_ident.model import Model

#: Mistake → hidden effect of the rig that it is made on.
MISTAKES = {
    "friction removed": "coulomb_friction", "stiffness 10 % off": "coulomb_friction", "lag left out": "actuator_lag",
    "stop moved": "end_stop",
}  # fmt: skip
#: By how much a stop is moved, and a stiffness is off.
MOVED, OFF = 0.95, 1.10


@dataclass(frozen=True)
class Case:
    """One wrong model.

    Attributes:
        seed, mistake: which.
        named: whether the mistake is among the differences.
        first: whether it is the first of them.
        within: whether the interval of a parameter's error holds the true one; true where a cause was to be named.
        others: what else was said.
        seconds: of the comparison.
    """

    seed: int
    mistake: str
    named: bool
    first: bool
    within: bool
    others: tuple[str, ...]
    seconds: float


def case(seed: int, number: int) -> Case:
    """A rig by lot, and a model of it with one mistake."""
    mistake = tuple(MISTAKES)[number % len(MISTAKES)]
    model, record, noise = drawn(seed, MISTAKES[mistake])
    wrong, name, factor = _wrong(model, mistake)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "theirs.xml")
        _write(wrong, record, path)
        begun = time.perf_counter()
        found = compare(MujocoSimulation(path, "x"), (record,))
        seconds = time.perf_counter() - begun
    mine = [one for one in found.differences if one.name == name]
    within = bool(mine) and (factor is None or mine[0].kind != "value" or _holds(mine[0].percent, factor))
    others = tuple(f"{one.kind} {one.name}" for one in found.differences if one.name != name)
    first = bool(mine) and found.differences[0] is mine[0]
    return Case(seed, mistake, bool(mine), first, within, others, seconds)


def _wrong(model: Model, mistake: str) -> tuple[Model, str, float | None]:
    """The model with the mistake; what is to be named; by which factor a parameter is off."""
    if mistake == "friction removed":
        return model.without("coulomb_friction"), "coulomb_friction", None
    if mistake == "lag left out":
        return model.without("actuator_lag"), "actuator_lag", None
    if mistake == "stop moved":
        return model.with_values({"stop_position": MOVED * model["stop_position"]}), "stop_position", MOVED
    return model.with_values({"stiffness": OFF * model["stiffness"]}), "stiffness", OFF


def _holds(percent: object, factor: float) -> bool:
    """Whether the interval of an error [%] holds the true one, at three standard deviations."""
    value, std = percent.value, percent.std  # type: ignore[attr-defined]
    return bool(abs(value - 100.0 * (factor - 1.0)) <= 3.0 * std)


def _write(model: Model, record: Record, path: Path) -> None:
    """Their model, with these very values and a step an eighth of the record's."""
    plan = Plan(fitted(model, record), model, period=record.period, steps=8)
    for file, content in target("mujoco").files(plan, path).items():
        file.write_bytes(content)


def told(cases: list[Case]) -> list[str]:
    """The table by mistake, and the totals."""
    heads = "cases | named | named first | true value within 3 standard deviations | others also named | s"
    lines = [f"| error of the model | {heads} |", "|---" * 7 + "|"]
    for mistake in [*dict.fromkeys(one.mistake for one in cases), "all"]:
        part = [one for one in cases if mistake in ("all", one.mistake)]
        seconds = sum(one.seconds for one in part) / len(part)
        lines.append(
            f"| {mistake} | {len(part)} | {sum(one.named for one in part)} | {sum(one.first for one in part)} "
            f"| {sum(one.within for one in part)} | {sum(bool(one.others) for one in part)} | {seconds:.1f} |"
        )
    return lines + [f"seed {one.seed}: {one}" for one in cases if not (one.named and one.within) or one.others]

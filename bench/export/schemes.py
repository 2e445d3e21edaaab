"""Dry friction in MuJoCo at the record's own step: forms of the constraint, integrators, and the callback."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import numpy as np

from bench.export.replays import EXACT
from bench.export.results import drawn, fitted
from msd_ident.export import Options, export, mujoco_elements, target, templates


@dataclass(frozen=True)
class Scheme:
    """How dry friction is made.

    Attributes:
        rate: at which the constraint takes the velocity away, in 1/step.
        impedance: part of the other forces that it makes up for.
        integrator: of MuJoCo.
        name: export target; ``mujoco`` has the callback file, whatever the constraint is.
    """

    rate: float = mujoco_elements.SLIP
    impedance: float = mujoco_elements.STIFF
    integrator: str = "RK4"
    name: str = "mujoco-xml"

    def __str__(self) -> str:
        if self.name == "mujoco":
            return f"callback, {self.integrator}"
        return f"constraint, rate {self.rate:g}, impedance {self.impedance:g}, {self.integrator}"


SCHEMES = (
    Scheme(), Scheme(rate=1.0), Scheme(rate=4.0), Scheme(rate=8.0), Scheme(rate=30.0), Scheme(5.0, 0.5),
    Scheme(25.0, 0.1), Scheme(1.0, integrator="Euler"), Scheme(1.9, integrator="Euler"),
    Scheme(1.0, integrator="implicitfast"), Scheme(name="mujoco"),
)  # fmt: skip
#: Hidden effects that MuJoCo has elements for, so that dry friction alone makes the difference.
NATIVE = tuple(name for name in EXACT if name != "force_gain_nonlinearity")


def ratios(seed: int, number: int) -> tuple[float, ...]:
    """SEE in MuJoCo at the record's step over ours, for each scheme."""
    model, record, _ = drawn(seed, NATIVE[number % len(NATIVE)])
    result, found = fitted(model, record), []
    for scheme in SCHEMES:
        with tempfile.TemporaryDirectory() as folder, _made(scheme):
            made = export(result, target(scheme.name), Path(folder, "rig.xml"), Options(steps=1), (record,))
        assert made.proof is not None, made.not_replayed
        found.append(made.proof.ratio)
    return tuple(found)


@contextmanager
def _made(scheme: Scheme) -> Iterator[None]:
    """Exports with this form of the constraint."""
    read = templates.read
    with (
        mock.patch.object(mujoco_elements, "SLIP", scheme.rate),
        mock.patch.object(mujoco_elements, "STIFF", scheme.impedance),
        mock.patch.object(templates, "read", lambda name: read(name).replace('"RK4"', f'"{scheme.integrator}"')),
    ):
        yield


def told(rows: list[tuple[float, ...]]) -> list[str]:
    """The table by scheme."""
    lines = ["| dry friction | SEE in MuJoCo / msd_ident: median | largest | rigs with at most 1.1 |", "|---" * 4 + "|"]
    for scheme, column in zip(SCHEMES, np.array(rows).T, strict=True):
        within = f"{int(np.sum(column <= 1.1))} of {column.size}"
        lines.append(f"| {scheme} | {np.median(column):.4f} | {column.max():.4g} | {within} |")
    return lines

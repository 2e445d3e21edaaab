"""Short records that a diagnosis is quick with, and rows of tables without any."""

from __future__ import annotations

import os
import signal
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident.data.record import Record, from_samples
from msd_sim import api

PLANT = {"mass": 0.94, "damping": 3.9, "stiffness": 694.0}


def steps(seed: int = 0, force: float = 10.4, effects: dict[str, Any] | None = None, **changed: float) -> Record:
    """A rig's answer to force steps: 4 s at 500 Hz."""
    spec = {
        **PLANT, "friction_coefficient": 0.0, **changed, "effects": effects or {}, "encoder": {"noise": 2e-5},
        "rate": 500.0, "seed": seed, "experiment": {"name": "steps", "force": force, "hold": 0.5}, "duration": 4.0,
    }  # fmt: skip
    made = api.simulate(spec)
    place = np.searchsorted(made.force_time, made.time + 1e-9, side="right") - 1
    given = np.where(place < 0, 0.0, made.force[np.maximum(place, 0)])
    return from_samples(made.time, given, made.position, name=f"record {seed}")


def step_file(path: Path, seed: int = 0, temperature: float | None = None, **changed: float) -> Path:
    """The same as a CSV file, with a column of a temperature where there is one."""
    record = steps(seed, **changed)
    columns = [record.time, record.force, record.position]
    head = "time_s,force_n,position_m"
    if temperature is not None:
        columns.append(np.full(record.samples, temperature))
        head += ",temperature_c"
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=head, comments="", fmt="%.9g")
    return path


def row(number: int, robot: str = "arm", **changed: Any) -> dict[str, Any]:
    """A row as a batch writes it, of a record that never was."""
    lots = np.random.default_rng(number)
    found: dict[str, Any] = {
        "path": f"/lab/{robot}/record_{number:05d}.csv", "name": f"record_{number:05d}.csv", "joint": "",
        "robot": robot,
        "sha256": f"{number:064x}", "job": "0" * 16, "options": "{}", "verdict": "explained", "summary": "Explained.",
        "start": datetime(2026, 1, 1, tzinfo=timezone.utc) + timedelta(days=number), "samples": 6000,
        "force_unit": "N", "position_unit": "m", "peak_force": 10.0, "seconds": 1.0,
        "causes": [{"name": "coulomb_friction", "probability": 0.99, "tied_with": []}], "p_coulomb_friction": 0.99,
        "coulomb_force": 0.12 * (1.0 + 0.01 * lots.normal()), "coulomb_force_std": 0.001,
    }  # fmt: skip
    for name, value in PLANT.items():
        found |= {name: value * (1.0 + 0.003 * lots.normal()), f"{name}_std": 0.003 * value}
    return found | changed


def die_once(path: str) -> str:
    """Take the process along, the first time."""
    mark = Path(path)
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


def die(path: str) -> str:
    """Take the process along, every time."""
    os.kill(os.getpid(), signal.SIGKILL)
    return path

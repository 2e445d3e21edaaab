"""Measures the diagnosis: its duration in a warm process, how that grows with the record, and whole commands."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from bench.blind import plan
from bench.blind.cases import sealed
from bench.measure import Row, median_seconds
from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.io import SourceOptions, read
from msd_ident.workflow import pipeline
from msd_sim import api

#: Seed of the rigs: each effect beside Coulomb friction, steps of 6 s at 1 kHz, as in ``python -m bench.blind``.
SEED = 777_000
#: Drag beside Coulomb friction, with a noise of 1e-5 m.
RIG: Mapping[str, Any] = {
    "mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.02, "rate": 1000.0, "seed": 4,
    "effects": {"quadratic_drag": {"drag_coefficient": 2.0}}, "encoder": {"counts_per_metre": 1e6, "noise": 1e-5},
}  # fmt: skip
#: Duration of each of the eight holds [s], and processor time that a diagnosis may take [s].
HOLDS = {0.75: (2.5, 1.0), 3.0: (5.0, 3.0), 12.0: (15.0, 10.0)}
#: Subcommand and seconds that it may take from the shell, with the solver compiled.
COMMANDS = {"diagnose": (2.2, 1.2), "identify": (1.2, 0.7)}


def rows() -> list[Row]:
    """All figures of the diagnosis."""
    with tempfile.TemporaryDirectory() as folder:
        paths = _written(Path(folder))
        return [*warm_rows(paths), *length_rows(), *shell_rows(paths[len(paths) // 2])]


def _written(folder: Path) -> list[Path]:
    """Files of the rigs."""
    paths = []
    for case in plan.study(1, SEED):
        if case.kind == "beside" and (case.experiment, case.rate, case.noise) == ("steps", 1000.0, "white"):
            paths.append(folder / f"{case.seed}.csv")
            sealed(case).write(paths[-1])
    return paths


def warm_rows(paths: list[Path]) -> list[Row]:
    """Time of one diagnosis by the clock, and of the processors, over all rigs."""
    records = [read(path, SourceOptions()) for path in paths]
    pipeline.diagnose(records[:1])
    found = [_timed(record)[:2] for record in records]
    what = f"one diagnosis, 6 s at 1 kHz, median of {len(records)} rigs"
    return [
        Row(f"{what}, {how}", statistics.median(seconds), "s", 1.0, 0.5, detail=f"longest {max(seconds):.2f} s")
        for how, seconds in zip(("by the clock", "processor time"), zip(*found, strict=True), strict=True)
    ]


def _timed(record: Record) -> tuple[float, float, Diagnosis]:
    """Time of a diagnosis by the clock [s], processor time [s], and the result."""
    begun = time.perf_counter(), time.process_time()
    diagnosis = pipeline.diagnose([record])
    return time.perf_counter() - begun[0], time.process_time() - begun[1], diagnosis


def length_rows() -> list[Row]:
    """Processor time of a diagnosis of one rig, with its steps held longer; each must give the same verdict."""
    found, verdicts = [], []
    for hold, bounds in HOLDS.items():
        made = api.simulate({**RIG, "experiment": {"name": "steps", "force": 10.0, "hold": hold}})
        record = Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)
        _, seconds, diagnosis = _timed(record)
        verdicts.append((diagnosis.verdict, *sorted(cause.name for cause in diagnosis.causes)))
        what = f"one diagnosis, {record.samples} samples, processor time"
        found.append(Row(what, seconds, "s", *bounds, detail=" ".join(verdicts[-1])))
    different = len(set(verdicts)) - 1
    return [*found, Row("verdicts that change with the length", different, "", 0.0)]


def shell_rows(path: Path) -> list[Row]:
    """Time of a command by the clock, from start to end of its process.

    As in a user's shell, Python keeps the bytecode of what it imported in the first run, which is not counted.
    """
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    found = []
    for name, bounds in COMMANDS.items():
        command = [sys.executable, "-m", "msd_ident.cli.main", name, str(path)]
        run = partial(subprocess.run, command, capture_output=True, check=True, env=environment)
        seconds = median_seconds(run)
        found.append(Row(f"msd {name} of a record of 6 s at 1 kHz, whole process", seconds, "s", *bounds))
    return found

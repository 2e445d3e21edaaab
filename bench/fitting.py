"""Measures the joint fit: its duration, how that grows with the length of the record, and its memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.measure import Row, linearity, median_seconds
from msd_ident.data.record import Record
from msd_ident.estimate import fit
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction

TRUTH = Plant(0.9407, 3.927, 694.1) + CoulombFriction(0.1227)
START = TRUTH.with_values(TRUTH.values * np.array([1.3, 0.7, 0.7, 1.3]))


def record(samples: int, seed: int = 1) -> Record:
    """Steps of either sign at 1 kHz, read with noise of 0.1 % of the amplitude."""
    time = np.arange(samples) / 1000.0
    random = np.random.default_rng(seed)
    steps = random.choice([-10.0, -5.0, 0.0, 5.0, 10.0], samples // 700 + 2)
    steps[0] = 10.0
    force = steps[(time / 0.7).astype(int)]
    quiet = Record(time=time, position=0.0 * time, force_time=time, force=force)
    position = simulate(TRUTH, quiet).position
    noise = 1e-3 * float(np.max(np.abs(position))) * random.standard_normal(samples)
    return Record(time=time, position=position + noise, force_time=time, force=force)


def rows() -> list[Row]:
    """All figures of the fit."""
    return [joint_row(), length_row(), memory_row()]


def joint_row() -> Row:
    """m, b, k, Fc with the record's own state and zero, 3 s at 1 kHz, from 30 % wrong; intervals included."""
    measured = record(3000)
    result = fit(START, measured)
    worst = float(np.max(np.abs(result.model.values / TRUTH.values - 1.0)))
    near = median_seconds(lambda: fit(START, measured, search="near"), budget=1.0)
    seconds = median_seconds(lambda: fit(START, measured), budget=1.0)
    detail = f"off by {100 * worst:.2f} % at most; {1e3 * near:.1f} ms from the given start alone"
    return Row("joint fit of m, b, k, Fc, 3 s at 1 kHz, from 30 % wrong", 1e3 * seconds, "ms", 20.0, 5.0, detail=detail)


def length_row() -> Row:
    """Cost of the whole fit against length, each time of a record that nothing is known about yet.

    Each round has records of its own: how many steps a fit takes differs from one to the next.
    """
    measured: dict[tuple[int, int], Record] = {}

    def prepare(samples: int, turn: int) -> Callable[[], object]:
        if (samples, turn) not in measured:
            measured.clear()
            measured[samples, turn] = record(samples, seed=turn)
        fresh = replace(measured[samples, turn])
        return lambda: fit(START, fresh)

    return linearity("fit", prepare, rounds=9)


_MEMORY = """
import json, sys
import numpy as np
from bench.fitting import START
from msd_ident.estimate import fit
from msd_ident.data.record import Record

def held(key):
    lines = open("/proc/self/status").read().splitlines()
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith(key))

def read(name):
    kept = np.load(name)
    return Record(time=kept[0], position=kept[1], force_time=kept[0], force=kept[2])

fit(START, read(sys.argv[1]))
long = read(sys.argv[2])
open("/proc/self/clear_refs", "w").write("5")  # the peak starts anew
before = held("VmRSS")
fit(START, long)
print(json.dumps({"before": before, "peak": held("VmHWM")}))
"""


def memory_row() -> Row:
    """Peak memory of a process that fits 1e6 samples, beyond what it held before the fit (Linux only)."""
    with tempfile.TemporaryDirectory() as folder:
        names = []
        for samples in (3000, 1_000_000):
            measured = record(samples)
            names.append(str(Path(folder) / f"{samples}.npy"))
            np.save(names[-1], np.stack([measured.time, measured.position, measured.force]))
        done = subprocess.run([sys.executable, "-c", _MEMORY, *names], capture_output=True, text=True, check=True)
    held = json.loads(done.stdout)
    detail = f"peak of the whole process {held['peak']:.0f} MB, {held['before']:.0f} MB before the fit"
    return Row("memory of a fit of 1e6 samples", held["peak"] - held["before"], "MB", must=300.0, detail=detail)

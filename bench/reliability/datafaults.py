"""Faults of data, applied to the clean step of the demo's rig: each fault one function, named by its docstring."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.data.streams import from_stamps
from msd_sim.api import simulate

RATE = 1000.0
START_NS = 1_700_000_000_000_000_000

Spoil = Callable[[Record, np.random.Generator], Record]


@dataclass(frozen=True)
class Fault:
    """What happened to the data, in words, and the function that does it to a record."""

    name: str
    spoil: Spoil


@cache
def clean() -> Record:
    """0.5 s of rest and the paper's experiment on its rig: m 0.9407 kg, b 3.927 N s/m, k 694.1 N/m, µ 0.0133."""
    return _record(simulate({"rig": "ecp", "experiment": {"name": "paper", "start": 0.5}, "rate": RATE}))


def _record(found: object) -> Record:
    return Record(found.time, found.position, found.force_time, found.force, found.hold)  # type: ignore[attr-defined]


def amplitude(record: Record) -> float:
    """Half of the span of the position [m]."""
    return float(np.ptp(record.position)) / 2


def _keep(record: Record, chosen: np.ndarray) -> Record:
    return replace(record, time=record.time[chosen], position=record.position[chosen])


def dropped(record: Record, rng: np.random.Generator) -> Record:
    """20 % of the samples are missing, at random."""
    return _keep(record, rng.random(record.samples) >= 0.2)


def outliers(record: Record, rng: np.random.Generator) -> Record:
    """1 % of the readings are outliers, 10 amplitudes off in either direction."""
    wild = rng.random(record.samples) < 0.01
    size = 10 * amplitude(record) * rng.choice([-1.0, 1.0], record.samples)
    return replace(record, position=np.where(wild, record.position + size, record.position))


def outliers_of_any_size(record: Record, rng: np.random.Generator) -> Record:
    """1 % of the readings are outliers, off by up to 10 amplitudes in either direction."""
    wild = rng.random(record.samples) < 0.01
    size = 10 * amplitude(record) * rng.uniform(-1.0, 1.0, record.samples)
    return replace(record, position=np.where(wild, record.position + size, record.position))


def jitter(record: Record, rng: np.random.Generator) -> Record:
    """The stamps have a jitter of up to half a period in either direction."""
    shift = rng.uniform(-0.5, 0.5, record.samples) / RATE
    time = np.sort(record.time + shift)
    return replace(record, time=time + np.arange(time.size) * 1e-12)


def _stamped(record: Record, ns_x: np.ndarray, ns_f: np.ndarray) -> Record:
    found = from_stamps(ns_x + START_NS, record.position, ns_f + START_NS, record.force, hold=record.hold)
    return replace(found, name=record.name)


def rounded_stamps(record: Record, rng: np.random.Generator) -> Record:
    """Stamps of the position rounded to 10 ms, those of the force unchanged."""
    return _stamped(record, (np.rint(record.time * 100) * 1e7).astype(np.int64), _ns(record.force_time))


def floored_stamps(record: Record, rng: np.random.Generator) -> Record:
    """Stamps of the position rounded down to 10 ms, those of the force unchanged."""
    moved = replace(record, force_time=record.force_time)
    return _stamped(moved, (np.floor(record.time * 100 + 1e-6) * 1e7).astype(np.int64), _ns(record.force_time))


def late_stamps(record: Record, rng: np.random.Generator) -> Record:
    """Sampled at 100 Hz, stamps rounded up to 10 ms."""
    every = np.arange(int(rng.integers(0, 10)), record.samples, 10)
    slow = _keep(record, every)
    ticks = (np.ceil(slow.time * 100 - 1e-6) * 1e7).astype(np.int64)
    return _stamped(slow, ticks, _ns(record.force_time))


def _ns(time: FloatArray) -> np.ndarray:
    return np.rint(time * 1e9).astype(np.int64)


def zero_shift(record: Record, rng: np.random.Generator) -> Record:
    """The zero of the encoder jumps by 5 to 50 % of the amplitude."""
    at = rng.uniform(0.2, 0.8) * record.time[-1]
    size = rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.5) * amplitude(record)
    return replace(record, position=record.position + np.where(record.time > at, size, 0.0))


def small_zero_shift(record: Record, rng: np.random.Generator) -> Record:
    """The zero of the encoder jumps by 0.2 to 5 % of the amplitude."""
    at = rng.uniform(0.2, 0.8) * record.time[-1]
    size = rng.choice([-1.0, 1.0]) * rng.uniform(0.002, 0.05) * amplitude(record)
    return replace(record, position=record.position + np.where(record.time > at, size, 0.0))


def bump(record: Record, rng: np.random.Generator) -> Record:
    """An unrecorded force of 2 to 20 N acts for 20 ms."""
    at = float(rng.uniform(0.1, 0.9) * record.time[-1])
    size = float(rng.choice([-1.0, 1.0]) * rng.uniform(2.0, 20.0))
    levels = {0.0: 0.0, 0.5: 10.425, 3.5: 0.0}
    times = sorted({*levels, at, at + 0.02})
    held = [levels[max(t for t in levels if t <= when)] for when in times]
    force = [f + (size if at <= when < at + 0.02 else 0.0) for when, f in zip(times, held, strict=True)]
    found = simulate({"rig": "ecp", "force_time": times, "force": force, "duration": 6.5, "rate": RATE})
    return replace(record, time=found.time, position=found.position)


def first_half(record: Record, rng: np.random.Generator) -> Record:
    """Only the first half of the record: the step up."""
    return record.window(record.time[0], record.time[-1] / 2)


def last_half(record: Record, rng: np.random.Generator) -> Record:
    """Only the last half of the record: the release."""
    return record.window(record.time[-1] / 2, record.time[-1])


def no_middle(record: Record, rng: np.random.Generator) -> Record:
    """Half of the record is missing, at a random place."""
    begin = rng.uniform(0.0, 0.5) * record.time[-1]
    return _keep(record, (record.time < begin) | (record.time > begin + record.time[-1] / 2))


FAULTS = tuple(
    Fault((function.__doc__ or "").strip().rstrip("."), function)
    for function in (
        dropped,
        outliers,
        outliers_of_any_size,
        jitter,
        rounded_stamps,
        floored_stamps,
        late_stamps,
        zero_shift,
        small_zero_shift,
        bump,
        first_half,
        last_half,
        no_middle,
    )
)

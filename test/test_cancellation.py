"""Work that takes long ends between two simulations when asked, in threads of a pool too; other work goes on."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from msd_ident import cancellation, parallel
from msd_ident.data.record import Record
from msd_ident.diagnosis import Task, diagnose_records
from msd_ident.estimate import fit
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction


def stepped() -> Record:
    """A cart that a force of 10 N sets ringing, with friction and a little noise."""
    time = np.arange(0.0, 2.0, 0.005)
    truth: Model = Plant(1.0, 3.0, 400.0) + CoulombFriction(0.3)
    record = Record(time, np.zeros_like(time), np.array([0.0, 0.1]), np.array([0.0, 10.0]))
    from msd_ident.model import simulate

    position = simulate(truth, record).position + 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    return Record(time, position, record.force_time, record.force)


def test_a_fit_is_stopped_between_two_simulations() -> None:
    asked: list[bool] = []

    def enough() -> bool:
        asked.append(len(asked) >= 5)
        return asked[-1]

    with pytest.raises(cancellation.Cancelled), cancellation.cancel_when(enough):
        fit(Plant(1.0, 1.0, 300.0), stepped())
    assert asked == [False] * 5 + [True], "nothing is simulated after the word"


def test_the_threads_of_a_search_hear_it_too() -> None:
    stop, heard = threading.Event(), set()
    stages: list[str] = []

    def enough() -> bool:
        if stop.is_set():
            heard.add(threading.current_thread().name)
        return stop.is_set()

    def progress(stage: str, fraction: float, cause: str) -> None:
        stages.append(stage)
        if stage == "search":
            stop.set()

    with parallel.limited_to(2), pytest.raises(cancellation.Cancelled), cancellation.cancel_when(enough):
        diagnose_records(Task((stepped(),)), progress=progress)
    assert any(name.startswith("ThreadPoolExecutor") for name in heard)
    assert stages.count("search") < 5 and "verdict" not in stages


def test_only_the_work_that_was_meant_is_stopped() -> None:
    with cancellation.cancel_when(lambda: True):
        with ThreadPoolExecutor(1) as pool:
            pool.submit(cancellation.raise_if_cancelled).result()
            with pytest.raises(cancellation.Cancelled):
                pool.submit(cancellation.in_this_context(cancellation.raise_if_cancelled)).result()
        with cancellation.cancel_when(lambda: False):
            cancellation.raise_if_cancelled()
        with pytest.raises(cancellation.Cancelled):
            cancellation.raise_if_cancelled()
    cancellation.raise_if_cancelled()

"""The thread for long work: a job of another worker goes first while it is young."""

from __future__ import annotations

import gc
import threading
import time
from collections.abc import Iterator

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from rclpy.executors import SingleThreadedExecutor  # noqa: E402

from msd_ident.cancellation import Cancelled, raise_if_cancelled  # noqa: E402
from msd_ident.ros.common import worker as worker_module  # noqa: E402
from msd_ident.ros.common.worker import Worker  # noqa: E402

#: Longest wait for what comes at once on a free machine, and for how long a job that is held stays [s].
PATIENCE, HELD = 30.0, 60.0


class Counting:
    """A job that never ends by itself; it counts its steps and asks between them, as a fit does."""

    def __init__(self) -> None:
        self.steps = 0
        self.ended = threading.Event()

    def __call__(self) -> None:
        try:
            while True:
                raise_if_cancelled()
                self.steps += 1
                time.sleep(1e-4)
        except Cancelled:
            self.ended.set()
            raise

    def made_in(self, seconds: float) -> int:
        """Steps within the next ``seconds``."""
        before = self.steps
        time.sleep(seconds)
        return self.steps - before

    def goes_on(self) -> bool:
        """Whether ten more steps are made."""
        enough, begin = self.steps + 10, time.monotonic()
        while self.steps < enough and time.monotonic() - begin < PATIENCE:
            time.sleep(1e-3)
        return self.steps >= enough


@pytest.fixture
def workers() -> Iterator[tuple[Worker, Worker]]:
    first = Worker("first")
    second = Worker("second", behind=first)
    yield first, second
    second.close()
    first.close()


@pytest.fixture
def young(monkeypatch: pytest.MonkeyPatch) -> None:
    """A job that is held stays young, however slow the machine is."""
    monkeypatch.setattr(worker_module, "_REST", HELD)


def soon(condition: threading.Event) -> None:
    assert condition.wait(PATIENCE)


def held(worker: Worker) -> threading.Event:
    """A job of ``worker`` that has begun, and ends when the event is set."""
    begun, end = threading.Event(), threading.Event()
    worker.submit(lambda: (begun.set(), end.wait(HELD)))
    soon(begun)
    return end


@pytest.mark.usefixtures("young")
def test_a_worker_rests_while_a_job_that_goes_first_is_young(workers: tuple[Worker, Worker]) -> None:
    first, second = workers
    counting = Counting()
    second.submit(counting)
    assert counting.goes_on()
    end = held(first)
    assert counting.made_in(0.1) <= 1  # one step may have begun before
    end.set()
    assert counting.goes_on()


def test_it_goes_on_beside_a_job_that_takes_long(workers: tuple[Worker, Worker]) -> None:
    first, second = workers
    counting = Counting()
    second.submit(counting)
    end = held(first)
    assert counting.goes_on()
    end.set()


@pytest.mark.usefixtures("young")
def test_a_job_that_rests_can_be_stopped(workers: tuple[Worker, Worker]) -> None:
    """While the job that goes first is still held: nobody waits for its end."""
    first, second = workers
    counting, stop = Counting(), threading.Event()
    second.submit(counting, stop=stop)
    end = held(first)
    stop.set()
    soon(counting.ended)
    end.set()


def test_the_worker_that_goes_first_does_not_rest(workers: tuple[Worker, Worker]) -> None:
    first, second = workers
    counting = Counting()
    end = held(second)
    first.submit(counting)
    assert counting.goes_on()
    end.set()


def test_what_waits_is_dropped_though_nothing_spins_any_more(ros_domain: int) -> None:
    """A node ends in this order: what spins first. Somebody who waited is not woken, and nothing is raised."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain, args=[])
    executor, worker, told = SingleThreadedExecutor(context=context), Worker("ends"), threading.Event()
    end = held(worker)
    future = worker.submit(print, executor)
    future.add_done_callback(lambda _: told.set())
    executor.shutdown()
    worker.close(patience=0.0)
    assert future.cancelled() and not told.is_set()
    end.set()
    assert worker.close()
    context.try_shutdown()


@pytest.mark.parametrize(
    ("error", "said"),
    [(Cancelled, ""), (ValueError, "The following exception was never retrieved: no such joint\n")],
)
def test_only_an_error_that_nobody_asks_for_is_printed(
    error: type[Exception], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """rclpy prints it when the future goes. A job that was stopped is none: who ends a node saw an empty sentence."""

    def fails() -> None:
        raise error("no such joint")

    worker = Worker("ends")
    future = worker.submit(fails)
    while not future.done():
        time.sleep(1e-3)
    worker.close()
    del future
    gc.collect()
    assert capsys.readouterr().err == said

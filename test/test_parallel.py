"""Threads for compiled work: order, how many, how they are shared, and what they leave behind."""

from __future__ import annotations

import sys
import threading
import time

import pytest

from msd_ident import parallel


def _threads_seen(count: int, tasks: int = 8) -> set[int]:
    def work(_: int) -> int:
        time.sleep(0.01)
        return threading.get_ident()

    with parallel.limited_to(count):
        return set(parallel.each(work, range(tasks)))


def test_results_come_in_the_order_of_the_tasks() -> None:
    def work(task: int) -> int:
        time.sleep(0.002 * (8 - task))
        return task

    with parallel.limited_to(4):
        assert parallel.each(work, range(8)) == list(range(8))


def test_one_thread_is_this_one() -> None:
    assert _threads_seen(1) == {threading.get_ident()}


def test_no_more_threads_than_allowed() -> None:
    assert len(_threads_seen(3)) == 3


def test_threads_are_shared_with_the_work_inside() -> None:
    with parallel.limited_to(4):
        assert parallel.each(lambda _: parallel.threads(), range(2)) == [2, 2]
        assert parallel.each(lambda _: parallel.threads(), range(4)) == [1, 1, 1, 1]
        assert parallel.threads() == 4


def test_the_end_of_a_block_gives_the_threads_back() -> None:
    before = parallel.threads()
    with parallel.limited_to(before + 1):
        assert parallel.threads() == before + 1
    assert parallel.threads() == before


@pytest.mark.parametrize("count", [1, 3])
def test_each_task_is_told_and_what_that_raises_ends_the_work(count: int) -> None:
    told, done = [], []

    def tell(number: int, task: int) -> None:
        told.append(number)
        if number == 3:
            raise KeyboardInterrupt

    def work(task: int) -> None:
        time.sleep(0.005)
        done.append(task)

    with parallel.limited_to(count), pytest.raises(KeyboardInterrupt):
        parallel.each(work, range(50), tell)
    assert told == [1, 2, 3]
    assert len(done) < 50


def test_the_interval_of_the_threads_is_restored_after_nested_and_failed_work() -> None:
    before = sys.getswitchinterval()

    def inner(_: int) -> float:
        parallel.each(lambda _: None, range(2))
        return sys.getswitchinterval()

    with parallel.limited_to(4):
        assert max(parallel.each(inner, range(2))) < before
        with pytest.raises(ZeroDivisionError):
            parallel.each(lambda task: 1 // task, range(2))
    assert sys.getswitchinterval() == before

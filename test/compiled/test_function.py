"""What a compiled function takes, what it refuses, and that it is the function that was written."""

from __future__ import annotations

import importlib
import pkgutil
import threading
from typing import Any

import numpy as np
import pytest

import msd_ident
from msd_ident.compiled import Library, loading
from msd_ident.data.compiled import _pole_zero, _ranked, peaks
from msd_ident.estimate.damped_step import _damped_step


def libraries() -> list[Library]:
    """All libraries of the package."""
    for module in pkgutil.walk_packages(msd_ident.__path__, "msd_ident."):
        if f"{module.name}_loops" in NAMES:
            importlib.import_module(module.name)
    return Library.known


NAMES = {module.name for module in pkgutil.walk_packages(msd_ident.__path__, "msd_ident.")}


def test_each_module_of_loops_has_a_library_that_names_all_its_outermost_functions() -> None:
    written = {library.written_in: set(library.functions) for library in libraries()}
    assert {name for name in NAMES if name.endswith("_loops")} | {"msd_ident.model.kernel.entries"} == set(written)
    for name, functions in written.items():
        module = importlib.import_module(name)
        own = {key for key, value in vars(module).items() if hasattr(value, "py_func") and not key.startswith("_")}
        assert own - {"making"} == functions, name


@pytest.mark.parametrize(
    "wrong",
    [
        np.zeros(4, np.float32),
        np.zeros(8)[::2],
        np.zeros((2, 2)),
        np.zeros(4, np.int64),
        np.asfortranarray(np.ones((3, 2))),
    ],
    ids=["single", "strided", "two axes", "whole", "fortran"],
)
def test_an_array_of_another_kind_is_refused(wrong: Any) -> None:
    with pytest.raises(TypeError, match=r"in place of a contiguous f8\[:\]"):
        _ranked(wrong, 0, 2, np.empty(3))


def test_too_few_arguments_are_refused() -> None:
    with pytest.raises(ValueError, match="shorter"):
        _ranked(np.zeros(4), 0, 2)


def test_arrays_that_cannot_be_written_to_are_read() -> None:
    given = np.ones(4)
    given.setflags(write=False)
    found = np.empty(4)
    _pole_zero(np.array([1.0, 0.0]), np.array([1.0, -0.5]), given, found)
    assert found.tolist() == [1.0, 1.5, 1.75, 1.875]


def test_memory_that_cannot_be_had_is_an_error() -> None:
    """The window of the ranks is an array that the function makes: of these terabytes there is none."""
    with pytest.raises(MemoryError, match="ranked did not come to its end"):
        _ranked(np.zeros(4), 0, 1 << 50, np.empty(3))


def test_calls_leave_no_memory_behind() -> None:
    import resource

    found = np.empty(1)
    window = 1 << 20  # 8 MB

    def used() -> int:
        _ranked(np.zeros(window), 0, window, found)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    used()
    before = used()
    for _ in range(40):
        _ranked(np.zeros(2), 0, window, found[:0])
    assert used() - before < 40_000  # kilobytes; 320 MB if they were kept


def test_threads_call_at_once() -> None:
    wave = np.sin(np.linspace(0.0, 300.0, 5000))
    expected, found = peaks(wave, 0.1).tolist(), []
    threads = [threading.Thread(target=lambda: found.append(peaks(wave, 0.1).tolist())) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 8


def test_prepared_arguments_stand_for_themselves() -> None:
    signal, found, again = np.array([3.0, 1.0, 2.0]), np.empty(2), np.empty(2)
    _ranked(signal, 0, 2, found)
    _ranked(_ranked.prepared(0, signal), 0, 2, again)
    assert found.tolist() == again.tolist() == [1.0, 1.0]


def test_the_machine_code_is_the_function_that_is_written() -> None:
    random = np.random.default_rng(3)
    written = importlib.import_module("msd_ident.estimate.damped_step_loops").damped_step.py_func
    for _ in range(20):
        jacobian = random.standard_normal((5, 30))
        bounds = np.full(5, -0.03), np.full(5, 0.02)
        given = (jacobian @ jacobian.T, random.standard_normal(5), (0.1, 1e-12), bounds)
        ways = []
        for way in (_damped_step, written):
            move, decrease = np.zeros(5), np.empty(1)
            way(*given, (move, decrease))
            ways.append([*move, *decrease])
        assert ways[0] == pytest.approx(ways[1], rel=1e-12)


def test_a_library_is_loaded_once(monkeypatch: pytest.MonkeyPatch) -> None:
    peaks(np.zeros(3), 0.1)
    monkeypatch.setattr(loading, "natives", lambda *given: pytest.fail("it is loaded again"))
    _ranked.library.load()

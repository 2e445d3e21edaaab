"""Cancelling work that takes long: between two simulations a fit asks whether anybody still waits for it.

Who starts the work says with ``cancel_when`` how to ask; the work below calls ``raise_if_cancelled``. The question
belongs to the context, so that two works in two threads do not stop each other; ``in_this_context`` takes it into a
thread of a pool.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from typing import ParamSpec, TypeVar

_Given = ParamSpec("_Given")
_Done = TypeVar("_Done")

_asked: ContextVar[Callable[[], bool] | None] = ContextVar("asked", default=None)


class Cancelled(Exception):
    """The work was stopped on request: neither an error nor a result."""


@contextmanager
def cancel_when(asked: Callable[[], bool]) -> Iterator[None]:
    """Work inside the block ends with ``Cancelled`` soon after ``asked()`` has become true."""
    token = _asked.set(asked)
    try:
        yield
    finally:
        _asked.reset(token)


def raise_if_cancelled() -> None:
    """Go on, or not.

    Raises:
        Cancelled: the work was asked to stop.
    """
    asked = _asked.get()
    if asked is not None and asked():
        raise Cancelled


def in_this_context(work: Callable[_Given, _Done]) -> Callable[_Given, _Done]:
    """The same work, to be called once in another thread, stoppable as it would be here."""
    context = copy_context()

    def call(*args: _Given.args, **kwargs: _Given.kwargs) -> _Done:
        return context.run(work, *args, **kwargs)

    return call

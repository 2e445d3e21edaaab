"""Running one node: spin in a thread, wait for a signal, shut down once and cleanly."""

from __future__ import annotations

import os
import sys
import threading
import time
import traceback
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import rclpy
from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException, ShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from msd_ident.errors import DataError, UsageError, fail
from msd_ident.ros.common.signals import Signals

#: Rounds of an executor in which what it waits for may be destroyed, one after the other.
_ROUNDS = 20
#: Tasks that follow from each other until the end of a piece of work is answered: the goal's, its result's, the answer.
_FOLLOWS = 5
#: Longest time for them, and time in which an answer leaves the process [s].
_PATIENCE, _LEAVES = 3.0, 0.2


class NodeOwner(ABC):
    """Owns a node that ``run`` spins.

    Attributes:
        node: the node.
    """

    node: Node

    @property
    def failure(self) -> str:
        """Why the work could not be done; empty when it was, and where nothing that happens to it ends the node."""
        return ""

    def on_signal(self, number: int) -> None:  # noqa: B027 - most nodes take no signal but the ending ones
        """Called in the executor for a signal that does not end the node."""

    def release(self) -> bool:
        """End the work that clients wait for, called before ``close``, while the executor still answers them; whether
        there was any. Most nodes answer at once.
        """
        return False

    @abstractmethod
    def close(self) -> bool:
        """Finish all work, called once, when nothing spins any more; whether no thread is left."""


class Spinner:
    """An executor that spins in a thread of its own.

    A single-threaded executor costs a quarter of the processor time of a multi-threaded one at 1 kHz; services that
    take long are coroutines that wait for a worker thread, so that no subscription waits for them.
    """

    def __init__(self, *nodes: Node, on_failure: Callable[[], None] = lambda: None) -> None:
        self.executor = SingleThreadedExecutor(context=nodes[0].context)
        for node in nodes:
            self.executor.add_node(node)
        self.failed = False
        self._on_failure = on_failure
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="executor", daemon=True)
        self._thread.start()

    def flush(self) -> None:
        """Wait until the executor has done what was ready, and what follows from that, and answers have left."""
        until = time.monotonic() + _PATIENCE
        for _ in range(_FOLLOWS):
            done = threading.Event()
            self.executor.create_task(done.set)
            if not done.wait(timeout=max(until - time.monotonic(), 0.0)):
                return
        time.sleep(_LEAVES)

    def stop(self) -> None:
        """End the spinning and wait for its end.

        The thread leaves by itself before the executor is taken down: rclpy's shutdown destroys at once what a spinning
        executor waits on, and the thread would end with a traceback now and then.
        """
        if self._ending.is_set():
            return
        self._ending.set()
        self.executor.create_task(lambda: None)  # to be woken alone does not end a ``spin_once``
        self._thread.join(timeout=5.0)
        self.executor.shutdown(timeout_sec=2.0)

    def _spin(self) -> None:
        try:
            while not self._ending.is_set() and self.executor.context.ok():
                self._spin_once()
        except (ExternalShutdownException, ShutdownException):
            pass
        except Exception:
            self.failed = True
            traceback.print_exc()
            self._on_failure()

    def _spin_once(self) -> None:
        """One round of the executor. What another thread destroyed while the executor collected it is not there in the
        next round: rclpy excludes such timers and subscriptions itself, but not the events of publishers (its issue
        1284).
        """
        for left in reversed(range(_ROUNDS)):
            try:
                self.executor.spin_once()
            except InvalidHandle:
                if not left:
                    raise
            else:
                return


@contextmanager
def spun(name: str, namespace: str, domain: int | None = None) -> Iterator[Node]:
    """A node of this process in a context of its own, which an executor spins for the block."""
    context = rclpy.Context()
    try:
        rclpy.init(context=context, domain_id=domain, args=[], signal_handler_options=SignalHandlerOptions.NO)
        node = Node(name, namespace=namespace, context=context)
        spinner = Spinner(node)
        try:
            yield node
        finally:
            spinner.stop()
            node.destroy_node()
    finally:
        context.try_shutdown()


def run(make: Callable[[], NodeOwner], signals: Signals, args: Sequence[str] | None = None) -> int:
    """Make the node, spin it until a signal, close it; the exit code.

    Raises:
        MsdError: the node cannot be made as asked.
    """
    if signals.ended:
        return 0
    try:
        rclpy.init(args=list(sys.argv if args is None else args), signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # rclpy has several kinds for bad arguments, all with a sentence of many lines
        raise UsageError(f"ROS cannot start: {_first_line(error)}; expected valid --ros-args") from None
    try:
        owner = _made(make)
        spinner = Spinner(owner.node, on_failure=signals.finish)
        try:
            for number in signals.wait():
                spinner.executor.create_task(owner.on_signal, number)
        finally:
            if owner.release():
                spinner.flush()
            spinner.stop()
            ended = owner.close()
            owner.node.destroy_node()
        code = fail(DataError(owner.failure)) if owner.failure else int(spinner.failed)
    finally:
        rclpy.try_shutdown()
    if not ended:
        # A fit goes on in compiled code, which nobody can interrupt: the process must not wait for it.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    return code


def _made(make: Callable[[], NodeOwner]) -> NodeOwner:
    from rclpy.exceptions import InvalidTopicNameException, ParameterException

    try:
        return make()
    except (ParameterException, InvalidTopicNameException) as error:
        raise UsageError(f"{_first_line(error)}; expected what the parameter's description says") from None


def _first_line(error: Exception) -> str:
    return (str(error) or type(error).__name__).strip().splitlines()[0].rstrip(".")

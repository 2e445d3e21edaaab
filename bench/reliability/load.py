"""``python -m bench.reliability.load``: lost samples, fits and memory of the nodes on busy cores."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import WrenchStamped
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

from bench.live import memory
from bench.reliability.page import Row, put
from msd_ident.data.quality import missing_in
from msd_ident.io import SourceOptions, iterate_messages, read
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import time_message
from msd_ident.ros.common.domain import private_domain, private_environment
from msd_ident.ros.common.node_runner import Spinner
from msd_ident.ros.common.processes import Processes
from msd_ident.ros.demo.demo import NAMESPACE, RIG, STEP, arguments

#: The rig's latency [s], and that a force stays until the next one.
OF_RIG = {"latency": 0.1, "hold_last_command": True}
#: Time between two fits, of the live buffer's length, and between two changes of the force [s].
FIT_PERIOD, BUFFER, HELD = 5.0, 10.0, 1.5
#: Processes that do nothing but burn a core.
BURNERS = 2
#: Part of the time, but at least so long [s], after which memory is expected to be flat: buffers are full then.
WARM_UP, WARM_UP_LEAST = 0.2, 20.0
#: Growth of memory that is flat.
FLAT = 0.05
NODES = ("rig", "recorder", "identifier")


@dataclass
class Load:
    """Result of a run under load.

    Attributes:
        rate, seconds: of the rig [Hz], and how long it was recorded.
        samples, messages: in the bag.
        missing: samples that the stamps in the bag lack.
        said: by the recorder at its end.
        fits: instants and durations [s].
        refused: fits that were none, in words.
        memory: of each node, instants [s] and MiB.
    """

    rate: float
    seconds: float
    samples: int = 0
    messages: int = 0
    missing: int = 0
    said: str = ""
    fits: list[tuple[float, float]] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)
    memory: dict[str, list[tuple[float, float]]] = field(default_factory=lambda: {name: [] for name in NODES})

    def change(self, node: str) -> tuple[float, float, float]:
        """Memory of a node when it was warm; growth of its level until the end, and the most at any instant afterwards,
        in parts of that. A fit that is computed at that instant holds its arrays, so that instants tell no level.
        """
        warm = max(WARM_UP * self.seconds, WARM_UP_LEAST)
        kept = np.array([used for at, used in self.memory[node] if at >= warm])
        part = max(kept.size // 5, 1)
        level = float(np.median(kept[:part]))
        return level, float(np.median(kept[-part:])) / level - 1.0, float(kept.max()) / level - 1.0

    @property
    def wrong(self) -> list[str]:
        """What is not as it must be."""
        found = [f"{self.missing} samples are missing in the bag"] if self.missing else []
        found += [] if ", none lost, in " in self.said else [f"the recorder said: {self.said}"]
        found += [f"{len(self.refused)} fits failed: {self.refused[0]}"] if self.refused else []
        for node in NODES:
            level, growth, _ = self.change(node)
            if growth > FLAT:
                found.append(f"memory of the {node} was {level:.0f} MiB and grew by {growth:.1%}")
        return found

    @property
    def row(self) -> Row:
        """For the table."""
        took = [duration for _, duration in self.fits]
        apart = np.diff([at for at, _ in self.fits])
        used = ", ".join(f"{node} {level:.0f} MiB, grew by {growth:.1%}, at most {most:+.1%} at any instant"
                         for node in NODES for level, growth, most in [self.change(node)])  # fmt: skip
        how = "messages in batches" if self.messages < self.samples else "single messages"
        wrong = "; ".join(self.wrong)
        outcome = (
            f"{self.missing} of {self.samples} samples missing in the bag by their stamps; the recorder said "
            f"“{self.said.partition(', in ')[0]}”; {len(took)} fits, one every {np.mean(apart):.1f} s, the slowest "
            f"took {max(took):.1f} s; memory after the warm-up: {used}{'; FAILED: ' + wrong if wrong else ''}"
        )
        return Row(f"{self.rate:g} Hz, {how}, {self.seconds / 60.0:.3g} min", 1, outcome)


class Tester:
    """Pushes the rig, asks for fits, looks at the memory; all in one thread."""

    def __init__(self, node: Node, processes: Processes, found: Load) -> None:
        self._node, self._processes, self._found = node, processes, found
        self._force = node.create_publisher(WrenchStamped, names.FORCE, names.force_qos())
        self._identify = node.create_client(Trigger, names.TRIGGER, qos_profile=names.service_qos())
        self._stop = node.create_client(Trigger, names.RECORDER_STOP, qos_profile=names.service_qos())
        self._asked: tuple[float, Future] | None = None
        self._pushed = -HELD
        self._up = False

    def wait(self, true: Callable[[], object], what: str, seconds: float = 120.0) -> None:
        """Wait for what must come.

        Raises:
            RuntimeError: it does not.
        """
        deadline = time.monotonic() + seconds
        while not true():
            self._processes.check()
            if time.monotonic() > deadline:
                raise RuntimeError(f"waited {seconds:g} s for {what}")
            time.sleep(0.01)

    def ready(self) -> None:
        """Wait for the three nodes."""
        encoder = names.ENCODER_BATCH if self._found.rate > 2000.0 else names.ENCODER
        self.wait(lambda: self._force.get_subscription_count() >= len(NODES), "all to hear the force")
        self.wait(lambda: self._node.count_publishers(encoder), "the rig")
        self.wait(lambda: self._node.count_subscribers(encoder) >= 2, "recorder and identifier to hear the rig")
        self.wait(self._identify.service_is_ready, "the identifier")
        self.wait(self._stop.service_is_ready, "the recorder")

    def run(self, seconds: float, tell: Callable[[str], None]) -> None:
        """Push, fit and look until the time is over; then the bag is closed."""
        start, told = time.monotonic(), 0.0
        while (now := time.monotonic() - start) < seconds:
            self._processes.check()
            self._push(now)
            self._fit(now)
            for name in NODES:
                self._found.memory[name].append((now, memory(self._processes.pid(name))))
            if now - told >= 30.0:
                told = now
                tell(
                    f"{now:.0f} s: " + ", ".join(f"{name} {self._found.memory[name][-1][1]:.1f} MiB" for name in NODES)
                )
            time.sleep(0.2)
        stopped = self._stop.call_async(Trigger.Request())
        self.wait(stopped.done, "the recorder to stop")
        self._found.said = stopped.result().message

    def _push(self, now: float) -> None:
        if now - self._pushed < HELD:
            return
        self._pushed, self._up = now, not self._up
        message = WrenchStamped()
        message.header.stamp = time_message(time.time_ns() + 500_000_000)
        message.wrench.force.x = STEP if self._up else 0.0
        self._force.publish(message)

    def _fit(self, now: float) -> None:
        """Ask for a fit when it is time and the last one is there."""
        if self._asked is None:
            if now >= BUFFER and (not self._found.fits or now - self._found.fits[-1][0] >= FIT_PERIOD):
                self._asked = now, self._identify.call_async(Trigger.Request())
            return
        at, answer = self._asked
        if answer.done():
            self._asked = None
            self._found.fits.append((at, now - at))
            if not answer.result().success:
                self._found.refused.append(answer.result().message)


@contextmanager
def burning(count: int = BURNERS) -> Iterator[None]:
    """So many processes that burn a core each, for the block."""
    burners = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for burner in burners:
            burner.kill()
            burner.wait()


def load(rate: float, seconds: float, folder: Path, tell: Callable[[str], None]) -> Load:
    """The three nodes under load, and what is in their bag afterwards."""
    found = Load(rate, seconds)
    with private_domain() as domain, Processes(folder, private_environment(domain)) as processes, burning():
        processes.start("rig", "msd_sim.node", arguments({**RIG, "rate": rate, **OF_RIG}))
        recorder = {"bag_folder": str(folder), "folder": "bag", "autostart": True}
        processes.start("recorder", "msd_ident.ros.recorder", arguments(recorder))
        buffer = {"buffer_samples": round(rate * BUFFER), "auto_fit": False}
        processes.start("identifier", "msd_ident.ros.identifier", arguments(buffer))
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        node = Node("load", namespace=NAMESPACE, context=context)
        spinner = Spinner(node)
        try:
            tester = Tester(node, processes, found)
            tester.ready()
            tester.run(seconds, tell)
        finally:
            spinner.stop()
            node.destroy_node()
            rclpy.shutdown(context=context)
    count_samples(folder / "bag", found)
    return found


def count_samples(bag: Path, found: Load) -> None:
    """What the bag holds, by the stamps of its samples."""
    record = read(bag, SourceOptions())
    found.samples, found.missing = record.samples, missing_in(record.time)
    found.messages = sum("encoder" in message.topic for message in iterate_messages(bag))


def main() -> int:
    """1 kHz single and 10 kHz in batches; 0 when nothing was lost and memory stayed flat."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, nargs=2, default=(10.0, 5.0), help="at 1 and at 10 kHz; 0: not at all")
    parser.add_argument("--write", action="store_true", help="write the table into docs/reliability.md")
    given = parser.parse_args()
    found = []
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    for rate, minutes in zip((1000.0, 10_000.0), given.minutes, strict=True):
        if not minutes:
            continue
        with tempfile.TemporaryDirectory() as folder:
            found.append(load(rate, 60.0 * minutes, Path(folder), lambda line: print(line, flush=True)))
            print(found[-1].row.line, flush=True)
        if given.write:
            put(f"load_{rate:g}", [found[-1].row], f"{os.cpu_count()} cores, {BURNERS} processes that keep them busy")
    return 1 if any(one.wrong for one in found) else 0


if __name__ == "__main__":
    sys.exit(main())

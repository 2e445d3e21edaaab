"""The recorder node, a process of its own, killed while it records what another node sends."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bench.reliability.kills import RATE, Found, message
from bench.reliability.readers import READERS
from msd_ident.io import iterate_messages, repair
from msd_ident.ros.common.domain import PRIVATE, private_domain

#: Seconds that a node may take to start.
_START = 60.0


def kill_nodes(root: Path, seeds: range, longest: float) -> Iterator[Found]:
    """Recorder nodes killed up to ``longest`` seconds after the first message is in their bag, one after the other."""
    import rclpy
    from std_msgs.msg import UInt64

    with private_domain() as domain:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        node = rclpy.create_node("sender", context=context)
        publisher = node.create_publisher(UInt64, "/count", 1000)
        try:
            for seed in seeds:
                with _recorder(root, f"bag_{seed}", domain) as process:
                    numbers = iter(range(10**9))

                    def send(numbers: Iterator[int] = numbers) -> None:
                        for _ in range(RATE // 100):
                            publisher.publish(message(next(numbers)))
                        time.sleep(0.01)

                    folder = root / f"bag_{seed}"
                    _until_recorded(folder, process, send)
                    end = time.monotonic() + random.Random(seed).uniform(0.0, longest)
                    while time.monotonic() < end:
                        send()
                    process.kill()
                    ended = time.time_ns()
                    process.wait()
                yield _check(folder, ended)
        finally:
            node.destroy_node()
            context.shutdown()


@contextmanager
def _recorder(root: Path, name: str, domain: int) -> Iterator[subprocess.Popen[bytes]]:
    parameters = {"autostart": "true", "bag_folder": str(root), "folder": name, "topics": "[/count]"}
    options = [word for key, value in parameters.items() for word in ("-p", f"{key}:={value}")]
    command = [sys.executable, "-m", "msd_ident.ros.recorder", "--ros-args", *options]
    environment = {**os.environ, **PRIVATE, "ROS_DOMAIN_ID": str(domain)}
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, env=environment, stdout=quiet, stderr=quiet) as process:
        try:
            yield process
        finally:
            process.kill()


def _until_recorded(folder: Path, process: subprocess.Popen[bytes], send: object) -> None:
    end = time.monotonic() + _START
    while not (folder / "metadata.yaml").exists() or not any(True for _ in iterate_messages(folder)):
        if time.monotonic() > end or process.poll() is not None:
            raise RuntimeError(f"no recording in {folder} within {_START:g} s")
        send()  # type: ignore[operator]


def _check(folder: Path, ended_ns: int) -> Found:
    """All readers agree on messages that count up without a gap; so they do after a repair."""
    before = _read(folder)
    last = max(one.log_time_ns for one in iterate_messages(folder))
    done = repair(folder)
    if done.messages < len(before) or _read(folder)[: len(before)] != before:
        raise AssertionError(f"repaired: {done.sentence}")
    return Found("after kill -9 of the node", len(before), (ended_ns - last) / 1e9)


def _read(folder: Path) -> list[int]:
    found = {name: [int.from_bytes(raw[4:12], "little") for raw in reader(folder)] for name, reader in READERS.items()}
    numbers = found["msd"]
    if any(other != numbers for other in found.values()):
        raise AssertionError(f"the readers differ: { {name: len(values) for name, values in found.items()} }")
    if numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        raise AssertionError("messages are missing between the first and the last")
    return numbers

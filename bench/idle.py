"""What rig, identifier, recorder and experimenter cost with nothing to do, in cores, at 1 kHz.

.venv/bin/python -m bench.idle --seconds 20
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from pathlib import Path

from msd_ident.ros.common.domain import private_domain, private_environment
from msd_ident.ros.common.processes import Processes
from msd_ident.ros.demo.demo import arguments

NODES = ("identifier", "recorder", "experimenter")
#: Longest time that the nodes get to be ready [s].
LONGEST_START = 60.0


def main() -> None:
    """Start them, let them settle, and count processor time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=1000.0)
    given = parser.parse_args()
    for name, cores in measure(given.seconds, given.rate).items():
        print(f"{name}: {cores:.3f} of a core")
    print(f"load of the machine: {os.getloadavg()[0]:.1f}")


def measure(seconds: float, rate: float) -> dict[str, float]:
    """Processor time of each node in a second of the wall's, over some seconds."""
    with tempfile.TemporaryDirectory() as name, private_domain() as domain:
        folder = Path(name)
        with Processes(folder, private_environment(domain)) as processes:
            processes.start("rig", "msd_sim.node", arguments({"rate": rate}))
            for node in NODES:
                processes.start(node, f"msd_ident.ros.{node}", arguments({"bag_folder": str(folder)}))
            pids = {node: processes.pid(node) for node in ("rig", *NODES)}
            _settle(pids)
            processes.check()
            before = {node: _used(pid) for node, pid in pids.items()}
            begin = time.monotonic()
            time.sleep(seconds)
            passed = time.monotonic() - begin
            return {node: (_used(pids[node]) - used) / passed for node, used in before.items()}


def _settle(pids: dict[str, int]) -> None:
    """Wait until solver and nodes are ready: none takes half a core any more, three seconds in a row."""
    before, calm = {node: 0.0 for node in pids}, 0
    deadline = time.monotonic() + LONGEST_START
    while calm < 3 and time.monotonic() < deadline:
        time.sleep(1.0)
        used = {node: _used(pid) for node, pid in pids.items()}
        busy = max(used[node] - before[node] for node in pids)
        calm, before = (calm + 1 if busy < 0.5 else 0), used


def _used(pid: int) -> float:
    """Processor time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


if __name__ == "__main__":
    main()

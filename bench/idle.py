"""What rig, identifier, recorder and experimenter cost with nothing to do at 1 kHz: cores, and how often they wake.

.venv/bin/python -m bench.idle --seconds 20
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from msd_ident.ros.common.domain import private_domain, private_environment
from msd_ident.ros.common.processes import Processes
from msd_ident.ros.demo.demo import arguments

NODES = ("identifier", "recorder", "experimenter")
#: Longest time that the nodes get to be ready [s].
LONGEST_START = 60.0


@dataclass(frozen=True)
class Idle:
    """What a node with nothing to do takes.

    Attributes:
        cores: processor time in a second of the wall's.
        wakes: how often the busiest of its Python threads was woken in a second. DDS has threads of its own, whose
            wake-ups nobody here chooses.
    """

    cores: float
    wakes: float


def main() -> None:
    """Start them, let them settle, and count processor time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=1000.0)
    given = parser.parse_args()
    found = measure(given.seconds, given.rate)
    for name, idle in found.items():
        share = idle.cores / found["rig"].cores
        print(f"{name}: {idle.cores:.3f} of a core, {share:.2f} of the rig's, wakes {idle.wakes:.0f} times a second")
    print(f"load of the machine: {os.getloadavg()[0]:.1f}")


def measure(seconds: float, rate: float) -> dict[str, Idle]:
    """What each node takes over some seconds [s] of messages at a rate [Hz]."""
    with tempfile.TemporaryDirectory() as name, private_domain() as domain:
        folder = Path(name)
        with Processes(folder, private_environment(domain)) as processes:
            processes.start("rig", "msd_sim.node", arguments({"rate": rate}))
            for node in NODES:
                processes.start(node, f"msd_ident.ros.{node}", arguments({"bag_folder": str(folder)}))
            pids = {node: processes.pid(node) for node in ("rig", *NODES)}
            _settle(pids)
            processes.check()
            before = {node: (_used(pid), _woken(pid)) for node, pid in pids.items()}
            begin = time.monotonic()
            time.sleep(seconds)
            passed = time.monotonic() - begin
            processes.check()
            return {node: _since(pids[node], *at, passed) for node, at in before.items()}


def _since(pid: int, used: float, woken: dict[str, int], passed: float) -> Idle:
    """What a process took in the time [s] passed since its counters stood so."""
    wakes = [count - woken.get(thread, 0) for thread, count in _woken(pid).items()]
    return Idle((_used(pid) - used) / passed, max(wakes) / passed)


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


def _woken(pid: int) -> dict[str, int]:
    """How often each Python thread of a process has waited and was woken since it began."""
    found = {}
    for task in Path(f"/proc/{pid}/task").iterdir():
        if not (task / "comm").read_text().startswith("dds."):
            counter = (task / "status").read_text().partition("\nvoluntary_ctxt_switches:")[2]
            found[task.name] = int(counter.split()[0])
    return found


if __name__ == "__main__":
    main()

"""The demo: rig, recorder and identifier as processes on a domain of their own, and the paper's experiment."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from msd_ident.data.record import Record
from msd_ident.errors import DataError
from msd_ident.io import read
from msd_ident.ros.common.domain import in_domain, private_domain, private_environment
from msd_ident.ros.common.node_runner import spun
from msd_ident.ros.common.processes import Processes
from msd_ident.ros.experimenter.paper_experiment import Plan, Player
from msd_ident.workflow.identification import Identification

#: The paper's rig: its Table 3, eq. 8's encoder of 2266 counts/cm at 1 kHz.
RIG: dict[str, object] = {
    "mass": 0.9407,
    "damping": 3.927,
    "stiffness": 694.1,
    "friction_coefficient": 0.0133,
    "encoder.counts_per_metre": 226600.0,
    "rate": 1000.0,
    "hold_last_command": True,  # the rig ends with the demo, and its forces are sent ahead, faster than the wall
}
#: Step amplitude 0.15 at 69.5 N per unit, eq. 8 [N].
STEP = 0.15 * 69.5
#: Speed of the rig's time with ``fast``.
FAST = 5.0
#: Position samples that the identifier keeps: with ``fast``, those of 400 s of the wall's time. A window of the live
#: buffer is given relative to its first sample, so that one must still be there when a slow machine comes to ask.
BUFFER = 2_000_000
NAMESPACE = "msd"

Say = Callable[[str, float], None]


@dataclass(frozen=True)
class Shown:
    """What the demo has to show.

    Attributes:
        bag: the recorded bag.
        recorded: what is in it, in a sentence.
        found: identification of the bag, by the same path as ``msd identify``.
        live_difference: greatest relative difference of the refined parameters between the live buffer and the bag,
            over the same samples.
    """

    bag: Path
    recorded: str
    found: Identification
    live_difference: float


def run(folder: Path, fast: bool, say: Say) -> Shown:
    """Play the experiment; everything that was started has ended afterwards.

    Args:
        folder: for the bag and the logs; exists.
        fast: whether the rig makes its own time, faster than the wall.
        say: called with what is being done and the part of all that is done (0 to 1).

    Raises:
        SetupError: a process does not come up.
        DataError: the service's numbers are not those of the bag.
    """
    logs = folder / "logs"
    logs.mkdir()
    with private_domain() as domain, Processes(logs, private_environment(domain)) as processes:
        say("starting rig, recorder and identifier", 0.0)
        _start(processes, folder, fast)
        with _player(domain, processes) as player:
            return _play(player, fast, say)


def _start(processes: Processes, folder: Path, fast: bool) -> None:
    simulated: dict[str, object] = {"use_sim_time": True} if fast else {}
    mode: dict[str, object] = {"time_mode": "fast", "real_time_factor": FAST} if fast else {}
    processes.start("rig", "msd_sim.node", arguments(RIG | mode))
    shared: dict[str, object] = {"bag_folder": str(folder), "diagnostics_period": 0.1} | simulated
    processes.start("recorder", "msd_ident.ros.recorder", arguments(shared))
    processes.start("identifier", "msd_ident.ros.identifier", arguments(shared | {"buffer_samples": BUFFER}))


def arguments(parameters: dict[str, object]) -> list[str]:
    """Command line of a node with these parameters, in the demo's namespace."""
    given = [
        ["-p", f"{name}:={str(value).lower() if isinstance(value, bool) else value}"]
        for name, value in parameters.items()
    ]
    return ["--ros-args", "-r", f"__ns:=/{NAMESPACE}", *(word for pair in given for word in pair)]


@contextmanager
def _player(domain: int, processes: Processes) -> Iterator[Player]:
    """A player in this process, in the private domain."""
    with in_domain(domain), spun("demo", NAMESPACE, domain) as node:
        yield Player(node, processes.check)


def _play(player: Player, fast: bool, say: Say) -> Shown:
    from msd_ident.ros.common.result_messages import differences, to_estimate
    from msd_ident.workflow import pipeline

    say("waiting until all nodes are connected", 0.02)
    player.wait_for_all()
    say("recording", 0.15)
    bag = player.record("paper")
    plan = Plan(force=STEP, rest=0.5, up=3.0, down=3.0, lead=0.5 * (FAST if fast else 1.0))
    player.play(plan, lambda done: say("playing the paper's experiment", 0.2 + 0.6 * done))
    recorded = player.stop_recording()
    say("asking the identifier", 0.82)
    record = read(bag)
    live = _live(player, record)  # first, as the buffer grows meanwhile
    answer = player.identify(bag)
    say("identifying the bag", 0.9)
    found = pipeline.identify([record])
    different = differences(answer, to_estimate(found, bag, 0))
    if different:
        raise DataError(f"service and bag differ in {', '.join(different)}; expected the same numbers: report this")
    say("comparing with the live buffer", 0.98)
    difference = max(abs(live[name] / quantity.value - 1.0) for name, quantity in found.refined.parameters.items())
    say("done", 1.0)
    return Shown(Path(bag), recorded, found, difference)


def _live(player: Player, record: Record) -> dict[str, float]:
    """Refined parameters from the part of the live buffer that is in the bag: the same but for rounding."""
    from msd_ident.ros.common.conversions import nanoseconds
    from msd_ident.ros.common.result_messages import stamp_of

    begin = nanoseconds(player.identify().window_start)  # before the bag's
    start, end = ((stamp_of(record, index) - begin) / 1e9 for index in (0, -1))
    return {parameter.name: parameter.value for parameter in player.identify(start=start, end=end).refined}

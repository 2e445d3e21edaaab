"""Experiments on the graph: played to their end, and stopped with force 0 by travel, silence and the user."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.action import ActionClient  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402

from msd_ident.cli.main import main  # noqa: E402
from msd_ident.design import Limits, Profile, Segment  # noqa: E402
from msd_ident.design.profile_file import to_yaml  # noqa: E402
from msd_ident.errors import SetupError, UsageError  # noqa: E402
from msd_ident.io import SourceOptions, read  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.common.conversions import nanoseconds, time_message  # noqa: E402
from msd_ident.ros.experimenter import late_forces, profile_player, session  # noqa: E402
from msd_ident.ros.experimenter.node import Experimenter  # noqa: E402
from msd_ident.ros.experimenter.profile_player import Experiment, Played, ProfilePlayer  # noqa: E402
from msd_ident.ros.recorder.recording import Recording  # noqa: E402
from msd_interfaces.action import RunExperiment  # noqa: E402
from msd_sim.node import lateness  # noqa: E402

LIMITS = Limits((-10.0, 10.0), (-0.03, 0.03), 20.0)
STEP = Profile((Segment("hold", 0.2), Segment("step", 0.6, force=5.0), Segment("release", 0.3)), "step")
LONG = Profile((Segment("step", 15.0, force=5.0),), "long")


class Forces:
    """What the rig was told last."""

    def __init__(self, ros: Graph) -> None:
        self.all: list[float] = []
        ros.node.create_subscription(WrenchStamped, names.FORCE, self._take, names.force_qos())

    def _take(self, message: WrenchStamped) -> None:
        self.all.append(message.wrench.force.x)


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def rig(ros: Graph, **parameters: object) -> object:
    from msd_sim.node.rig_node import RigNode

    given = {"rate": 200.0, **parameters}
    node = RigNode(
        context=ros.context, parameter_overrides=[Parameter(name, value=value) for name, value in given.items()]
    )
    ros.spin(node)
    return node


def play(ros: Graph, profile: Profile, bag: Path, limits: Limits = LIMITS, **more: object) -> Played:
    made = ProfilePlayer(ros.node, silence=float(more.pop("silence", 5.0)))  # type: ignore[arg-type]
    stop = more.pop("stop", threading.Event())
    advance = more.pop("advance", lambda part, force, at: None)
    return made.play(Experiment(profile, limits, bag), stop, advance)  # type: ignore[arg-type]


def test_a_profile_is_played_and_recorded(ros: Graph, tmp_path: Path) -> None:
    rig(ros)
    done = play(ros, STEP, tmp_path / "bag")
    assert done.stopped == "" and done.commands == 4
    record = read(tmp_path / "bag", SourceOptions())
    pushes = record.force_time[record.force == 5.0]
    let_go = record.force_time[(record.force == 0.0) & (record.force_time > pushes[0])][0]
    assert let_go - pushes[0] == pytest.approx(0.6, abs=0.1 + done.worst)
    pushed = record.position[(record.time > pushes[0]) & (record.time < let_go)]
    assert pushed.max() - record.position[0] == pytest.approx(5.0 / 694.1 * 1.78, rel=0.1)


def test_what_waits_in_queues_at_the_end_is_recorded(
    ros: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig(ros)
    push = ProfilePlayer._push
    sent: list[float] = []

    def held_up(self: ProfilePlayer, newtons: float, stamp: int) -> None:
        push(self, newtons, stamp)
        sent.append(newtons)
        if newtons == 5.0:
            ros._spinners[0].executor.create_task(time.sleep, 2.0)

    monkeypatch.setattr(ProfilePlayer, "_push", held_up)
    play(ros, STEP, tmp_path / "bag")
    record = read(tmp_path / "bag", SourceOptions())
    after = record.force[record.force.tolist().index(5.0) + 1 :]
    assert len(after) == len(sent) - sent.index(5.0) - 1 and not after.any(), "the release, the end, and force 0"
    assert record.time[-1] > record.force_time[-1] - 0.05


def test_stamps_of_another_clock_are_not_waited_for(ros: Graph, monkeypatch: pytest.MonkeyPatch) -> None:
    """An encoder that counts from its boot never comes to this clock's time."""
    made = ProfilePlayer(ros.node)

    def never(_seconds: float) -> None:
        raise AssertionError("nothing is left to wait for")

    monkeypatch.setattr(profile_player, "time", SimpleNamespace(monotonic=time.monotonic, sleep=never))
    made._latest = (5 * 10**9, 0.0)
    made._catch_up(profile_player.REST)
    made._latest = (ros.node.get_clock().now().nanoseconds - 10**9, 0.0)
    with pytest.raises(AssertionError, match="nothing is left"):
        made._catch_up(profile_player.REST)


def test_leaving_the_travel_stops_with_force_0(ros: Graph, tmp_path: Path) -> None:
    rig(ros)
    told = Forces(ros)
    done = play(ros, LONG, tmp_path / "bag", Limits((-10.0, 10.0), (-0.005, 0.005), 20.0))
    assert done.stopped.startswith("the cart left its travel: 0.005")
    until(lambda: told.all and told.all[-1] == 0.0, "force 0")
    record = read(tmp_path / "bag", SourceOptions())
    assert record.duration < 5.0
    assert record.force[-1] == 0.0


def test_a_speed_limit_stops(ros: Graph, tmp_path: Path) -> None:
    rig(ros)
    done = play(ros, LONG, tmp_path / "bag", Limits((-10.0, 10.0), (-0.03, 0.03), 20.0, speed=0.05))
    assert done.stopped.startswith("the cart is too fast")


def test_a_silent_encoder_stops_with_force_0(ros: Graph, tmp_path: Path) -> None:
    node = rig(ros)
    told = Forces(ros)

    def advance(part: float, force: float, at: float) -> None:
        node.destroy_publisher(node._samples)  # type: ignore[attr-defined]
        node._publish_samples = lambda *_: None  # type: ignore[attr-defined]

    done = play(ros, LONG, tmp_path / "bag", advance=advance, silence=0.4)
    assert done.stopped.startswith(("the encoder fell silent: no reading for 0.4 s", "the encoder's readings come"))
    until(lambda: told.all and told.all[-1] == 0.0, "force 0")


def test_a_rig_that_ends_as_a_run_begins_is_silent_and_not_late(
    ros: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = rig(ros)
    record = ProfilePlayer._record

    def ended(self: ProfilePlayer, *given: object) -> Recording:
        node._publish_samples = lambda *_: None  # type: ignore[attr-defined]
        return record(self, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(ProfilePlayer, "_record", ended)
    done = play(ros, LONG, tmp_path / "bag", silence=0.5)
    assert done.stopped == "the encoder fell silent: no reading for 0.5 s"


def test_readings_that_come_late_stop_it(ros: Graph, tmp_path: Path) -> None:
    node = rig(ros)
    publish = node._publish_samples  # type: ignore[attr-defined]
    late: list[float] = []

    def advance(part: float, force: float, at: float) -> None:
        late.append(part)

    def later(index: object, stamps: np.ndarray, readings: object) -> None:
        publish(index, stamps - (10**9 if late else 0), readings)

    node._publish_samples = later  # type: ignore[attr-defined]
    done = play(ros, LONG, tmp_path / "bag", advance=advance, silence=0.5)
    assert re.fullmatch(r"the encoder's readings come 1\.0\d s later than before", done.stopped)


def test_the_bag_tells_the_unit_of_the_force(ros: Graph, tmp_path: Path) -> None:
    rig(ros)
    play(ros, replace(STEP, unit="V"), tmp_path / "bag")
    assert read(tmp_path / "bag", SourceOptions()).force_unit == "V"


def test_a_bag_that_takes_its_time_to_begin_is_no_silence(
    ros: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig(ros)
    begin = ProfilePlayer._record

    def slowly(self: ProfilePlayer, *given: object) -> Recording:
        time.sleep(1.5)
        return begin(self, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(ProfilePlayer, "_record", slowly)
    assert play(ros, STEP, tmp_path / "bag", silence=1.2).stopped == ""


def test_nothing_moves_beyond_the_limits_or_without_a_rig(
    ros: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = Forces(ros)
    with pytest.raises(UsageError, match="the limits allow -10 to 10; expected a profile within them"):
        play(ros, STEP.scaled(3.0), tmp_path / "bag")
    monkeypatch.setattr(profile_player, "ANSWER", 0.3)
    with pytest.raises(SetupError, match="no rig answers"):
        play(ros, STEP, tmp_path / "bag")
    assert not any(told.all)
    assert not (tmp_path / "bag").exists()


@pytest.mark.parametrize("stopped", ["cancelled", "the cart left its travel"])
def test_a_run_that_is_stopped_leaves_a_bag_that_can_be_identified(ros: Graph, tmp_path: Path, stopped: str) -> None:
    """The forces that were sent ahead are taken back: they come again, with 0, and did not act."""
    rig(ros, rate=500.0)
    sweep = Profile((Segment("sweep", 15.0, amplitude=8.0, low_hz=1.0, high_hz=8.0),), "sweep", rate=400.0)
    travel = 0.1 if stopped == "cancelled" else 0.011
    stop = threading.Event()

    def advance(part: float, force: float, at: float) -> None:
        if part > 0.08 and stopped == "cancelled":
            stop.set()

    done = play(
        ros, sweep, tmp_path / "bag", Limits((-10.0, 10.0), (-travel, travel), 20.0), stop=stop, advance=advance
    )
    assert done.stopped.startswith(stopped) and done.commands < 2000
    record = read(tmp_path / "bag", SourceOptions())
    pushed = record.force_time[record.force != 0.0]
    assert record.time[-1] - pushed[-1] > 0.0 and not record.force[-10:].any()
    assert any("of them replaced by a 0 that was sent later" in note for note in record.notes)


def test_forces_that_came_late_at_the_rig_are_told(ros: Graph, tmp_path: Path) -> None:
    """The player sent them in time: the rig alone knows."""
    node = rig(ros)
    take = node._commands._take  # type: ignore[attr-defined]

    def late(message: WrenchStamped) -> None:
        told = WrenchStamped(wrench=message.wrench)
        told.header.stamp = time_message(nanoseconds(message.header.stamp) - 300_000_000)
        take(told)

    node._commands._take = late  # type: ignore[attr-defined]
    done = play(ros, STEP, tmp_path / "bag")
    assert done.stopped == "" and done.late.count >= 1 and done.worst < 0.2 < done.late.worst
    assert "came late at the rig, by up to 0." in done.sentence and "--lead" in done.sentence
    assert Played(Path("bag"), "", 4, 0.0, 0.0).sentence.endswith("; bag")
    assert (late_forces.LATE, late_forces.LATE_WORST) == (lateness.LATE, lateness.LATE_WORST)


def test_ctrl_c_during_a_run_has_its_own_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def cancelled(experiment: Experiment, *_: object) -> Played:
        return Played(experiment.bag, profile_player.CANCELLED, 3, 0.0, 0.0)

    monkeypatch.setattr(session, "conductor", lambda *_: nullcontext(SimpleNamespace(play=cancelled)))
    monkeypatch.chdir(tmp_path)
    Path("l.yaml").write_text("force: 10\ntravel: 0.03\nduration: 20\n")
    Path("p.yaml").write_text(to_yaml(STEP))
    monkeypatch.setattr("sys.argv", ["msd", "run", "p.yaml", "--limits", "l.yaml", "--quiet"])
    assert main() == 130
    said = capsys.readouterr().err
    assert said == "msd: interrupted; the force is 0 and p_bag holds what was recorded until then\n"


def test_a_run_never_replaces_a_bag(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("l.yaml").write_text("force: 10\ntravel: 0.03\nduration: 20\n")
    Path("p.yaml").write_text(to_yaml(STEP))
    Path("old").mkdir()
    monkeypatch.setattr("sys.argv", ["msd", "run", "p.yaml", "--limits", "l.yaml", "--out", "old"])
    assert main() == 2
    assert capsys.readouterr().err == "msd: old exists; expected a new folder for the bag: give another --out\n"


def test_the_action_plays_and_a_cancelled_goal_stops(ros: Graph, tmp_path: Path) -> None:
    rig(ros)
    ros.add(Experimenter([Parameter("bag_folder", value=str(tmp_path))], context=ros.context))
    told = Forces(ros)
    client = ActionClient(ros.node, RunExperiment, names.RUN)
    assert client.wait_for_server(20.0)
    limits = "force: 10\ntravel: 0.03\nduration: 20\n"

    moved: list[float] = []

    def ask(profile: Profile, folder: str) -> object:
        goal = RunExperiment.Goal(profile=to_yaml(profile), limits=limits, folder=folder)
        return ros.sent(client, goal, lambda told: moved.append(told.feedback.position))

    refused = ask(STEP.scaled(3.0), "beyond")
    result = ros.within(refused.get_result_async)  # type: ignore[attr-defined]
    until(result.done, "the refusal")
    assert not result.result().result.success
    assert "expected a profile within them" in result.result().result.message
    handle = ask(LONG, "long")
    result = ros.within(handle.get_result_async)  # type: ignore[attr-defined]
    until(lambda: moved and abs(moved[-1]) > 1e-3, "the motion")
    second = ask(STEP, "other")
    assert not second.accepted  # type: ignore[attr-defined]
    handle.cancel_goal_async()  # type: ignore[attr-defined]
    until(result.done, "the result")
    answer = result.result().result
    assert answer.stopped == "cancelled" and not answer.success
    assert told.all[-1] == 0.0
    assert read(answer.bag_path, SourceOptions()).duration < 10.0
    client.destroy()

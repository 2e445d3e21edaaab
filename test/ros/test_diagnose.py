"""The diagnose action: the numbers of ``msd diagnose``, progress, cancelled within a second, refusals in words."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from action_msgs.msg import GoalStatus  # noqa: E402
from bagmaker import START_NS  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402

import msd_sim.api  # noqa: E402
from msd_ident import io  # noqa: E402
from msd_ident.cli import main as command  # noqa: E402
from msd_ident.data.record import Record  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_interfaces.action import Diagnose  # noqa: E402
from msd_interfaces.msg import Diagnosis  # noqa: E402

ACTION = "identifier/diagnose"
CANCELED, ABORTED, SUCCEEDED = (
    GoalStatus.STATUS_CANCELED,
    GoalStatus.STATUS_ABORTED,
    GoalStatus.STATUS_SUCCEEDED,
)


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def identifier(ros: Graph, folder: Path, **parameters: object) -> Identifier:
    given = {"auto_fit": False, "bag_folder": str(folder), "diagnostics_period": 0.05, **parameters}
    made: Identifier = ros.add(
        Identifier([Parameter(name, value=value) for name, value in given.items()], context=ros.context)
    )
    return made


def measured(**given: object) -> Record:
    """A simulated rig under steps in both directions: no poor experiment, whose diagnosis makes copies of it."""
    steps = {"name": "steps", "hold": 0.6}
    made = msd_sim.api.simulate({"rig": "ecp", "experiment": steps, "rate": 100.0, **given})
    return Record(made.time, made.position, made.force_time, made.force, start_ns=START_NS)


def fill(node: Identifier, record: Record) -> None:
    """The record's samples in the live buffer."""
    for at, value in zip(record.force_time.tolist(), record.force.tolist(), strict=True):
        node.buffer.add_force(record.start_ns + round(at * 1e9), value)
    node.buffer.add_positions(record.start_ns + np.rint(record.time * 1e9).astype(np.int64), record.position)


def long_record() -> Record:
    """Two hundred seconds of steps at 300 Hz that never settle: the first fit takes some seconds."""
    time_ = np.arange(60_000) / 300.0
    since = time_ % 3.0
    swing = 0.01 * (1.0 - np.exp(-since) * np.cos(20.0 * since - 3.0 * np.exp(-since)))
    force = np.arange(0.0, 200.0, 1.5)
    position = np.where((time_ // 1.5) % 2 == 0, swing, 0.012 - swing)
    return Record(time_, position, force, np.where(np.arange(force.size) % 2 == 0, 10.0, 0.0), start_ns=START_NS)


def by_name(parameters: Any) -> dict[str, dict[str, float]]:
    return {p.name: {"value": p.value, "std": none(p.std)} for p in parameters}


def none(value: float) -> Any:
    """NaN as JSON has it."""
    return value if math.isfinite(value) else None


def as_printed(found: Diagnosis) -> dict[str, Any]:
    """The message in the form of the JSON contract."""
    return {
        "verdict": found.verdict,
        "summary": found.summary,
        "causes": {
            c.name: (c.probability, by_name(c.parameters), list(c.tied_with), c.tied_probability) for c in found.causes
        },
        "base": (by_name(found.base), found.base_see),
        "extended": (by_name(found.extended), found.extended_see),
        "gain": [
            none(value)
            for value in (
                found.see_reduction_percent,
                found.heldout_see_base,
                found.heldout_see_extended,
                found.heldout_reduction_percent,
                found.heldout_reduction_lower,
                found.heldout_reduction_upper,
            )
        ],
        "left": [
            found.tolerance_percent,
            found.base_missing_force,
            found.missing_force,
            found.missing_force_lower,
            found.missing_force_upper,
            found.missing_force_percent,
            found.missing_force_of,
            found.force_unit,
            found.base_left_percent,
            found.left_percent,
            found.left_seen,
            found.noise_percent,
        ],
        "noise_floor": none(found.noise_floor),
        "warnings": list(found.warnings),
    }


def as_told(printed: dict[str, Any]) -> dict[str, Any]:
    """The same of an object that ``msd diagnose --json`` wrote."""

    def numbers(parameters: dict[str, Any]) -> dict[str, Any]:
        return {name: {"value": q["value"], "std": q["std"]} for name, q in parameters.items()}

    def model(part: dict[str, Any]) -> tuple[dict[str, Any], float]:
        return numbers(part["parameters"]), part["see_m"]

    def left(part: dict[str, Any]) -> list[Any]:
        base, extended = part["base"], part["extended"]
        force = [base["force_rms"], extended["force_rms"], *extended["force_interval"], extended["force_percent"]]
        motion = [base["motion_percent"], extended["motion_percent"], extended["seen"], part["noise_percent"]]
        return [*force, part["force_percent_of"], part["force_unit"], *motion]

    gain = printed["gain"]
    return {
        "verdict": printed["verdict"],
        "summary": printed["summary"],
        "causes": {
            c["name"]: (c["probability"], numbers(c["parameters"]), c["tied_with"], c["tied_probability"])
            for c in printed["causes"]
        },
        "base": model(printed["base"]),
        "extended": model(printed["extended"]),
        "gain": [
            gain["see_reduction_percent"],
            gain["heldout_see_base_m"],
            gain["heldout_see_extended_m"],
            gain["heldout_reduction_percent"],
            *gain["interval_percent"],
        ],
        "left": [printed["tolerance_percent"], *left(printed["remainder"])],
        "noise_floor": printed["noise_floor_m"],
        "warnings": printed["warnings"],
    }


def test_live_and_bag_and_command_line_agree_to_the_last_digit(
    ros: Graph, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    record = measured()
    io.write_bag(record, tmp_path / "bag")
    node = identifier(ros, tmp_path)
    fill(node, record)
    told: list[Diagnosis] = []
    ros.node.create_subscription(Diagnosis, "identifier/diagnosis", told.append, names.latest_qos())
    feedback: list[Diagnose.Feedback] = []
    handle, result = ros.goal(Diagnose, ACTION, Diagnose.Goal(), feedback.append)
    until(result.done, "the live diagnosis", 60.0)
    # The result may overtake it, and what the next goal is told would push it out of a queue of ten.
    until(lambda: feedback[-1].stage == "done", "the last feedback: the result may overtake it")
    (live,) = result.result().result.diagnoses
    asked = Diagnose.Goal(bag_paths=["bag"], report_path="page.html")
    handle, result = ros.goal(Diagnose, ACTION, asked)
    until(result.done, "the bag's diagnosis", 60.0)
    assert result.result().status == SUCCEEDED
    (of_bag,) = result.result().result.diagnoses

    monkeypatch.setattr("sys.argv", ["msd", "diagnose", str(tmp_path / "bag"), "--json", "-"])
    assert command.main() == 0
    printed = as_told(json.loads(capsys.readouterr().out))
    assert as_printed(live) == as_printed(of_bag) == printed
    assert printed["verdict"] == "explained" and list(printed["causes"]) == ["coulomb_friction"]
    assert (live.path, of_bag.path, live.samples) == ("live", "bag", record.samples)

    stages = [one.stage for one in feedback]
    assert stages[0] == "reading" and "search" in stages and stages[-1] == "done"
    fractions = [one.fraction for one in feedback]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert {one.stage for one in feedback if one.cause} == {"search"}
    until(lambda: len(told) == 2, "both on the topic")
    assert [one.path for one in told] == ["live", "bag"] and told[0].verdict == "explained"
    assert "Coulomb friction" in (tmp_path / "page.html").read_text()


def test_a_model_that_lacks_something_is_a_warning_with_the_sentence(
    ros: Graph, tmp_path: Path, asking_about: Callable[..., None]
) -> None:
    asking_about("coulomb_friction", "quadratic_drag")
    heard: list[DiagnosticStatus] = []
    ros.node.create_subscription(DiagnosticArray, "/diagnostics", lambda m: heard.extend(m.status), 10)
    node = identifier(ros, tmp_path)

    def model() -> DiagnosticStatus:
        found = [status for status in heard if status.name == "identifier: model"]
        return found[-1] if found else DiagnosticStatus(level=b"\x7f")

    def values() -> dict[str, str]:
        return {pair.key: pair.value for pair in model().values}

    until(lambda: model().message == "not diagnosed yet", "the first status")
    assert model().level == DiagnosticStatus.OK
    for given, end, level in (
        ({}, 0.0, DiagnosticStatus.OK),
        ({"effects": ["loose_cable"]}, 1.5, DiagnosticStatus.WARN),
    ):
        fill(node, measured(**given))
        _, result = ros.goal(Diagnose, ACTION, Diagnose.Goal(end=end))
        until(result.done, "the diagnosis", 60.0)
        found = result.result().result
        until(lambda said=found.message: model().message == said, "the sentence")
        assert model().level == level and values()["verdict"] == found.diagnoses[0].verdict
        assert (found.diagnoses[0].verdict == "explained") == (level == DiagnosticStatus.OK)
        node.buffer.clear()


def test_a_goal_is_cancelled_in_the_middle_of_a_fit(ros: Graph, tmp_path: Path) -> None:
    node = identifier(ros, tmp_path)
    fill(node, long_record())
    encoder = ros.node.create_publisher(JointState, "encoder", names.encoder_qos())
    until(encoder.get_subscription_count, "the subscription")
    for wait in (0.05, 0.5):
        before = node.buffer.counts.positions
        stages: list[str] = []
        handle, result = ros.goal(Diagnose, ACTION, Diagnose.Goal(), lambda f, to=stages: to.append(f.stage))
        until(lambda to=stages: "looking at the data" in to, "the fit to begin", 60.0)
        encoder.publish(JointState(name=["cart"], position=[0.01]))
        until(lambda was=before: node.buffer.counts.positions > was, "a sample while the fit lasts")
        time.sleep(wait)  # for instants that no stage marks
        assert not result.done() and set(stages) == {"reading", "looking at the data"}
        handle.cancel_goal_async()
        until(result.done, "the answer to the cancelled goal", 5.0)  # `bench.beside` measures it
        assert result.result().status == CANCELED
        assert not result.result().result.success and result.result().result.message == "cancelled"
        free: list[bool] = []
        node.worker.submit(lambda to=free: to.append(True))
        until(lambda to=free: to, "the worker to be free again", 5.0)


def test_paths_of_a_goal_stand_for_themselves_or_together(ros: Graph, tmp_path: Path) -> None:
    io.write_bag(measured(), tmp_path / "one")
    io.write_bag(measured(rate=80.0), tmp_path / "two")
    identifier(ros, tmp_path)
    asked = Diagnose.Goal(bag_paths=["one", "nowhere", "two"], end=3.0)
    _, result = ros.goal(Diagnose, ACTION, asked)
    until(result.done, "the diagnoses", 60.0)
    found = result.result().result
    assert result.result().status == ABORTED and not found.success
    assert [one.path for one in found.diagnoses] == ["one", "nowhere", "two"]
    assert [bool(one.verdict) for one in found.diagnoses] == [True, False, True]
    assert f"{tmp_path / 'nowhere'} does not exist" in found.diagnoses[1].summary
    assert found.diagnoses[1].summary in found.message
    _, result = ros.goal(Diagnose, ACTION, Diagnose.Goal(bag_paths=["one", "two"], together=True, end=3.0))
    until(result.done, "the diagnosis", 60.0)
    (both,) = result.result().result.diagnoses
    assert (both.path, both.causes[0].name, len(both.losses)) == ("one + two", "coulomb_friction", 4)


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (Diagnose.Goal(), "no position samples; expected at least one"),
        (Diagnose.Goal(bag_paths=["/etc"]), "/etc is not below"),
        (Diagnose.Goal(bag_paths=["../other"]), "../other is not below"),
        (Diagnose.Goal(bag_paths=["link"]), "link is not below"),
        (Diagnose.Goal(bag_paths=["bag"]), "storage.mcap leads out of"),
        (Diagnose.Goal(bag_paths=["x"] * 101), "101 paths; expected at most 100"),
        (Diagnose.Goal(bag_paths=["x" * 5000]), "a path of 5000 characters; expected at most 4096"),
        (Diagnose.Goal(report_path="page.txt"), "page.txt does not end in .html"),
        (Diagnose.Goal(report_path="old.html"), "old.html exists; expected a new name"),
        (Diagnose.Goal(report_path="no/page.html"), "no does not exist; expected one to write page.html into"),
        (Diagnose.Goal(report_path="/etc/page.html"), "expected a name that ends in .html there: give another name"),
        (Diagnose.Goal(report_path="/etc/page.html"), "/etc/page.html is not below"),
        (Diagnose.Goal(start=3.0, end=2.0), "the window from 3 s to 2 s is empty"),
    ],
    ids=lambda value: value.split()[0].strip("/.") if isinstance(value, str) else "",
)
def test_what_cannot_be_done_is_answered_in_words(ros: Graph, tmp_path: Path, asked: Diagnose.Goal, words: str) -> None:
    root = tmp_path / "root"
    (root / "bag").mkdir(parents=True)
    (root / "link").symlink_to("/etc")
    (root / "old.html").write_text("something")
    (root / "bag" / "storage.mcap").symlink_to("/etc/hostname")
    identifier(ros, root)
    _, result = ros.goal(Diagnose, ACTION, asked)
    until(result.done, "the answer")
    assert result.result().status == ABORTED
    answer = result.result().result
    assert not answer.success and words in answer.message and "\n" not in answer.message
    assert (root / "old.html").read_text() == "something"

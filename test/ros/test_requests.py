"""Every text field of every request, with all that a caller can put into it: a sentence comes back, the node lives."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import Graph, graph, until  # noqa: E402
from rcl_interfaces.srv import ListParameters  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from msd_ident.design import Profile, Segment  # noqa: E402
from msd_ident.design.profile_file import to_yaml  # noqa: E402
from msd_ident.ros.common.parameters import overrides  # noqa: E402
from msd_ident.ros.experimenter.node import Experimenter  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_ident.ros.recorder.node import Recorder  # noqa: E402
from msd_interfaces.action import Diagnose, RunExperiment  # noqa: E402
from msd_interfaces.srv import Identify, StartRecording  # noqa: E402

pytestmark = pytest.mark.timeout(300)

#: Names of parameters that a path, or an address, hangs on.
PATH_LIKE = re.compile("folder|path|^bag|file|host|token")
#: What a text may be, with the words of a path's refusal.
PATHS = {
    "long name": ("a" * 300, "is a name of 300 bytes; expected at most 255: shorten it"),
    "long in bytes": ("ü" * 200, "is a name of 400 bytes"),
    "long name deep": (f"a/{'b' * 256}/c", "is a name of 256 bytes"),
    "long path": ("a/" * 3000, "a path of 6000 characters; expected at most 4096"),
    "huge": ("x" * 1_000_000, "a path of 1000000 characters"),
    "newline": ("a\nb", "a\\nb has characters that cannot be printed"),
    "escape": ("\x1b[2Ja", "\\x1b[2Ja has characters that cannot be printed"),
    "direction": ("a\u202eb", "\\u202eb has characters that cannot be printed"),
    "root": ("/", "/ is not below"),
    "above": ("..", ".. is not below"),
    "far above": ("../" * 100 + "etc/passwd", "is not below"),
    "itself": (".", ". is not below"),
    "spaces": (" ", ""),
    "home of nobody": ("~nobodyatall/x", "cannot be followed"),
    "snowman": ("☃", ""),
}
TEXTS = [text for text, _ in PATHS.values()] + [
    "[" * 20_000,
    "{a: &a [*a]}",
    "a: b: c",
    "\t",
    "%",
    "'",
    "!!python/none",
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("bags")


@pytest.fixture(scope="module")
def ros(folder: Path) -> Iterator[Graph]:
    from msd_ident.ros.common.domain import private_domain

    given = overrides({"bag_folder": str(folder)})
    with private_domain() as domain, graph(domain) as made:
        for owner in (Identifier, Recorder, Experimenter):
            made.add(owner(given, context=made.context))
        yield made


def refused(answer: Any, words: str) -> None:
    """It was, in one line of sensible length, and nobody says "internal"."""
    assert not answer.success
    message = answer.message if hasattr(answer, "message") else answer.summary
    assert words in message and "\n" not in message and len(message) < 2000
    assert "internal" not in message and "Errno" not in message


@pytest.mark.parametrize("name", PATHS)
def test_identify_refuses_a_path(ros: Graph, name: str) -> None:
    text, words = PATHS[name]
    refused(ros.call(Identify, "identifier/identify", Identify.Request(bag_path=text)), words)


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_identify_refuses_a_model(ros: Graph, text: str) -> None:
    refused(ros.call(Identify, "identifier/identify", Identify.Request(bag_path="none", model=text)), "")


@pytest.mark.parametrize("name", [name for name, (_, words) in PATHS.items() if words])
def test_a_recording_refuses_a_folder(ros: Graph, name: str) -> None:
    text, words = PATHS[name]
    refused(ros.call(StartRecording, "recorder/start", StartRecording.Request(folder=text)), words)


@pytest.mark.parametrize("text", [*TEXTS, ""], ids=range(len(TEXTS) + 1))
def test_a_recording_refuses_topics_and_compressions(ros: Graph, text: str) -> None:
    refused(ros.call(StartRecording, "recorder/start", StartRecording.Request(topics=[text])), "")
    if text:
        refused(ros.call(StartRecording, "recorder/start", StartRecording.Request(compression=text)), "expected one of")


@pytest.mark.parametrize("name", PATHS)
def test_a_diagnosis_refuses_paths(ros: Graph, name: str) -> None:
    text, words = PATHS[name]
    for goal in (Diagnose.Goal(bag_paths=[text]), Diagnose.Goal(bag_paths=["none"], report_path=f"{text}.html")):
        _, future = ros.goal(Diagnose, "identifier/diagnose", goal)
        until(future.done, "the result")
        result = future.result().result
        assert not result.success and "internal" not in result.message and "Errno" not in result.message
        assert all("internal" not in one.summary and "Errno" not in one.summary for one in result.diagnoses)


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
@pytest.mark.parametrize("field", ["profile", "limits", "folder"])
def test_an_experiment_refuses_in_words_and_takes_the_next(ros: Graph, field: str, text: str) -> None:
    """One goal after the other: each is accepted, so none before it has left the node busy."""
    _, future = ros.goal(RunExperiment, "experimenter/run", RunExperiment.Goal(**{field: text}))
    until(future.done, "the result")
    refused(future.result().result, "")


def test_a_long_folder_leaves_the_experimenter_ready(ros: Graph) -> None:
    """The profile makes sense, so that it is the folder that is refused."""
    profile = to_yaml(Profile((Segment("step", 0.5, force=1.0),), "step"))
    goal = RunExperiment.Goal(profile=profile, limits="{force: 5, travel: 0.1, duration: 5}", folder="a" * 300)
    for _ in range(2):
        _, future = ros.goal(RunExperiment, "experimenter/run", goal)
        until(future.done, "the result")
        refused(future.result().result, "is a name of 300 bytes; expected at most 255: shorten it")


def test_recordings_within_a_second_have_names_of_their_own(ros: Graph, folder: Path) -> None:
    """Also of two rigs that share the folder."""
    other = ros.add(Recorder(overrides({"bag_folder": str(folder)}), context=ros.context, namespace="other"))
    paths = []
    for _ in range(5):
        for place in ("", "/other/"):
            answer = ros.call(StartRecording, f"{place}recorder/start", StartRecording.Request())
            assert answer.success, answer.message
            paths.append(answer.path)
        for place in ("", "/other/"):
            ros.call(Trigger, f"{place}recorder/stop", Trigger.Request())
    assert len(set(paths)) == len(paths) == 10
    assert other.summary.folder.name.startswith("msd_20")


@pytest.mark.parametrize("node", ["identifier", "recorder", "experimenter", "replayer", "live"])
def test_no_parameter_that_a_path_hangs_on_can_be_moved(node: str, tmp_path: Path, ros_domain: int) -> None:
    """Whoever may set parameters would open any folder to any caller."""
    from rcl_interfaces.msg import ParameterType
    from rcl_interfaces.srv import SetParameters

    with made_alone(node, tmp_path, ros_domain) as (ros, owner):
        every = ros.call(ListParameters, f"{node}/list_parameters", ListParameters.Request()).result.names
        names = [name for name in every if PATH_LIKE.search(name)]
        assert names
        for name in names:
            before = owner.node.get_parameter(name).value
            value = Parameter(name, value=["/tmp"] if isinstance(before, list) else "/tmp").to_parameter_msg()
            assert value.value.type != ParameterType.PARAMETER_NOT_SET
            (answer,) = ros.call(
                SetParameters, f"{node}/set_parameters", SetParameters.Request(parameters=[value])
            ).results
            assert not answer.successful and "read-only" in answer.reason
            assert owner.node.get_parameter(name).value == before


@contextmanager
def made_alone(node: str, folder: Path, domain: int) -> Iterator[tuple[Graph, Any]]:
    """One node of each kind, with a bag where it wants one."""
    from msd_ident.ros.live.node import LiveView
    from msd_ident.ros.replayer.node import Replayer

    kinds = {
        "identifier": Identifier,
        "recorder": Recorder,
        "experimenter": Experimenter,
        "replayer": Replayer,
        "live": LiveView,
    }
    repository = Path(__file__).resolve().parents[2]
    given: dict[str, object] = {"bag_folder": str(folder)} if node in ("identifier", "recorder", "experimenter") else {}
    given |= {"bag": str(repository / "bags" / "paper_step"), "wait": 3600.0} if node == "replayer" else {}
    given |= {"port": 0} if node == "live" else {}
    with graph(domain) as ros:
        yield ros, ros.add(kinds[node](overrides(given), context=ros.context))

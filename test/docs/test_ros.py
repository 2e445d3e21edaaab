"""The ROS page against the graph: names, types and qualities of service of nodes that run."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import pytest

pytestmark = pytest.mark.xdist_group("docs_graph")

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import Graph, graph, until  # noqa: E402
from rclpy.action import get_action_names_and_types  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402

from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.experimenter.node import Experimenter  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_ident.ros.recorder.node import Recorder  # noqa: E402
from msd_sim import names as rig_names  # noqa: E402
from msd_sim.node.rig_node import RigNode  # noqa: E402

_Found = TypeVar("_Found")

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "ros.md").read_text(encoding="utf-8")
#: What every node has, whoever wrote it.
_COMMON = re.compile(r"parameter|rosout|type_description|/_action/|logger")


def rows(heading: str) -> dict[str, list[str]]:
    """Name → cells of the table below a heading."""
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    cells = [[cell.strip(" `") for cell in line.split("|")[1:-1]] for line in section.splitlines() if line[:3] == "| `"]
    return {row[0]: row[1:] for row in cells}


@pytest.fixture(scope="module")
def ros() -> Iterator[Graph]:
    with graph(int(os.environ["ROS_DOMAIN_ID"])) as made:
        yield made


@pytest.fixture(scope="module")
def nodes(ros: Graph, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Graph]:
    folder = str(tmp_path_factory.mktemp("bags"))
    ros.add(Identifier([Parameter("bag_folder", value=folder)], context=ros.context))
    ros.add(Recorder([Parameter("bag_folder", value=folder)], context=ros.context))
    ros.add(Experimenter([Parameter("bag_folder", value=folder)], context=ros.context))
    rigs = []
    for mode, rate in (("real_time", 100.0), ("fast", 500.0)):  # the second one is fast enough for batches
        given = [Parameter("time_mode", value=mode), Parameter("rate", value=rate)]
        rigs.append(RigNode(context=ros.context, parameter_overrides=given))
    until(lambda: "/encoder_batch" in dict(ros.node.get_topic_names_and_types()), "the rigs")
    yield ros
    for rig in rigs:
        rig.destroy_node()


def settled(look: Callable[[], _Found], wanted: _Found) -> _Found:
    """What is found once it is what is wanted, or after five seconds of discovery."""
    for _ in range(100):
        if look() == wanted:
            break
        time.sleep(0.05)
    return look()


def test_topics_are_those_of_the_graph(nodes: Graph) -> None:
    def found() -> dict[str, list[str]]:
        return {name: kinds for name, kinds in nodes.node.get_topic_names_and_types() if not _COMMON.search(name)}

    page = {f"/{name.lstrip('/')}": [row[0]] for name, row in rows("Topics").items()}
    assert settled(found, page) == page


def test_what_publishers_offer_is_what_the_page_says(nodes: Graph) -> None:
    for name, (_, _, reliability, durability, _) in rows("Topics").items():
        ends = nodes.node.get_publishers_info_by_topic(f"/{name.lstrip('/')}")
        assert ends, f"nobody offers {name}"
        for end in ends:
            profile = end.qos_profile
            assert profile.reliability.name.lower() == reliability, name
            assert profile.durability.name.lower().replace("_", " ") == durability, name


def test_services_and_actions_are_those_of_the_graph(nodes: Graph) -> None:
    page = {f"/{name}": row[0] for name, row in rows("Services and actions").items()}

    def found() -> dict[str, str]:
        services = nodes.node.get_service_names_and_types()
        both = [*(entry for entry in services if not _COMMON.search(entry[0])), *get_action_names_and_types(nodes.node)]
        return {name: kinds[0] for name, kinds in both}

    assert settled(found, page) == page


def test_every_name_of_the_code_is_on_the_page() -> None:
    page = {name.lstrip("/") for name in (*rows("Topics"), *rows("Services and actions"))}
    constants = {value for name, value in vars(names).items() if name.isupper() and isinstance(value, str)}
    assert {name.lstrip("/") for name in constants} <= page
    assert {rig_names.FORCE, rig_names.ENCODER, rig_names.ENCODER_BATCH, rig_names.RESET} <= page

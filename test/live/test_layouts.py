"""The layouts for Foxglove and PlotJuggler name what our bags hold: every topic, every field."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from rosbags.highlevel import AnyReader

FOXGLOVE, PLOTJUGGLER = "config/foxglove_layout.json", "config/plotjuggler_layout.xml"
#: Topics that no bag here holds, with their types, and services.
OTHERS = {"/msd/identifier/diagnosis": "Diagnosis", "/diagnostics": "DiagnosticArray"}
SERVICES = {"/msd/identifier/trigger", "/msd/rig/reset"}


@pytest.fixture(scope="module")
def messages() -> dict[str, Any]:
    """The first message of each topic of a kept bag of ours."""
    place = Path(__file__).resolve().parents[2] / "bags" / "paper_step"
    first: dict[str, Any] = {}
    with AnyReader([place]) as reader:
        for connection, _, raw in reader.messages():
            if connection.topic not in first:
                first[connection.topic] = reader.deserialize(raw, connection.msgtype)
    return first


def value(message: Any, path: str) -> Any:
    """What a path such as ``wrench.force.x`` or ``position[0]`` leads to."""
    for name, index in re.findall(r"(\w+)(?:\[(\d*|:)\])?", path):
        message = getattr(message, name)
        if index.isdigit():
            message = message[int(index)]
    return message


def series(messages: dict[str, Any]) -> dict[str, float]:
    """Names that PlotJuggler gives to the numbers in these messages: those of joints by the joint."""
    found: dict[str, float] = {}

    def walk(prefix: str, item: Any) -> None:
        if type(item).__name__.endswith("JointState"):
            found.update({f"{prefix}/{joint}/position": float(item.position[i]) for i, joint in enumerate(item.name)})
        elif hasattr(item, "__dataclass_fields__"):
            for name in item.__dataclass_fields__:
                if name != "__msgtype__":
                    walk(f"{prefix}/{name}", getattr(item, name))
        elif isinstance(item, int | float):
            found[prefix] = float(item)

    for topic, message in messages.items():
        walk(topic, message)
    return found


def test_foxglove_plots_lead_to_numbers(repository: Path, messages: dict[str, Any]) -> None:
    panels = json.loads((repository / FOXGLOVE).read_text(encoding="utf-8"))["configById"]
    paths = [path["value"] for panel in panels.values() for path in panel.get("paths", ())]
    assert len(paths) >= 5
    for path in paths:
        topic, _, field = path.partition(".")
        assert isinstance(float(value(messages[topic], field)), float), path


def test_foxglove_panels_name_what_is_there(repository: Path, messages: dict[str, Any]) -> None:
    panels = json.loads((repository / FOXGLOVE).read_text(encoding="utf-8"))["configById"]
    for panel in panels.values():
        topic, _, field = panel.get("topicPath", panel.get("topicToRender", "")).partition(".")
        assert not topic or topic in messages or topic in OTHERS
        if topic in messages and field:
            assert len(value(messages[topic], field)) > 0, field
        assert panel.get("serviceName", "/msd/rig/reset") in SERVICES
        if "datatype" in panel:
            assert type(messages[panel["topicName"]]).__name__ == panel["datatype"].replace("/", "__")
            force = json.loads(panel["value"])["wrench"]["force"]["x"]
            assert force in (0.0, 10.0)


def test_foxglove_layout_shows_every_panel_once(repository: Path) -> None:
    layout = json.loads((repository / FOXGLOVE).read_text(encoding="utf-8"))
    shown: list[str] = []

    def walk(part: Any) -> None:
        if isinstance(part, str):
            shown.append(part)
        else:
            walk(part["first"])
            walk(part["second"])

    walk(layout["layout"])
    assert sorted(shown) == sorted(layout["configById"])


def test_plotjuggler_curves_are_series_of_our_bags(repository: Path, messages: dict[str, Any]) -> None:
    curves = [curve.attrib["name"] for curve in ElementTree.parse(repository / PLOTJUGGLER).iter("curve")]
    assert len(curves) >= 5
    assert set(curves) <= set(series(messages))

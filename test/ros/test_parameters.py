"""Parameters of the nodes stand in YAML files; those that the code has as constants are the same."""

from __future__ import annotations

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from msd_ident.io.writer import SPLIT_BYTES  # noqa: E402
from msd_ident.live.server import HERE  # noqa: E402
from msd_ident.ros.common.names import ENCODER, ENCODER_BATCH, FORCE, LEAST_DEPTH  # noqa: E402
from msd_ident.ros.common.parameters import declared  # noqa: E402
from msd_ident.ros.experimenter.profile_player import LEAD  # noqa: E402
from msd_ident.ros.recorder.node import COMPRESSIONS  # noqa: E402

NODES = ("experimenter", "identifier", "live", "recorder", "replayer")


def test_constants_of_the_code_are_those_of_the_files() -> None:
    settings = {(node, setting.name): setting for node in NODES for setting in declared(node)}
    assert settings["experimenter", "lead"].default == LEAD
    assert settings["live", "host"].default == HERE
    assert settings["recorder", "split_megabytes"].default * 2**20 == SPLIT_BYTES
    assert settings["recorder", "topics"].default == [FORCE, ENCODER, ENCODER_BATCH]
    assert settings["recorder", "compression"].choices == COMPRESSIONS
    depths = [setting for (_, name), setting in settings.items() if name == "queue_depth"]
    assert len(depths) == 3 and all(setting.lower == LEAST_DEPTH for setting in depths)


def test_every_default_is_within_its_range() -> None:
    for node in NODES:
        for setting in declared(node):
            assert setting.meaning, setting.name
            assert setting.lower is None or setting.lower <= setting.default <= setting.upper, setting.name
            assert not setting.choices or setting.default in setting.choices, setting.name

"""Every fault is done once to the real nodes, which say so, live on and give the truth again."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from bench.reliability.nodes.faults import FAULTS  # noqa: E402
from bench.reliability.nodes.soak import soak  # noqa: E402
from bench.reliability.nodes.world import world  # noqa: E402


@pytest.mark.timeout(300)
@pytest.mark.xdist_group("soak")
def test_every_fault_is_borne(ros_domain: int, tmp_path: Path) -> None:
    with world(ros_domain, tmp_path) as nodes:
        found = soak(nodes, 0.0, seed=1, tell=print)
    assert found.wrong == []
    assert set(found.done) == {fault.name for fault in FAULTS}

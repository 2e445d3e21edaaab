"""What nodes say: the log takes good and bad news from one place."""

from __future__ import annotations

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from msd_ident.ros.common import diagnostics_status  # noqa: E402


def test_good_and_bad_news_come_from_one_place(capfd: pytest.CaptureFixture[str]) -> None:
    logger = rclpy.logging.get_logger("teller")
    for good in (True, False, True):
        diagnostics_status.log(logger, good, f"it went {'well' if good else 'badly'}")
    said = capfd.readouterr().err
    assert said.count("[INFO]") == 2 and said.count("[WARN]") == 1 and "it went badly" in said

"""Missing samples are counted by the publisher's numbers and by the stamps, a window its own."""

from __future__ import annotations

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from bagmaker import START_NS, joints, number, stamps  # noqa: E402

from msd_ident.ros.common.conversions import is_stamped, raw_stamp  # noqa: E402
from msd_ident.ros.common.missing_samples import Holes, TopicCount  # noqa: E402


def test_holes_in_a_regular_train_of_stamps_are_counted() -> None:
    count, ns = TopicCount(), stamps(1001)
    for i, at in enumerate(ns):
        if i not in (100, 500, 501, 502, 900):
            count.count(None, at)
    assert (count.holes, count.lost, count.received) == (5, 0, 996)


def test_a_force_that_is_sent_when_it_changes_has_no_holes() -> None:
    count = TopicCount()
    for i in range(300):
        count.count(i, START_NS + i**3 * 10**6)
    assert count.holes == count.lost == 0


def test_a_pause_and_a_clock_that_is_set_are_no_holes() -> None:
    count = TopicCount()
    for shift in (0, 10**12, -(10**12)):
        for at in stamps(200):
            count.count(None, at + shift)
    assert count.holes == 0


def test_numbers_that_are_left_out_are_lost_and_one_that_falls_is_a_restart() -> None:
    count = TopicCount()
    told = [count.count(number) for number in (7, 8, 10, 11, 15, 3, 4)]
    assert told == [0, 0, 1, 0, 3, 0, 0]
    assert (count.lost, count.restarts, count.received) == (4, 1, 7)


def test_numbers_of_two_publishers_tell_nothing() -> None:
    count = TopicCount()
    for i in range(10):
        count.count(1000 + i, alone=False)
        count.count(i, alone=False)
    assert count.lost == 0 and count.restarts == 10


def test_a_window_has_the_holes_behind_its_start() -> None:
    holes = Holes()
    for at, samples in ((10, 3), (20, 0), (30, 4), (40, 5)):
        holes.add(at, samples)
    assert [holes.since(at) for at in (0, 10, 30, 40)] == [12, 9, 5, 0]


def test_the_stamp_of_a_message_that_nobody_decodes() -> None:
    assert raw_stamp(joints(START_NS, [1.0])) == START_NS
    assert raw_stamp(number(1.0)) is not None, "who asks must know the type"
    assert raw_stamp(b"\x00\x01") is None
    assert is_stamped("sensor_msgs/msg/JointState") and not is_stamped("std_msgs/msg/Float64")

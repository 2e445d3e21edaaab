"""Finds the namespace of topics that a user names without one."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import rclpy

from msd_ident.errors import DataError, UsageError

#: Time that discovery gets to find everybody, once it has found somebody [s]: it took up to 2.8 s here, and the
#: recording of another rig than the user's is worse than a wait.
SETTLING = 3.0
#: Topics that a refusal names.
_MOST_NAMED = 8


@contextmanager
def kept_discovery() -> Iterator[None]:
    """What discovery has found is forgotten with the last node of a process; keep it from one node to the next."""
    node = rclpy.create_node("keeper", start_parameter_services=False, enable_rosout=False)
    try:
        yield
    finally:
        node.destroy_node()


def namespace_of(topics: Sequence[str], ended: Callable[[], bool], seconds: float) -> str | None:
    """The namespace in which somebody publishes one of these topics; waits for one. ``None`` when ``ended`` came first.

    Args:
        topics: relative names.
        ended: whether nobody waits any more.
        seconds: longest wait; 0: without end.

    Raises:
        UsageError: there are several.
        DataError: there was none in that time.
    """
    node = rclpy.create_node("finder", start_parameter_services=False, enable_rosout=False)
    begin, first = time.monotonic(), 0.0
    try:
        while not ended():
            there = [name for name, _ in node.get_topic_names_and_types() if node.count_publishers(name)]
            found = sorted(
                {name[: -len(topic) - 1] for name in there for topic in topics if name.endswith(f"/{topic}")}
            )
            now = time.monotonic()
            first = first or (now if found else 0.0)
            if found and now - first > SETTLING:
                return _only(found, topics)
            if seconds and now - begin > seconds + (SETTLING if found else 0.0):
                raise DataError(_nothing(topics, there, seconds))
            time.sleep(0.02)
        return None
    finally:
        node.destroy_node()


def _only(found: Sequence[str], topics: Sequence[str]) -> str:
    if len(found) > 1:
        places = ", ".join(name or "/" for name in found)
        raise UsageError(
            f"{' or '.join(topics)} is published in {len(found)} namespaces ({places}); expected one: "
            f"say --namespace {found[0] or '/'}"
        )
    return found[0] or "/"


def _nothing(topics: Sequence[str], there: Sequence[str], seconds: float) -> str:
    others = [name for name in there if name not in ("/rosout", "/parameter_events")]
    named = ", ".join(others[:_MOST_NAMED]) + (", …" if len(others) > _MOST_NAMED else "")
    return (
        f"nobody publishes {' or '.join(topics)} in any namespace, waited {seconds:g} s; the topics are: "
        f"{named or 'none'}; expected a graph that runs, on this ROS_DOMAIN_ID: start it, or name topics"
    )

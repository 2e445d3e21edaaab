"""The faults: what is done to the nodes, and the words about it that must come up on ``/diagnostics``."""

from __future__ import annotations

import math
import random
import time
from array import array
from collections.abc import Callable
from dataclasses import dataclass

from sensor_msgs.msg import JointState
from std_msgs.msg import String

from bench.reliability.nodes import labs, requests
from bench.reliability.nodes.world import PERIOD_NS, RATE, World
from msd_ident.ros.common import names
from msd_ident.ros.common.conversions import time_message

Do = Callable[[World, random.Random], None]


@dataclass(frozen=True)
class Fault:
    """A fault.

    Attributes:
        name: for the table.
        do: does it, and raises ``Failed`` if the nodes do not handle it.
        words: part of the sentence that ``/diagnostics`` must say; empty when the answer to the caller says it.
        share: how often a soak does it, beside the others.
    """

    name: str
    do: Do
    words: str = ""
    share: float = 1.0


def publisher_restarted(world: World, rng: random.Random) -> None:
    """The encoder's publisher ends and begins anew a moment later."""
    world.tester.destroy_publisher(world.encoder)
    world.pass_time(0.5)
    world.encoder = world.publish_encoder()
    world.feed(20)


def time_back(world: World, rng: random.Random) -> None:
    """The clock jumps back by minutes or days."""
    world.offset_ns -= rng.randint(60, 10**6) * 10**9
    world.feed(100)


def time_back_a_little(world: World, rng: random.Random) -> None:
    """The clock jumps back by less than a second, so that it looks like samples that come late."""
    world.offset_ns -= rng.randint(30, 90) * 10**7 + 10**6
    world.feed(150)


def time_forward(world: World, rng: random.Random) -> None:
    """The clock jumps forward by minutes or days."""
    world.offset_ns += rng.randint(60, 10**6) * 10**9
    world.feed(100)


def time_stands(world: World, rng: random.Random) -> None:
    """Messages come, their stamp stays."""
    kept: list[JointState] = []

    def stand(message: JointState, index: int) -> list[JointState]:
        kept.append(message)
        message.header.stamp = kept[0].header.stamp
        return [message]

    world.feed(100, stand)


def wild_stamps(world: World, rng: random.Random) -> None:
    """Single stamps from the year 2100, or from 1970."""

    def wild(message: JointState, index: int) -> list[JointState]:
        if index % 40 == 20:
            message.header.stamp = time_message(rng.choice((4_102_444_800, 86_400)) * 10**9)
        return [message]

    world.feed(150, wild)


def out_of_order(world: World, rng: random.Random) -> None:
    """Neighbours change places."""
    held: list[JointState] = []

    def swap(message: JointState, index: int) -> list[JointState]:
        if held:
            return [message, held.pop()]
        if rng.random() < 0.3:
            held.append(message)
            return []
        return [message]

    world.feed(100, swap)


def twice(world: World, rng: random.Random) -> None:
    """Every message comes twice, now and then later than the next one."""
    last: list[JointState] = []

    def again(message: JointState, index: int) -> list[JointState]:
        late = [last.pop()] if last else []
        if rng.random() < 0.5:
            last.append(message)
            return [message, *late]
        return [message, message, *late]

    world.feed(100, again)


def not_finite(world: World, rng: random.Random) -> None:
    """NaN, infinity, and numbers that nothing mechanical has."""

    def spoil(message: JointState, index: int) -> list[JointState]:
        if rng.random() < 0.5:
            message.position = [rng.choice((math.nan, math.inf, -math.inf, 1e300))]
        return [message]

    world.feed(50, spoil)


def joint_missing(world: World, rng: random.Random) -> None:
    """Messages of other joints alone."""

    def other(message: JointState, index: int) -> list[JointState]:
        message.name = ["wrist"]
        return [message]

    world.feed(30, other)


def joint_renamed(world: World, rng: random.Random) -> None:
    """The joint has another name from now on, for a while."""

    def rename(message: JointState, index: int) -> list[JointState]:
        message.name = ["wagon"]
        return [message]

    world.feed(100, rename)


def empty_arrays(world: World, rng: random.Random) -> None:
    """Messages without a name or a position."""

    def empty(message: JointState, index: int) -> list[JointState]:
        message.name, message.position = [], []
        return [message]

    world.feed(30, empty)


def oversized_arrays(world: World, rng: random.Random) -> None:
    """A hundred thousand positions for one joint."""

    def inflate(message: JointState, index: int) -> list[JointState]:
        message.position = array("d", [message.position[0]] * 100_000)
        return [message]

    world.feed(5, inflate)


def hundred_megabytes(world: World, rng: random.Random) -> None:
    """One message of 100 MB."""

    def inflate(message: JointState, index: int) -> list[JointState]:
        message.position = array("d", message.position) + array("d", bytes(100_000_000))
        return [message]

    world.feed(1, inflate)


def wrong_units(world: World, rng: random.Random) -> None:
    """Millimetres where metres are meant."""

    def millimetres(message: JointState, index: int) -> list[JointState]:
        message.position = [1000.0 * message.position[0]]
        return [message]

    world.feed(310, millimetres)
    requests.identify(world)


def samples_dropped(world: World, rng: random.Random) -> None:
    """A fifth of the samples never comes."""
    world.feed(300, lambda message, index: [message] if rng.random() > 0.2 else [])
    requests.identify(world)


def encoder_silent(world: World, rng: random.Random) -> None:
    """The encoder says nothing any more."""
    world.wait_said("no position sample for")


def force_silent(world: World, rng: random.Random) -> None:
    """A force that came in a stream comes no more, while the encoder goes on."""
    requests.stream_force(world, 80)
    world.forget()
    world.feed(20)
    world.until(lambda: any("no message for" in said for said in _fed(world)), "the silence of the force")


def _fed(world: World) -> list[str]:
    """What was said, after a few more samples of an encoder that is slow."""
    time.sleep(0.2)
    world.feed(2)
    return world.said


def two_clocks(world: World, rng: random.Random) -> None:
    """The force is stamped by a clock that is hours ahead."""
    requests.push(world, rng.randint(3600, 10**6) * 10**9, 3.0)
    world.feed(20)


def two_publishers(world: World, rng: random.Random) -> None:
    """A second node publishes the encoder too."""
    other = world.publish_encoder()
    try:
        world.until(lambda: any("2 publishers; expected one" in said for said in _fed(world)), "the two publishers")
    finally:
        world.tester.destroy_publisher(other)


def another_type(world: World, rng: random.Random) -> None:
    """The encoder's topic is of a type that holds no number."""
    world.tester.destroy_publisher(world.encoder)
    with world.stranger() as node:
        node.create_publisher(String, names.ENCODER, 10)
        world.wait_said("expected to be told which field to use")
    world.encoder = world.publish_encoder()
    world.feed(10)


def burst(world: World, rng: random.Random) -> None:
    """A thousand messages at once: every one of them counts."""
    before, sent = world.identifier.buffer.counts, 1000
    world.feed(sent, together=sent)
    after = world.identifier.buffer.counts
    world.expect(after.positions - before.positions == sent, f"{after.positions - before.positions} of {sent} came")


FAULTS: tuple[Fault, ...] = (
    Fault("publisher restarted", publisher_restarted, "its publisher restarted; a new recording starts"),
    Fault("time jumps back", time_back, "the clock jumped back by"),
    Fault("time jumps back by less than a second", time_back_a_little, "the clock jumped back by 0."),
    Fault("time jumps forward", time_forward, "the clock jumped forward by"),
    Fault("time stands still", time_stands, "samples in a row stand still"),
    Fault("single stamps far from the others", wild_stamps, "s from the others, left out"),
    Fault("messages out of order", out_of_order, "samples come late"),
    Fault("messages twice", twice, "samples come twice"),
    Fault("NaN and infinity", not_finite, "is left out"),
    Fault("joint missing", joint_missing, "messages hold no position[0]; the joints are: wrist"),
    Fault("joint renamed", joint_renamed, "joint cart is gone and wagon is in its place"),
    Fault("empty arrays", empty_arrays, "messages hold no position[0]"),
    Fault("oversized arrays", oversized_arrays, "100000 entries"),
    Fault("a message of 100 MB", hundred_megabytes, "12500001 entries", share=0.2),
    Fault("positions in mm instead of m", wrong_units, "wrong by a factor of 1000?"),
    Fault("a fifth of the samples missing", samples_dropped, "are missing"),
    Fault("encoder silent", encoder_silent, "no position sample for", share=0.3),
    Fault("force topic silent", force_silent, "no message for", share=0.3),
    Fault("force of another clock", two_clocks, "two clocks?"),
    Fault("two publishers of the encoder", two_publishers, "2 publishers; expected one"),
    Fault("topic of another type", another_type, "expected to be told which field to use"),
    Fault("1000 messages at once", burst),
    Fault("parameters set to invalid values", requests.nonsense),
    Fault("service called 50 times at once", requests.fifty_at_once),
    Fault("missing paths, and paths outside the folder", requests.bad_paths),
    Fault("a folder without access rights", requests.folder_without_rights),
    Fault("a pipe in place of a file", requests.pipe),
    Fault("diagnosis cancelled", requests.cancelled),
    Fault("recorder started and stopped at random", requests.recordings),
    Fault("names too long", labs.long_names),
    Fault("invalid launch arguments", labs.launch_arguments),
    Fault("experimenter killed while it applies a force", labs.dead_experimenter, share=0.2),
    Fault("two recorders within a second", labs.two_recorders),
)
assert RATE * PERIOD_NS == 10**9

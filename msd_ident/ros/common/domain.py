"""A private ROS domain: no other process on this machine takes part in it. Imports no ROS."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager

from msd_ident.errors import SetupError

#: Domains whose ports lie below those that Linux gives to clients.
DOMAINS = range(1, 101)
#: A domain is taken while somebody holds this TCP port plus its number, as ROS's domain_coordinator has it.
FIRST_CLAIM = 32768
#: UDP port of the first participant of domain 0, and what a domain adds (DDSI-RTPS 9.6.1).
FIRST_PORT, PORTS_PER_DOMAIN = 7410, 250
#: Most participants of a domain that have ports of their own there.
PARTICIPANTS = 120

#: What keeps discovery on this machine; other settings of discovery are put aside.
PRIVATE = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
PUT_ASIDE = ("ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER", "FASTRTPS_DEFAULT_PROFILES_FILE")


@contextmanager
def private_domain(first: int | None = None) -> Iterator[int]:
    """A domain that nobody uses, claimed against others who ask for one until the end of the block.

    Args:
        first: place among the domains of the one that is tried first; as good as any when ``None``.

    Raises:
        SetupError: all are in use.
    """
    place = os.getpid() if first is None else first
    for offset in range(len(DOMAINS)):
        number = DOMAINS[(place + offset) % len(DOMAINS)]
        with socket.socket() as claim:
            if _binds(claim, FIRST_CLAIM + number) and _silent(number):
                yield number
                return
    raise SetupError(f"all ROS domains from {DOMAINS[0]} to {DOMAINS[-1]} are in use; expected a free one: stop a node")


def private_environment(number: int) -> dict[str, str]:
    """This process's environment, with the domain and with discovery kept on this machine."""
    kept = {name: value for name, value in os.environ.items() if name not in PUT_ASIDE}
    return {**kept, **PRIVATE, "ROS_DOMAIN_ID": str(number)}


@contextmanager
def in_domain(number: int) -> Iterator[dict[str, str]]:
    """This process's environment is that of the domain within the block."""
    kept = dict(os.environ)
    environment = private_environment(number)
    os.environ.clear()
    os.environ.update(environment)
    try:
        yield environment
    finally:
        os.environ.clear()
        os.environ.update(kept)


def _silent(number: int) -> bool:
    """Whether no participant listens in the domain.

    Their ports follow from their numbers. Of a graph that ends, any may be the last one, not only the first.
    """
    for participant in range(PARTICIPANTS):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            if not _binds(probe, FIRST_PORT + PORTS_PER_DOMAIN * number + 2 * participant):
                return False
    return True


def _binds(end: socket.socket, port: int) -> bool:
    try:
        end.bind(("", port))
    except OSError:
        return False
    return True

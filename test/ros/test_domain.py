"""A private domain: nobody listens in it, and nobody else asks for it."""

from __future__ import annotations

import socket

import pytest

from msd_ident.ros.common import domain
from msd_ident.ros.common.domain import FIRST_PORT, PORTS_PER_DOMAIN, private_domain


@pytest.mark.parametrize("participant", [0, 5, 40])
def test_a_domain_in_which_anybody_listens_is_passed_over(participant: int) -> None:
    """A node that ends late has any of the ports."""
    with private_domain() as claimed:  # so that no other test takes it meanwhile
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listens:
            listens.bind(("", FIRST_PORT + PORTS_PER_DOMAIN * claimed + 2 * participant))
            assert not domain._silent(claimed)
        assert domain._silent(claimed)


def test_a_domain_is_given_once() -> None:
    with private_domain() as one, private_domain(one - 1) as other:
        assert one != other

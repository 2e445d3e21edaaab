"""Advice for a joint: torques, levers and moments of inertia; for a cart it stays as it is."""

from __future__ import annotations

import re

import pytest

from msd_ident.model.effects import LIBRARY
from msd_ident.model.joint_words import said_of
from msd_ident.model.parameters import PARAMETERS

ADVICE = sorted({one.measured_by for one in LIBRARY} | {one.advice for one in PARAMETERS.values()})


@pytest.mark.parametrize("advice", ADVICE)
def test_no_advice_for_a_joint_weighs_a_cart_or_reads_newtons(advice: str) -> None:
    assert said_of(advice, "m") == said_of(advice, "count") == advice
    told = said_of(advice, "rad")
    assert not re.search(r"\b(the cart|newtons?|the force|weigh|moving mass)\b", told)
    assert "lever of known length" in told or not re.search("balance|load cell|gauge|known masses", told)


def test_the_words_of_a_joint() -> None:
    assert said_of("weigh the cart, and read the force at rest", "rad") == (
        "measure the moment of inertia, and read the torque at rest"
    )
    assert said_of("push with a known force, or weigh the moving mass.", "rad") == (
        "push with a known torque (a weight on a lever of known length), or measure the moment of inertia."
    )

"""Advice on measurements in the words of a joint: torque, lever and moment of inertia."""

from __future__ import annotations

import re

_LEVER = "on a lever of known length"
#: Words for a cart on a line, and those for a joint. At each place the longest that fits is taken.
_WORDS = {
    "measure the force of one input with a spring balance": "hold one input against a known torque "
    f"(a weight {_LEVER})",
    "push with a known force": f"push with a known torque (a weight {_LEVER})",
    "weigh the moving mass": "measure the moment of inertia",
    "Weigh the moving mass": "Measure the moment of inertia",
    "weigh the cart": "measure the moment of inertia",
    "weigh or swing it": "measure its moment of inertia",
    "moving mass of 1 kg": "moment of inertia of 1 kg·m²",
    "in newtons": "in N·m",
    "add a known mass to the cart": "add a known moment of inertia to the joint",
    "hang known masses on the spring": f"hang known weights {_LEVER}",
    "a load cell or a spring balance": f"a load cell or a spring balance {_LEVER}",
    "a spring balance": f"a spring balance {_LEVER}",
    "a force gauge": f"a force gauge {_LEVER}",
    "a load cell": f"a load cell {_LEVER}",
    "a balance": f"a balance {_LEVER}",
    "pull the cart": "turn the joint",
    "the cart": "the joint",
    "the force": "the torque",
}
_ANY = re.compile("|".join(rf"\b{word}\b" for word in sorted(_WORDS, key=len, reverse=True)))


def said_of(sentence: str, position_unit: str) -> str:
    """A sentence on what to measure, for a rig whose position has this unit: of a joint (``rad``) in its own words."""
    if position_unit != "rad":
        return sentence
    return _ANY.sub(lambda found: _WORDS[found.group()], sentence)

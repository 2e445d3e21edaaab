"""The library's laws as compiled dispatchers: one function a kind, whatever effects a model has.

The source of each dispatcher is written from the argument names of the effects' own laws, e.g.

    def force(active, p, w, t, x, v, direction, spring_force):
        total = 0.0
        if active & 8:
            total += cubic_spring_force(x, p[9])
        ...

so that a new effect is compiled in by being in the library.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.law import ABOVE, AT_ZERO, BOTH, OUTSIDE
from msd_ident.model.kernel.compiled import inlined, joined, making
from msd_ident.model.kernel.places import BIT, INDEX, MEMORY
from msd_ident.model.kernel.sine import with_own_sine

#: Laws that one test passes over where none of them acts.
_GROUP = 5


def _argument(name: str) -> str:
    if name in INDEX:
        return f"p[{INDEX[name]}]"
    if name in MEMORY:
        return f"w[{MEMORY[name]}]"
    return name


def _call(function: str, law: Callable[..., float]) -> str:
    return f"{function}({', '.join(_argument(name) for name in inspect.signature(law).parameters)})"


def _dispatcher(kind: str, given: str, start: str, join: str) -> Any:
    """Compile ``kind``: ``start`` is the value without effects, ``join`` how a law's value enters.

    Where ``start`` is one of the arguments, each law is given what the one before made of it.
    """
    scope: dict[str, Any] = {}
    lines = [f"def {kind}(active, p, w, {given}):"]
    value = start if start in given.split(", ") else "value"
    lines += [f"    value = {start}"] if value == "value" else []
    having = [effect for effect in LIBRARY if kind in effect.laws()]
    for group in (having[i : i + _GROUP] for i in range(0, len(having), _GROUP)):
        lines.append(f"    if active & {sum(BIT[effect.name] for effect in group)}:")
        for effect in group:
            law, function = effect.laws()[kind], f"{effect.name}_{kind}"
            scope[function] = joined(with_own_sine(law))
            lines += [f"        if active & {BIT[effect.name]}:", f"            {value} {join} {_call(function, law)}"]
    lines.append(f"    return {value}")
    return _compile(kind, lines, scope)


def _compile(name: str, lines: list[str], scope: dict[str, Any], how: Callable[[Any], Any] = inlined) -> Any:
    exec(compile("\n".join(lines), f"<{name} of the effect library>", "exec"), scope)
    return how(scope[name])


def _active() -> Any:
    """active(bits, p): the set without the effects whose parameters make them vanish."""
    lines = ["def active(bits, p):", "    kept = bits"]
    for effect in LIBRARY:
        zero = " and ".join(f"p[{INDEX[name]}] == {value}" for name, value in effect.neutral)
        lines += [f"    if {zero}:", f"        kept &= {~BIT[effect.name]}"]
    return _compile("active", [*lines, "    return kept"], {"inf": math.inf})


def _remember() -> Any:
    """remember(active, p, w, x, direction): the memory after a reversal at x; ``direction`` is the one that ends."""
    scope: dict[str, Any] = {}
    lines = ["def remember(active, p, w, x, direction):", "    pass"]
    for effect in LIBRARY:
        new: list[str] = []
        for name, _ in effect.memory:
            law = effect.laws()[f"reversal_{name}"]
            function = f"{effect.name}_{name}"
            scope[function] = joined(with_own_sine(law))
            new.append(_call(function, law))
        if new:
            places = ", ".join(f"w[{MEMORY[name]}]" for name, _ in effect.memory)
            lines += [f"    if active & {BIT[effect.name]}:", f"        {places} = {', '.join(new)}"]
    return _compile("remember", lines, scope)


def _knees() -> Any:
    """knees(active, p): (n, 3) position, stiffness and side of each knee of the spring, see ``spring``."""
    most = 2 * sum(bool(effect.knee) for effect in LIBRARY)
    lines = ["def knees(active, p):", f"    found = np.empty(({most}, 3))", "    n = 0"]
    for effect in LIBRARY:
        if not effect.knee:
            continue
        place, stiffness, side = effect.knee
        # A law with a kink at x = 0 has a knee there that bends nothing to speak of: the solver stops at it.
        kink = effect.knee == AT_ZERO
        place, stiffness = ("0.0", "1e-300") if kink else (f"p[{INDEX[place]}]", f"p[{INDEX[stiffness]}]")
        if effect.jumps:  # there is a piece beyond its knee without that stiffness too
            stiffness = f"{stiffness} if {stiffness} != 0.0 else 1e-300"
        lines += [f"    if active & {BIT[effect.name]}:"]
        for row in _rows(place, stiffness, side):
            lines += [f"        found[n, 0], found[n, 1], found[n, 2] = {row}", "        n += 1"]
    return _compile("knees", [*lines, "    return found[:n]"], {"np": np}, making)


def _rows(place: str, stiffness: str, side: str) -> tuple[str, ...]:
    """Position, stiffness and side of an effect's knees, as source."""
    if side in INDEX:
        reach = f"p[{INDEX[side]}]"
        return (f"{place} + {reach}, {stiffness}, 1.0", f"{place} - {reach}, {stiffness}, -1.0")
    rows = {
        ABOVE: (f"{place}, {stiffness}, 1.0",),
        BOTH: (f"{place}, {stiffness}, 1.0", f"-{place}, {stiffness}, -1.0"),
        OUTSIDE: (f"{place}, {stiffness}, 1.0 if {place} > 0.0 else -1.0",),
    }
    return rows[side]


active = _active()
constant = _dispatcher("constant", "", "0.0", "+=")
disturbance = _dispatcher("disturbance", "t", "0.0", "+=")
force = _dispatcher("force", "t, x, v, direction, speed, spring_force, driven, u, lagged_v, piece_x", "0.0", "+=")
knees = _knees()
friction = _dispatcher("friction", "t, x, speed, spring_force", "0.0", "=")
breakaway = _dispatcher("breakaway", "t, x, spring_force", "0.0", "=")
second_force = _dispatcher("second_force", "second_v", "0.0", "+=")
contact = _dispatcher("contact", "net, x, v, piece_x", "net", "=")
contact_at_rest = _dispatcher("contact_at_rest", "net, x", "net", "=")
grip = _dispatcher("grip", "net, x, v, piece_x", "1.0", "=")
input_map = _dispatcher("input_map", "t, u", "u", "=")
reading = _dispatcher("reading", "t, x, u", "x", "=")
remember = _remember()

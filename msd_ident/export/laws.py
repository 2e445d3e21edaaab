"""The laws of a model's effects as readable Python, from their own source: for generated files without msd_ident."""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from collections.abc import Callable, Iterable

from msd_ident.model.effects import ARGUMENTS, Effect

#: Effects that have no law of force: they change how the plant is built.
STRUCTURES = ("actuator_lag", "backlash", "end_stop", "second_mode", "time_offset")


def number(value: float) -> str:
    """A float as Python and XML both read it back, without a digit lost."""
    return repr(float(value)) if math.isfinite(value) else ("math.inf" if value > 0 else "-math.inf")


def source(effect: type[Effect], kind: str) -> str:
    """A law as a function of its own, ``force_of_quadratic_drag(v, speed, drag_coefficient)``."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(effect.laws()[kind])))
    function = tree.body[0]
    assert isinstance(function, ast.FunctionDef)
    function.decorator_list, function.name = [], f"{kind}_of_{effect.name}"
    for argument in function.args.args:
        argument.annotation = None
    function.returns = None
    return ast.unparse(function)


def call(effect: type[Effect], kind: str) -> str:
    """The same function as it is called where its arguments are known by their names."""
    return f"{kind}_of_{effect.name}({', '.join(arguments(effect.laws()[kind]))})"


def arguments(law: Callable[..., float]) -> tuple[str, ...]:
    """Names of a law's arguments."""
    return tuple(inspect.signature(law).parameters)


def needs_plant(effects: Iterable[Effect]) -> tuple[str, ...]:
    """Names that laws take and that are neither motion, nor parameters or memory of the effects themselves."""
    found = set()
    for effect in effects:
        own = {parameter.name for parameter in effect.parameters} | {name for name, _ in effect.memory}
        for law in effect.laws().values():
            found |= set(arguments(law)) - own - set(ARGUMENTS)
    return tuple(sorted(found))


def constants(effects: Iterable[Effect]) -> list[str]:
    """Lines that set every parameter, with its unit and meaning."""
    lines = {}
    for effect in effects:
        for parameter, value in zip(effect.parameters, effect.values, strict=True):
            lines[parameter.name] = f"{parameter.name} = {number(value)}  # [{parameter.unit}] {parameter.meaning}"
    return list(lines.values())


def functions(effects: Iterable[Effect], kinds: Callable[[str], bool] = lambda kind: True) -> str:
    """The source of all laws of these kinds, two lines between functions."""
    found = [source(type(effect), kind) for effect in effects for kind in effect.laws() if kinds(kind)]
    return "\n\n\n".join(found)


def summed(effects: Iterable[Effect], kinds: tuple[str, ...]) -> str:
    """The sum of all laws of these kinds as an expression, ``0.0`` where there is none."""
    found = [call(type(effect), kind) for effect in effects for kind in kinds if kind in effect.laws()]
    return " + ".join(found) or "0.0"


def one(effects: Iterable[Effect], kind: str, otherwise: str) -> str:
    """The one law of this kind as an expression, or ``otherwise``."""
    found = [call(type(effect), kind) for effect in effects if kind in effect.laws()]
    return found[0] if found else otherwise

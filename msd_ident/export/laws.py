"""The laws of a model's effects as Python source, for generated files that do not need msd_ident."""

from __future__ import annotations

import ast
import inspect
import math
import textwrap
from collections.abc import Callable, Iterable

from msd_ident.errors import DataError
from msd_ident.model import Model
from msd_ident.model.effects import ARGUMENTS, Effect
from msd_ident.model.effects.law import ABOVE, AT_ZERO, BOTH, LAG, OUTSIDE, SECOND_MASS, VELOCITY_LAG


def number(value: float) -> str:
    """A float as text that Python and XML read back without loss.

    Raises:
        DataError: it is infinite or NaN, for which XML has no word.
    """
    if not math.isfinite(value):
        raise DataError(
            f"a number of the model is {value:g}; expected a finite one for the file: renew the result with "
            "msd identify or msd diagnose"
        )
    return repr(float(value))


def source(effect: type[Effect], kind: str) -> str:
    """Source of a law as a Python function, such as ``force_of_quadratic_drag(v, speed, drag_coefficient)``.

    Args:
        effect: the effect.
        kind: of its law, such as ``force`` or ``friction`` (``Effect.laws``).
    """
    tree = ast.parse(textwrap.dedent(inspect.getsource(effect.laws()[kind])))
    function = tree.body[0]
    assert isinstance(function, ast.FunctionDef)
    function.decorator_list, function.name = [], f"{kind}_of_{effect.name}"
    for argument in function.args.args:
        argument.annotation = None
    function.returns = None
    return ast.unparse(function)


def call(effect: type[Effect], kind: str) -> str:
    """Expression that calls the function of ``source``, with the argument names of the law.

    Args:
        effect: the effect.
        kind: of its law.
    """
    return f"{kind}_of_{effect.name}({', '.join(arguments(effect.laws()[kind]))})"


def arguments(law: Callable[..., float]) -> tuple[str, ...]:
    """Names of a law's arguments."""
    return tuple(inspect.signature(law).parameters)


def needs_plant(effects: Iterable[Effect]) -> tuple[str, ...]:
    """Names of plant parameters that laws take: arguments beside motion, own parameters and memory."""
    found = set()
    for effect in effects:
        own = {parameter.name for parameter in effect.parameters} | {name for name, _ in effect.memory}
        for law in effect.laws().values():
            found |= set(arguments(law)) - own - set(ARGUMENTS)
    return tuple(sorted(found))


def knees(effects: Iterable[Effect]) -> list[str]:
    """Expressions of the forces [N] with which stops and bends add to the spring, see ``Effect.knee``."""
    found = []
    for effect in effects:
        if effect.knee is None or effect.knee == AT_ZERO:
            continue
        place, stiffness, side = effect.knee
        if side not in (BOTH, ABOVE, OUTSIDE):
            found.append(f"{stiffness} * (x - min(max(x, {place} - {side}), {place} + {side}))")
            continue
        outside = "max" if getattr(effect, place) > 0.0 else "min"
        found.append({
            BOTH: f"{stiffness} * (x - min(max(x, -{place}), {place}))",
            ABOVE: f"{stiffness} * max(x - {place}, 0.0)",
            OUTSIDE: f"{stiffness} * {outside}(x - {place}, 0.0)",
        }[side])  # fmt: skip
    return found


def jumps(effects: Iterable[Effect]) -> list[str]:
    """Expressions of the positions [m] at which a force begins with a jump, see ``Effect.jumps``."""
    found = []
    for effect in effects:
        if effect.jumps and effect.knee is not None:
            place, _, distance = effect.knee
            found += [f"{place} - {distance}", f"{place} + {distance}"]
    return found


def constants(effects: Iterable[Effect]) -> list[str]:
    """Lines of Python that set every parameter, with its unit and meaning; a limit that is none is infinite."""
    lines = {}
    for effect in effects:
        for parameter, value in zip(effect.parameters, effect.values, strict=True):
            text = "math.inf" if value == math.inf else number(value)
            lines[parameter.name] = f"{parameter.name} = {text}  # [{parameter.unit}] {parameter.meaning}"
    return list(lines.values())


def functions(effects: Iterable[Effect]) -> str:
    """Source of all laws of a model's effects but what only the solver asks."""
    found = [source(type(effect), kind) for effect in effects for kind in effect.laws() if kind != "grip"]
    return "\n\n\n".join(found)


def one(effects: Iterable[Effect], kind: str, otherwise: str) -> str:
    """Expression for the first law of a kind.

    Args:
        effects: of a model.
        kind: such as ``friction``.
        otherwise: expression to use if no effect has such a law.
    """
    found = [call(type(effect), kind) for effect in effects if kind in effect.laws()]
    return found[0] if found else otherwise


def chained(effects: Iterable[Effect], kind: str, given: str, of: str) -> str:
    """Expression that puts a value through all laws of a kind, one after the other.

    Args:
        effects: of a model.
        kind: ``input_map``, ``reading``, ``contact`` or ``contact_at_rest``.
        given: the argument of the laws that is the value: ``u``, ``x`` or ``net``.
        of: expression of the value.
    """
    for effect in effects:
        if kind in effect.laws():
            names = (of if name == given else name for name in arguments(effect.laws()[kind]))
            of = f"{kind}_of_{effect.name}({', '.join(names)})"
    return of


def fastest(model: Model) -> float:
    """Fastest rate of a model [1/s], for the step of an integration: swings, damping, stops, lag, second mass, laws.

    A law with a force over a length (a ripple, a hysteresis) has a stiffness of its own, one with a force over a speed
    a damping.
    """
    value = dict(zip(model.names, model.values.tolist(), strict=True))
    second, coupling, coupling_damping = model.structure(SECOND_MASS) or (0.0, 0.0, 0.0)
    stiffness = model.stiffness + coupling
    stiffness += sum(abs(value[one.knee[1]]) for one in model.effects if one.knee and one.knee != AT_ZERO)
    damping = model.damping + coupling_damping
    for effect in model.effects:
        force, length, speed = (_of_unit(effect, unit) for unit in ("N", "m", "m/s"))
        if force and length and effect.laws():
            stiffness += 2.0 * math.pi * max(force) / min(length)
        if force and speed and effect.laws():
            if "second_force" in effect.laws():
                coupling_damping += max(force) / min(speed)
            else:
                damping += max(force) / min(speed)
    rates = [math.sqrt(stiffness / model.mass), damping / model.mass]
    if second:
        rates += [math.sqrt(coupling / second), coupling_damping / second]
    lags = (*model.structure(LAG), *model.structure(VELOCITY_LAG)[-1:])
    rates += [1.0 / lag for lag in lags if lag]
    return float(max(rates))


def _of_unit(effect: Effect, unit: str) -> list[float]:
    """Sizes of an effect's finite parameters of a unit that are not 0."""
    sizes = (abs(v) for p, v in zip(effect.parameters, effect.values, strict=True) if p.unit == unit)
    return [size for size in sizes if 0.0 < size < math.inf]

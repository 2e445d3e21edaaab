"""The generated Python simulation: one readable file that needs numpy and scipy only."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.export import laws
from msd_ident.export.plan import Plan
from msd_ident.export.templates import filled
from msd_ident.model import Model
from msd_ident.model.effects import Effect
from msd_ident.model.effects.law import DELAY, LAG, PLAY, SECOND_MASS, STRUCTURAL, VELOCITY_LAG

#: Parts of the structure (``Effect.structure``) that the file has.
STRUCTURES = (PLAY, LAG, DELAY, SECOND_MASS, VELOCITY_LAG)


def text(plan: Plan, header: str, module: str) -> str:
    """Source of the generated simulation.

    Args:
        plan: what is exported.
        header: text of the docstring at the top.
        module: name by which the file is imported.
    """
    values = {**_values(plan, header, module), **structure(plan), **memory(plan), **edges(plan)}
    lags = [filled("simulation_lag.py.txt", lag=time_constant) for time_constant in _names(plan.model, LAG)]
    return "".join([filled("simulation.py.txt", **values), *lags])


def _values(plan: Plan, header: str, module: str) -> dict[str, str]:
    effects = plan.model.effects
    functions = laws.functions(effects)
    plant = [
        f"{parameter.name} = {laws.number(plan.value(parameter.name))}  # [{parameter.unit}] {parameter.meaning}"
        for parameter in plan.model.parameters[:3]
    ]
    kinds = ("constant", "disturbance", "force")
    calls = [laws.call(type(e), kind) for e in effects for kind in kinds if kind in e.laws()]
    return {
        "HEADER": header,
        "MODULE": module,
        "CONSTANTS": "\n".join([*plant, *laws.constants(effects)]),
        "ZERO": laws.number(plan.zero),
        "SIGN": str(plan.saved.force_sign),
        "HOLD": "linear" if plan.saved.force_hold in ("linear", "band_limited") else "zero",
        "RATE": laws.number(laws.fastest(plan.model)),
        "FUNCTIONS": f"\n{functions}\n\n" if functions else "",
        "COMMAND": laws.chained([e for e in effects if e.steady], "input_map", "u", "u"),
        "LINE": held(plan.model, "level + slope * (t - since)"),
        "HELD": held(plan.model, "level"),
        "FRICTION": laws.one(effects, "friction", "0.0"),
        "BREAKAWAY": laws.one(effects, "breakaway", "0.0"),
        "MOVED": laws.chained(effects, "contact", "net", "force").replace("piece_x", "ahead(x, mode)"),
        "RESTED": _at_rest(effects),
        "READING": laws.chained(effects, "reading", "x", "x"),
        "DRIVEN": _drive(effects, "f" if plan.model.structure(LAG) else "push"),
        "FORCES": "".join(f"    total -= {one}\n" for one in calls).replace("piece_x", "ahead(x, direction)"),
    }


def _drive(effects: Sequence[Effect], applied: str) -> str:
    """Lines that say what laws ask of the commanded force; ``applied`` is the one that arrives."""
    if not any(effect.asks_drive() for effect in effects):
        return ""
    return f"    u, driven = {applied}, 1.0 if push != 0.0 else 0.0\n"


def _at_rest(effects: Sequence[Effect]) -> str:
    """Expression of the net force, of which a contact holds its part where direction is 0."""
    rested = laws.chained(effects, "contact_at_rest", "net", "total")
    return "total" if rested == "total" else f"{rested} if direction == 0 else total"


def _names(model: Model, role: str) -> tuple[str, ...]:
    """Names of the parameters in the structure with this part in it; empty where the model has none."""
    found = (effect for effect in model.effects if effect.structure == role)
    return next((tuple(p.name for p in one.parameters)[: STRUCTURAL.get(role)] for one in found), ())


def structure(plan: Plan) -> dict[str, str]:
    """What lag, second mass, stops, play and delay put into the text."""
    model = plan.model
    play, lag, delay, second, slow = (_names(model, role) for role in STRUCTURES)
    spring = "".join(f"stiffness * (x - min(max(x, -{gap}), {gap}))" for gap in play)
    m2, k2, b2 = second or ("", "", "")
    coupling = f"{k2} * (x - x2) + {b2} * (v - v2)"
    on_second = [laws.call(type(one), "second_force") for one in model.effects if "second_force" in one.laws()]
    alone = "".join(f" - {call}" for call in on_second).replace("second_v", "v2")
    return {
        "BEHIND": " behind its play" if play else "",
        "SPRING": spring or "stiffness * x",
        "STATE": (", lagged force" if lag else "")
        + (", the second mass's" if second else "")
        + (", lagged velocity" if slow else ""),
        "UNPACK": (", f" if lag else "") + (", x2, v2" if second else "") + (", lagged_v" if slow else ""),
        "APPLIED": "f" if lag else "push",
        "HEARD": "y[2]" if lag else "push(t)",
        "STOP": "".join(f" - {force}" for force in laws.knees(model.effects)),
        "COUPLING": f" - {coupling}".replace(" + ", " - ") if second else "",
        "RATES": "".join(f", (push - f) / {tau}" for tau in lag)
        + (f", v2, ({coupling}{alone}) / {m2}" if second else "")
        + "".join(f", (v - lagged_v) / {tau}" for tau in slow[-1:]),
        "START": (", lagged(time[0], stamps, levels)" if lag else "") + begun(model),
        "DELAY": delay[0] if delay else "0.0",
    }


def held(model: Model, level: str) -> str:
    """Expression of the force [N] that a level [N] is at the time ``t``."""
    return laws.chained([effect for effect in model.effects if not effect.steady], "input_map", "u", level)


def begun(model: Model) -> str:
    """Start values of the states beside the cart's and the lagged force's, as the file has them."""
    second = ", position, velocity" if model.structure(SECOND_MASS) else ""
    return second + (", 0.0" if model.structure(VELOCITY_LAG) else "")


def edges(plan: Plan) -> dict[str, str]:
    """What jumps of a force put into the text."""
    found = laws.jumps(plan.model.effects)
    if not found:
        return dict.fromkeys(("BESIDE", "OR_JUMPS", "EVENTS", "AND_NOT_JUMPED", "ON_THE_EDGE"), "")
    return {
        "BESIDE": filled("simulation_jumps.py.txt", edges=", ".join(found)),
        "OR_JUMPS": ", or a force jumps",
        "EVENTS": ", *(crossing(edge, y[0], mode) for edge in EDGES)",
        "AND_NOT_JUMPED": " and beside(new[0], mode) == beside(y[0], mode)",
        "ON_THE_EDGE": "        if any(jumped):\n            y[0] = EDGES[jumped.index(True)]\n",
    }


def memory(plan: Plan) -> dict[str, str]:
    """What the laws remember, in the text."""
    pairs = [(effect, name, start) for effect in plan.model.effects for name, start in effect.memory]
    names = ", ".join(name for _, name, _ in pairs)
    if not pairs:
        return {"UNPACK_KEPT": "del x, direction", "REVERSAL": "kept", "KEPT": "()", "KEPT_NAMES": ""}
    new = ", ".join(laws.call(type(effect), f"reversal_{name}") for effect, name, _ in pairs)
    return {
        "UNPACK_KEPT": f"{names}, = kept",
        "KEPT_NAMES": f"    {names}, = kept\n",
        "REVERSAL": f"({new},)",
        "KEPT": f"({', '.join(laws.number(start) for _, _, start in pairs)},)",
    }

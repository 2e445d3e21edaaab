"""The generated Python simulation: one readable file that needs numpy and scipy only."""

from __future__ import annotations

from collections.abc import Iterable

from msd_ident.export import laws
from msd_ident.export.plan import Plan
from msd_ident.model import Effect, Model
from msd_ident.model.effects.base import DELAY, LAG, PLAY, SECOND_MASS

#: Parts of the structure (``Effect.structure``) that the file has.
STRUCTURES = (PLAY, LAG, DELAY, SECOND_MASS)

_FILE = '''"""@HEADER@

Use:

    import numpy as np
    import @MODULE@

    time = np.arange(6000) / 1000.0                        # instants at which readings are wanted [s]
    reading = @MODULE@.simulate(time, force_time=[0.0, 3.0], force=[10.0, 0.0])
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

@CONSTANTS@

ZERO = @ZERO@  # reading at which the spring is relaxed
FORCE_SIGN = @SIGN@  # of a force that moves the reading upwards
HOLD = "@HOLD@"  # how a force goes on until the next: "zero" (held) or "linear"
RATE = @RATE@  # fastest rate of the motion [1/s], for the step of the integration

@FUNCTIONS@
def spring(x):
    """Force [N] of the spring@BEHIND@."""
    return @SPRING@


def command(u):
    """Force [N] that a commanded u [N] becomes."""
    return @COMMAND@


def friction(x, speed, spring_force):
    """Dry friction [N] while sliding."""
    return @FRICTION@


def breakaway(x, spring_force):
    """Dry friction [N] at rest, at most."""
    return @BREAKAWAY@


def reading(t, x):
    """What the sensor makes of the position x from the relaxed spring."""
    return @READING@ + ZERO


def net(t, y, push, direction, kept):
    """Force [N] on the mass without dry friction; y = position, velocity@STATE@."""
    x, v@UNPACK@ = y
@KEPT_NAMES@    speed = abs(v)
    spring_force = spring(x)
@DRIVEN@    total = @APPLIED@ - damping * v - spring_force@STOP@@COUPLING@
@FORCES@    return total


def flow(t, y, push, mode, kept):
    """dy/dt; mode is the direction of the motion, or 0 where dry friction holds the mass."""
    x, v@UNPACK@ = y
    a = 0.0 if mode == 0 else (net(t, y, push, mode, kept) - mode * friction(x, abs(v), spring(x))) / mass
    return np.array([0.0 if mode == 0 else v, a@RATES@])


def reversal(x, direction, kept):
    """What the laws remember after the motion turned at x."""
    @UNPACK_KEPT@
    return @REVERSAL@


def begin(t, y, push, kept):
    """Mode of a mass at rest: the side to which it breaks away, or 0 where friction holds it."""
    force = net(t, y, push, 0.0, kept)
    return 0 if abs(force) <= breakaway(y[0], spring(y[0])) else int(math.copysign(1, force))


def step(t, y, h, push, mode, kept):
    """One step of the classical Runge-Kutta method."""
    a = flow(t, y, push(t), mode, kept)
    b = flow(t + h / 2, y + h / 2 * a, push(t + h / 2), mode, kept)
    c = flow(t + h / 2, y + h / 2 * b, push(t + h / 2), mode, kept)
    d = flow(t + h, y + h * c, push(t + h), mode, kept)
    return y + h / 6 * (a + 2 * b + 2 * c + d)


@BESIDE@def located(t, y, end, push, mode, kept):
    """Until the motion turns, or breaks away@OR_JUMPS@: instant and state there, and which of these it was."""

    def turns(t, y):
        if mode == 0:
            return breakaway(y[0], spring(y[0])) - abs(net(t, y, push(t), 0.0, kept))
        return mode * y[1]

    turns.terminal, turns.direction = True, -1
    found = solve_ivp(
        lambda t, y: flow(t, y, push(t), mode, kept), (t, end), y, events=[turns@EVENTS@], rtol=1e-9, atol=1e-12,
        max_step=end - t,
    )
    return found.t[-1], found.y[:, -1], [len(at) > 0 for at in found.t_events]


def advance(t, end, y, push, mode, kept):
    """State, mode and memory at the end of a stretch over which the command is a straight line."""
    steps = max(math.ceil((end - t) * RATE / 0.05), 1)
    h = (end - t) / steps
    while end - t > 1e-12 * (1.0 + abs(end)):
        h = min(h, end - t)
        new = step(t, y, h, push, mode, kept)
        if mode == 0:
            turned = abs(net(t + h, new, push(t + h), 0.0, kept)) > breakaway(new[0], spring(new[0]))
        else:
            turned = mode * new[1] < 0.0
        if not turned@AND_NOT_JUMPED@:
            t, y = t + h, new
            continue
        t, y, (turned, *jumped) = located(t, y, t + h, push, mode, kept)
@ON_THE_EDGE@        if turned and mode:
            # What is remembered is remembered from here, whichever way it goes on.
            y[1], kept = 0.0, reversal(y[0], mode, kept)
            mode = begin(t, y, push(t), kept)
        elif turned:
            mode = breaks(t, y, push(t), kept)
    return y, mode, kept


def breaks(t, y, push, kept):
    """Side to which the mass breaks away."""
    return int(math.copysign(1, net(t, y, push, 0.0, kept)))


def simulate(time, force_time, force, position=0.0, velocity=0.0, hold=HOLD):
    """Readings at the instants of time [s] under a force given from its stamps on.

    position (from the relaxed spring) and velocity are those at time[0]; there is no force before the first stamp.
    """
    time, stamps = np.asarray(time, dtype=float), np.asarray(force_time, dtype=float) + @DELAY@
    levels = np.array([command(FORCE_SIGN * value) for value in force], dtype=float)
    slopes = np.zeros(levels.size)
    if hold == "linear":
        slopes[:-1] = np.diff(levels) / np.diff(stamps)
    inside = stamps[(stamps > time[0]) & (stamps < time[-1])]
    edges = np.union1d(time, inside)
    at = np.searchsorted(stamps, edges, side="right") - 1
    kept = reversal(position, 0.0, @KEPT@)
    y = np.array([position, velocity@START@], dtype=float)
    out, place, mode = np.empty(time.size), 0, None
    for i, t in enumerate(edges):
        if t == time[place]:
            out[place] = reading(t, y[0])
            place += 1
        if place == time.size:
            break
        push = pushing(stamps, levels, slopes, at[i])
        if not mode or y[1] == 0.0:
            mode = int(math.copysign(1, y[1])) if y[1] else begin(t, y, push(t), kept)
        y, mode, kept = advance(t, edges[i + 1], y, push, mode, kept)
    return out


def pushing(stamps, levels, slopes, i):
    """The force [N] as a function of time after stamp i; 0 before the first."""
    if i < 0:
        return lambda t: 0.0
    level, slope, since = levels[i], slopes[i], stamps[i]
    if slope == 0.0:
        return lambda t: level
    return lambda t: level + slope * (t - since)
'''

_JUMPS = '''EDGES = (@EDGES@)  # positions at which a force begins with a jump
TOUCH = 1e-12 * max(abs(edge) for edge in EDGES)


def beside(x, mode):
    """On which side of each edge x lies; on an edge the direction of the motion decides."""
    return [x - edge > -mode * TOUCH for edge in EDGES]


def crossing(edge, x, mode):
    """What is zero on an edge that the motion from x goes towards, for ``solve_ivp``."""

    def crosses(t, y):
        return y[0] - edge if mode * (edge - x) > TOUCH else 1.0

    crosses.terminal = True
    return crosses


'''

_LAGGED = '''

def lagged(begin, stamps, levels):
    """The force behind the actuator's lag at an instant [s], from the stamps before it."""
    if stamps[0] >= begin:
        return 0.0
    force = levels[0]
    for i in np.flatnonzero(stamps < begin):
        end = min(begin, stamps[i + 1]) if i + 1 < stamps.size else begin
        force = levels[i] + (force - levels[i]) * math.exp(-(end - stamps[i]) / @LAG@)
    return force
'''


def text(plan: Plan, header: str, module: str) -> str:
    """Source of the generated simulation.

    Args:
        plan: what is exported.
        header: text of the docstring at the top.
        module: name by which the file is imported.
    """
    filled = _FILE
    for name, value in {**_values(plan, header, module), **structure(plan), **memory(plan), **edges(plan)}.items():
        filled = filled.replace(f"@{name}@", value)
    return filled + "".join(_LAGGED.replace("@LAG@", time_constant) for time_constant in _names(plan.model, LAG))


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
        "COMMAND": laws.one(effects, "input_map", "u"),
        "FRICTION": laws.one(effects, "friction", "0.0"),
        "BREAKAWAY": laws.one(effects, "breakaway", "0.0"),
        "READING": laws.one(effects, "reading", "x"),
        "DRIVEN": "    driven = 1.0 if push != 0.0 else 0.0\n" if _driven(effects) else "",
        "FORCES": "".join(f"    total -= {one}\n" for one in calls),
    }


def _driven(effects: Iterable[Effect]) -> bool:
    """Whether a law asks if any force is commanded."""
    return any("driven" in laws.arguments(law) for effect in effects for law in effect.laws().values())


def _names(model: Model, role: str) -> tuple[str, ...]:
    """Names of the parameters of the effect with this part in the structure; empty where the model has none."""
    return next((tuple(p.name for p in e.parameters) for e in model.effects if e.structure == role), ())


def structure(plan: Plan) -> dict[str, str]:
    """What lag, second mass, stops, play and delay put into the text."""
    model = plan.model
    play, lag, delay, second = (_names(model, role) for role in STRUCTURES)
    spring = "".join(f"stiffness * (x - min(max(x, -{gap}), {gap}))" for gap in play)
    m2, k2, b2 = second or ("", "", "")
    coupling = f"{k2} * (x - x2) + {b2} * (v - v2)"
    return {
        "BEHIND": " behind its play" if play else "",
        "SPRING": spring or "stiffness * x",
        "STATE": (", lagged force" if lag else "") + (", the second mass's" if second else ""),
        "UNPACK": (", f" if lag else "") + (", x2, v2" if second else ""),
        "APPLIED": "f" if lag else "push",
        "STOP": "".join(f" - {force}" for force in laws.knees(model.effects)),
        "COUPLING": f" - {coupling}".replace(" + ", " - ") if second else "",
        "RATES": "".join(f", (push - f) / {tau}" for tau in lag) + (f", v2, ({coupling}) / {m2}" if second else ""),
        "START": (", lagged(time[0], stamps, levels)" if lag else "") + (", position, velocity" if second else ""),
        "DELAY": delay[0] if delay else "0.0",
    }


def edges(plan: Plan) -> dict[str, str]:
    """What jumps of a force put into the text."""
    found = laws.jumps(plan.model.effects)
    if not found:
        return dict.fromkeys(("BESIDE", "OR_JUMPS", "EVENTS", "AND_NOT_JUMPED", "ON_THE_EDGE"), "")
    return {
        "BESIDE": _JUMPS.replace("@EDGES@", ", ".join(found)),
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

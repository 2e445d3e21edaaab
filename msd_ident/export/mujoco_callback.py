"""The callback file beside a MuJoCo model: laws that MuJoCo has no element for, as readable Python."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.export import header, laws, quoting
from msd_ident.export.mujoco_elements import SENSOR
from msd_ident.export.mujoco_friction import text as friction_text
from msd_ident.export.plan import Plan
from msd_ident.export.templates import filled
from msd_ident.model.effects import Effect
from msd_ident.model.effects.law import DELAY, LAG, PLAY

_TAKE = """    # The constraint of the XML is for use without this file.
    constraints.append((model, dof, float(model.dof_frictionloss[dof])))
    model.dof_frictionloss[dof] = 0.0
    dry.time = None
"""
_GIVE = """    while constraints:
        model, dof, loss = constraints.pop()
        model.dof_frictionloss[dof] = loss
"""


def text(plan: Plan, called: Sequence[Effect], module: str, model_file: str) -> str:
    """Source of the callback file.

    Args:
        plan: what is exported.
        called: effects whose laws the callbacks add.
        module: name by which the file is imported.
        model_file: name of the MuJoCo model beside it.
    """
    kinds = {kind for effect in called for kind in effect.laws()}
    remembered = [pair for effect in called for pair in effect.memory]
    body, setters = _installed(plan, called, kinds, bool(remembered))
    plant = [f"{n} = {laws.number(plan.value(n))}" for n in laws.needs_plant(called) if n in plan.values]
    spring = [_spring(plan)] if _uses(called, "spring_force") else []
    parts = [
        filled(
            "callback.py.txt",
            header=header.text(plan, f"Callbacks for {model_file}"), module=module,
            model=quoting.plain(model_file), joint=quoting.in_python(plan.joint),
            zero=laws.number(plan.zero), constants="\n".join([*plant, *laws.constants(called)]),
            functions="\n\n\n".join([laws.functions(called), *spring]),
        )
    ]  # fmt: skip
    if remembered:
        parts.append(filled("callback_memory.py.txt", **_memory(called)))
    dry = "friction" in kinds
    if dry:
        parts.append(friction_text(plan, called))
    parts.append(filled(
        "callback_install.py.txt",
        body=body, setters=", ".join([*(f"mujoco.{one}" for one in setters), ""]).strip(),
        take=_TAKE if dry else "", give=_GIVE if dry else "",
    ))  # fmt: skip
    return "".join(parts)


def _memory(called: Sequence[Effect]) -> dict[str, str]:
    pairs = [(effect, name, start) for effect in called for name, start in effect.memory]
    return {
        "start": ", ".join(f'"{name}": {start}' for _, name, start in pairs),
        "names": ", ".join(name for _, name, _ in pairs),
        "new": "\n".join(
            f'        "{name}": {laws.call(type(effect), f"reversal_{name}")},' for effect, name, _ in pairs
        ),
    }


def _installed(plan: Plan, called: Sequence[Effect], kinds: set[str], remembers: bool) -> tuple[str, list[str]]:
    """Body of ``install`` and the setters that it uses."""
    body, setters = "", []
    if kinds & {"constant", "disturbance", "force", "friction"}:
        body += _passive(called, kinds, remembers)
        setters.append("set_mjcb_passive")
    if "input_map" in kinds:
        mapped = laws.chained(called, "input_map", "u", "u")
        body += _command(plan, mapped)
        setters.append("set_mjcb_act_dyn" if plan.model.structure(LAG) else "set_mjcb_act_gain")
    if "reading" in kinds:
        body += _sensor(laws.chained(called, "reading", "x", "x"))
        setters.append("set_mjcb_sensor")
    return body + "\n" + "".join(f"    mujoco.{one}({one.removeprefix('set_mjcb_')})\n" for one in setters), setters


def _passive(called: Sequence[Effect], kinds: set[str], remembers: bool) -> str:
    lines = [
        "def passive(model, data):",
        "    t, x, v = data.time, data.qpos[place] - ZERO, data.qvel[dof]",
        "    speed = abs(v)",
    ]
    if _uses(called, "piece_x"):
        lines.append("    piece_x = x")
    if remembers:
        lines.append("    direction, kept = memory.at(t, x, v, data.qacc[dof], model.opt.timestep)")
        names = [name for effect in called for name, _ in effect.memory]
        lines.append(f"    {', '.join(names)} = {', '.join(f'kept[{name!r}]' for name in names)}")
    else:
        lines.append("    direction = sign(v)")
    if _uses([effect for effect in called if "friction" not in effect.laws()], "spring_force"):
        lines.append("    spring_force = spring(x)")
    for effect in called:
        own = [kind for kind in ("constant", "disturbance", "force") if kind in effect.laws()]
        lines += [f"    data.qfrc_passive[dof] -= {laws.call(type(effect), kind)}" for kind in own]
    if "friction" in kinds:
        lines.append("    data.qfrc_passive[dof] += dry.at(model, data, dof, x)")
    return "\n" + _indented(lines)


def _spring(plan: Plan) -> str:
    """The linear spring's force, behind its play where there is one."""
    stiffness, gap = laws.number(plan.model.stiffness), laws.number(sum(plan.model.structure(PLAY), 0.0))
    law = f"{stiffness} * (x - min(max(x, -{gap}), {gap}))"
    return f'def spring(x):\n    """Force [N] of the spring."""\n    return {law}'


def _uses(called: Sequence[Effect], name: str) -> bool:
    return any(name in laws.arguments(law) for effect in called for law in effect.laws().values())


def _command(plan: Plan, mapped: str) -> str:
    reading = ["    u = data.ctrl[number]"]
    if plan.model.structure(DELAY):
        reading = [
            "    line = model.actuator_history[number, 1]",
            "    u = mujoco.mj_readCtrl(model, data, number, data.time, numpy.zeros(1), line)[0]",
        ]
    if "t" in mapped.replace("(", " ").replace(",", " ").split():
        reading.insert(0, "    t = data.time")
    if lag := plan.model.structure(LAG):
        own = ["def act_dyn(model, data, number):", *reading,
               "    act = data.act[model.actuator_actadr[number]]",
               f"    return ({mapped} - act) / {laws.number(lag[0])}"]  # fmt: skip
    else:
        own = ["def act_gain(model, data, number):", *reading, f"    return {mapped} / u if u else 1.0"]
    return "\n" + _indented(own)


def _sensor(reading: str) -> str:
    lines = [
        f'place_of_reading = model.sensor("{SENSOR}").adr[0]',
        "",
        "def sensor(model, data, stage):",
        "    if stage == mujoco.mjtStage.mjSTAGE_POS:",
        "        t, x = data.time, data.qpos[place] - ZERO",
        f"        data.sensordata[place_of_reading] = {reading} + ZERO",
    ]
    return "\n" + _indented(lines)


def _indented(lines: Sequence[str]) -> str:
    return "".join(f"    {line}".rstrip() + "\n" for line in lines)

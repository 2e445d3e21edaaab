"""One page for each physical effect of the library, from what its class says of itself."""

from __future__ import annotations

import sys

import signature
from docs_tables import code, number, plain, table

from msd_ident.model.effects import LIBRARY, Effect
from msd_sim import effects as rig

PLACES = {"force": "force on the mass", "input": "between command and force", "sensor": "in the reading"}

_HEAD = """# Effects

Everything that the diagnosis can name, one page each. The pages are made from the effects' own classes: a new effect in
`msd_ident/model/effects/` has its page at the next build.

Laws are forces on the left-hand side of

```math
m\\,x'' + b\\,x' + k\\,x + \\text{effects} = F
```

unless they say otherwise. Any of them can be combined, except two of one family.

"""


_PICTURE = """A plant of 1 kg, 3 N·s/m and 400 N/m, pushed with 10 N and with −5 N and let go after each: thin
without the effect, thick with it. The missing force is F − m·x″ − b·x′ − k·x of the plant without it, which is what the
[report](../tutorial.md#diagnose) shows of your rig.
"""


def index() -> str:
    """The overview."""
    rows = [(f"[{e.name}]({e.name}.md)", code(e.law), PLACES[e.acts_on], module_summary(e)) for e in LIBRARY]
    return _HEAD + table(("name", "law", "acts", "what it is"), rows) + "\n" + _identities()


def _identities() -> str:
    return (
        "Some of these cannot be distinguished in any experiment, others only in a long one: "
        "[identities and ties](../identities.md).\n"
    )


def module_summary(effect: type[Effect]) -> str:
    """What the module says it is about, a sentence."""
    return plain(sys.modules[effect.__module__].__doc__)


def pages() -> dict[str, str]:
    """Path below docs → Markdown, the overview first."""
    return {"effects/index.md": index()} | {f"effects/{effect.name}.md": page(effect) for effect in LIBRARY}


def page(effect: type[Effect]) -> str:
    """The page of one effect."""
    parts = [
        f"# {effect.name}\n",
        module_summary(effect) + "\n",
        f"```text\n{effect.law}\n```\n",
        plain(effect.__doc__) + "\n",
        "## Parameters\n",
        _parameters(effect),
        "## What it looks like\n",
        _PICTURE,
        signature.drawn(effect),
        "## In the model\n",
        _facts(effect),
        "## Starting values\n",
        "The search starts from: " + _lower(plain(effect.guess.__doc__)) + "\n",
        _advice(effect),
        _on_the_rig(effect),
        f"## Source\n\n{effect.source}\n",
    ]
    return "\n".join(part for part in parts if part)


def _lower(text: str) -> str:
    return text[:1].lower() + text[1:]


def _parameters(effect: type[Effect]) -> str:
    rows = [
        (code(p.name), p.symbol, p.unit, f"{number(p.lower)} to {number(p.upper)}", p.meaning)
        for p in effect.parameters
    ]
    return table(("name", "symbol", "unit", "bounds", "meaning"), rows)


def _facts(effect: type[Effect]) -> str:
    gone = ", ".join(f"`{name}` = {number(value)}" for name, value in effect.neutral)
    relatives = [e.name for e in LIBRARY if e.family and e.family == effect.family and e is not effect]
    facts = [
        f"It acts **{'on the ' if effect.acts_on == 'force' else ''}{PLACES[effect.acts_on]}**."
        if effect.acts_on != "force"
        else "It is a **force on the mass**.",
        f"It is another law of the cause [`{effect.form_of}`]({effect.form_of}.md)." if effect.form_of else "",
        f"It may be mistaken for {', '.join(_links(list(effect.mistaken_for)))}: tried where one explains something."
        if effect.mistaken_for
        else "",
        f"It vanishes, exactly, with {gone}.",
        "It acts on the linear spring and has no effect without one." if effect.needs_spring else "",
        "It only dissipates energy." if effect.dissipative else "",
        ""
        if effect.mirror
        else "It depends on the direction: with force and position inverted, the motion is not just inverted.",
        "" if effect.steady else "Its law contains the time, counted from where the used part of the record begins.",
        "The solver simulates it by [exact propagation](../solver.md#exact-propagation) between located events."
        if effect.piecewise_linear
        else "The solver simulates it by the [general path](../solver.md#general-path).",
        f"Family *{effect.family}*: a model contains at most one effect of it (also {', '.join(_links(relatives))})."
        if effect.family
        else "",
    ]
    return "\n".join(f"- {fact}" for fact in facts if fact) + "\n"


def _links(names: list[str]) -> list[str]:
    return [f"[{name}]({name}.md)" for name in names]


def _advice(effect: type[Effect]) -> str:
    rows = [(code(p.name), p.advice) for p in effect.parameters if p.advice]
    if not rows:
        return ""
    return "## When the data leaves it open\n\n" + table(("parameter", "what to do"), rows)


def _on_the_rig(effect: type[Effect]) -> str:
    made = rig.ALL.get(effect.name)
    if made is None:
        return ""
    rows = [(code(p.name), p.unit, f"{p.default:g}", p.meaning) for p in made.parameters]
    text = f"## Try it\n\n    msd simulate --effect {effect.name} --experiment steps --out {effect.name}.csv\n"
    if not rows:
        return text
    example = f"`--effect {effect.name}:{made.parameters[0].name}=…`"
    return f"{text}\nThe rig's own parameters, set with {example}:\n\n" + table(
        ("parameter", "unit", "unless said", "meaning"), rows
    )

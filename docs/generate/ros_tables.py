"""Tables of the ROS page: messages from their files, parameters from what the nodes declare."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from docs_tables import cell, code, table

INTERFACES = Path(__file__).resolve().parents[2] / "msd_interfaces"
_FIELD = re.compile(r"^(?P<type>[\w/\[\]<=]+)\s+(?P<name>\w+)(?:\s*=\s*(?P<value>\S+))?\s*(?:#\s*(?P<meaning>.*))?$")
_PARTS = {"action": ("goal", "result", "feedback"), "srv": ("request", "response"), "msg": ("",)}


def message(name: str) -> str:
    """Tables of ``srv/Identify`` or the like: the text in front, then a row for each field."""
    kind, _, short = name.partition("/")
    text = (INTERFACES / kind / f"{short}.{kind}").read_text(encoding="utf-8")
    parts = re.split(r"^---$", text, flags=re.MULTILINE)
    shown = [_part(title, part) for title, part in zip(_PARTS[kind], parts, strict=True)]
    return "\n".join(shown)


def fields(text: str) -> Iterator[tuple[str, str, str, str]]:
    """(type, name, constant's value, meaning) of every field and constant; a comment alone goes on with the last."""
    held: list[str] | None = None
    for line in text.splitlines():
        found = _FIELD.match(line)
        if found:
            if held:
                yield tuple(held)  # type: ignore[misc]
            held = [found["type"], found["name"], found["value"] or "", found["meaning"] or ""]
        elif held and line.startswith(" ") and line.strip().startswith("#"):
            held[3] += " " + line.strip().lstrip("# ")
    if held:
        yield tuple(held)  # type: ignore[misc]


def _part(title: str, text: str) -> str:
    rows = [
        (code(name + (f" = {value}" if value else "")), code(kind), meaning)
        for kind, name, value, meaning in fields(text)
    ]
    head = f"*{title.capitalize()}*\n\n" if title else ""
    return head + table(("field", "type", "meaning"), rows)


def parameters(node: str) -> str:
    """Table of the parameters that a node declares."""
    rows = list(_rig() if node == "rig" else _settings(node))
    return table(("parameter", "default", "takes", "meaning"), rows)


def settings(node: str) -> Sequence[Any]:
    """What identifier, recorder or replayer declare.

    Raises:
        ModuleNotFoundError: no rclpy; the documentation is built where the nodes run.
    """
    import importlib

    return tuple(importlib.import_module(f"msd_ident.ros.{node}.node").SETTINGS)


def _settings(node: str) -> Iterator[tuple[str, str, str, str]]:
    for setting in settings(node):
        taken = ", ".join(map(str, setting.choices))
        if setting.lower is not None and setting.upper is not None:
            taken = f"{setting.lower:g} to {setting.upper:g}"
        later = "" if setting.fixed else " (may change while it runs)"
        yield code(setting.name), code(_value(setting.default)), taken, setting.meaning + later


def _rig() -> Iterator[tuple[str, str, str, str]]:
    from msd_sim import effects
    from msd_sim.node import parameters as rig

    for name, (value, low, high, meaning) in rig._WHOLE.items():
        yield code(name), code(_value(value)), f"{low:g} to {high:g}", meaning
    for name, (value, meaning) in rig._WORDS.items():
        yield code(name), code(_value(value)), "", cell(meaning)
    for name, parameter in rig._numbers():
        if name.split(".")[0] in effects.ALL:
            continue
        unit = f" [{parameter.unit}]" if parameter.unit else ""
        default = rig._DEFAULTS.get(name, parameter.default)
        yield code(name), code(f"{default:g}"), f"{parameter.lower:g} to {parameter.upper:g}", parameter.meaning + unit


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return '""' if value == "" else f"{value:g}" if isinstance(value, float) else str(value)

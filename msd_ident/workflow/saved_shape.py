"""The shape of a saved result: lists, objects and texts where a reader expects them, in words where they are not."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

#: Keys of a result that are lists, with what their entries are.
_LISTS = {
    "data": "object", "causes": "object", "effects": "text", "initial": "object", "rivals": "object",
    "known": "object", "warnings": "text",
}  # fmt: skip
#: Keys that are objects.
_OBJECTS = ("read_with", "missing_force_depends_on")
_KINDS: Mapping[str, tuple[type, ...]] = {"object": (Mapping,), "list": (list, tuple), "text": (str,)}
_MOST = 40


def check(result: Mapping[str, Any], model: str) -> None:
    """Refuse what is of another kind than a result has there. A key that is not there is left to the reader.

    Args:
        result: as parsed from JSON.
        model: key of the model that the result ends with.

    Raises:
        ValueError: which part, what it is, and what it is not.
    """
    for name in (*_OBJECTS, model, "base", "original"):
        if name in result and not (name in ("base", "original") and not result[name]):
            _must_be(name, result[name], "object")
            if "parameters" in result[name] and name not in _OBJECTS:
                _parameters(f"{name}.parameters", result[name]["parameters"])
    for name, kind in _LISTS.items():
        if name in result:
            _must_be(name, result[name], "list")
            for place, entry in enumerate(result[name]):
                _must_be(f"{name}[{place}]", entry, kind)
    if not result.get("data", [None]):
        raise ValueError("data is an empty list, without a record")
    for place, rival in enumerate(result.get("rivals", ())):
        if "causes" in rival:
            _must_be(f"rivals[{place}].causes", rival["causes"], "list")


def _parameters(name: str, told: Any) -> None:
    _must_be(name, told, "object")
    for key, value in told.items():
        _must_be(f"{name}.{key}", value, "object")


def _must_be(name: str, value: Any, kind: str) -> None:
    if not isinstance(value, _KINDS[kind]):
        raise ValueError(f"{name} is {_shown(value)}, which is no {kind}")


def _shown(value: Any) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= _MOST else f"{text[:_MOST]}…"

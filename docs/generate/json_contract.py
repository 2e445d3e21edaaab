"""The keys of a JSON object as paths, and those that a page documents."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

#: Objects whose keys are names of things and not of fields: path → what stands for the key.
NAMED = {
    "parameters": "NAME",
    "standard_form": "NAME",
    "standard_form_two_peaks": "NAME",
    "missing_force_depends_on": "SIGNAL",
    "missing_force_state": "SIGNAL",
    "spread": "NAME",
    "decided": "RIVAL",
}
_ROW = re.compile(r"^\| `([^`|]+)` \|", re.MULTILINE)


def paths(value: Any, path: str = "") -> Iterator[str]:
    """Path of every value: ``causes[].parameters.NAME.value``; an empty list or object ends there."""
    if isinstance(value, dict) and value:
        named = NAMED.get(path.rpartition(".")[2])
        for key, item in value.items():
            yield from paths(item, f"{path}.{named or key}".lstrip("."))
    elif isinstance(value, list) and value:
        for item in value:
            yield from paths(item, f"{path}[]")
    else:
        yield path


def documented(page: str, schema: str) -> set[str]:
    """Paths in the tables of the section of a schema."""
    _, found, rest = page.partition(f"\n## {schema}\n")
    if not found:
        raise ValueError(f"no section {schema}; expected one in the page")
    return set(_ROW.findall(rest.partition("\n## ")[0]))

"""The constants of the subpackages that identify and diagnose, as declared in the source."""

from __future__ import annotations

import ast

import docs_values
from docs_tables import table

from msd_ident.tuning import Declared, declared


def written(name: str) -> str:
    """Table of the ``tuned`` or of the ``fixed`` constants; for ``count`` a sentence with the number of the first."""
    found = declared()
    if name == "count":
        return f"There are {sum(one.is_tuned for one in found)} tuned constants."
    if name == "tuned":
        said = ("unit", "why", "chosen")
        rows = [(f"`{one.place}`", _value(one), *(one.about[what] for what in said)) for one in found if one.is_tuned]
        return table(("constant", "value", "unit", "what it decides", "how it was chosen"), rows)
    rows = [(f"`{one.place}`", _value(one), one.about["kind"], one.about["why"]) for one in found if not one.is_tuned]
    return table(("constant", "value", "kind", "what it is"), rows)


def _value(one: Declared) -> str:
    """As people write it; what is no number, as the source has it."""
    try:
        value = ast.literal_eval(one.text)
    except ValueError:
        return f"`{one.text}`"
    return f"`{one.text}`" if isinstance(value, dict) else docs_values.written(value)

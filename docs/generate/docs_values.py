"""Numbers of the code in the text: ``[[selection.ranking.DECISIVE]]`` becomes what that constant is."""

from __future__ import annotations

import importlib
import re
from typing import Any

PLACE = re.compile(r"\[\[([a-z_]+(?:\.[A-Za-z_0-9]+)+)\]\]")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def filled(text: str) -> str:
    """The text with every constant in its place.

    Raises:
        ModuleNotFoundError, AttributeError: there is no such constant any more.
    """
    return PLACE.sub(lambda found: written(constant(found[1])), text)


def constant(name: str) -> Any:
    """Value of ``room.module.NAME`` of msd_ident, or of ``msd_sim.module.NAME``."""
    whole = name if name.startswith("msd_sim.") else f"msd_ident.{name}"
    module, _, attribute = whole.rpartition(".")
    return getattr(importlib.import_module(module), attribute)


def written(value: Any) -> str:
    """As people write it: 10⁻⁵, 10 000, 3.5, ``a, b``."""
    if isinstance(value, tuple | list):
        return ", ".join(written(item) for item in value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if isinstance(value, int) or float(value).is_integer() and abs(value) < 1e6:
        return f"{int(value):,}".replace(",", " ") if abs(value) >= 10_000 else str(int(value))
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    if not exponent:
        return mantissa
    power = "10" + str(int(exponent)).translate(_RAISED)
    return power if mantissa == "1" else f"{mantissa}·{power}"

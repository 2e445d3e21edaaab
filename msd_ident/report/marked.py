"""Numbers with their path in the JSON: the page contains both, and a test compares them.

So a new number on the page of a diagnosis stands in ``Diagnosis.to_json_dict`` and in ``docs/json.md`` too.
"""

from __future__ import annotations

import html
import math
from dataclasses import dataclass

from msd_ident.quantity import Quantity
from msd_ident.report import numbers


@dataclass(frozen=True)
class Marked:
    """A number on a page.

    Attributes:
        key: path in the JSON object, e.g. ``gain.heldout_reduction_percent`` or ``causes.0.probability``.
        value: the number itself, as the JSON has it.
        text: how it is shown.
    """

    key: str
    value: float
    text: str

    def __html__(self) -> str:
        exact = repr(float(self.value)) if math.isfinite(self.value) else ""
        return f'<data value="{exact}" data-key="{html.escape(self.key)}">{html.escape(self.text)}</data>'

    def __str__(self) -> str:
        return self.text


def length(key: str, value: float, scale: numbers.DisplayUnit) -> Marked:
    """A length [m] in the unit given."""
    return Marked(key, value, f"{numbers.number(scale.factor * value, 3)} {scale.unit}")


def quantity(key: str, found: Quantity) -> Marked:
    """A parameter with half of its 95 % interval."""
    return Marked(f"{key}.value", found.value, numbers.with_band(found))

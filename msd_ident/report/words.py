"""Names and short sentences for the page and the terminal."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

from msd_ident.diagnosis import Diagnosis
from msd_ident.diagnosis import verdict as said
from msd_ident.diagnosis.verdict import percent
from msd_ident.model.effects import by_name
from msd_ident.model.effects import spoken as effect
from msd_ident.model.parameters import PARAMETERS
from msd_ident.report.tables import VERDICTS, WORDS

__all__ = ["VERDICTS", "effect", "percent"]

#: Most records whose names a title lists.
_LISTED = 4


def records(names: Sequence[str]) -> str:
    """Names of records; of many, the first and the last, and how many there are."""
    if len(names) <= _LISTED:
        return " + ".join(names)
    return f"{names[0]} … {names[-1]} ({len(names)} records)"


def folder(names: Sequence[str]) -> str:
    """Name of a folder for these records; names of many together are longer than a file system takes."""
    if len(names) <= _LISTED:
        return "+".join(names)
    return f"{names[0]}+{len(names) - 1}_more"


def effects(names: str) -> str:
    """``Coulomb friction + quadratic drag`` for names joined by ``+``, as sets of causes are written."""
    return " + ".join(effect(name.strip()) for name in names.split("+"))


def meaning(name: str) -> str:
    """What the effect is: the first sentence of its own file, without its full stop."""
    sentence = (sys.modules[by_name(name).__module__].__doc__ or effect(name)).splitlines()[0].rstrip(".")
    return sentence[0].lower() + sentence[1:]


def law(name: str) -> str:
    """The effect's law as a formula."""
    return by_name(name).law


def parameter(name: str) -> tuple[str, str]:
    """Words and symbol of a parameter."""
    if name in WORDS:
        return WORDS[name]
    known = PARAMETERS.get(name)
    return (known.meaning, known.symbol) if known else (effect(name), "")


def listed(words: list[str], last: str = "and") -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}" if words else ""


def headline(diagnosis: Diagnosis) -> str:
    """The verdict in one sentence that a technician understands."""
    names = [cause.name for cause in diagnosis.causes]
    if diagnosis.verdict == "adequate":
        if diagnosis.left.extended.seen:
            rest = f"less than the tolerance of {diagnosis.left.tolerance_percent:g} % of the motion"
            return f"The simulation is adequate: with a mass, a damper and a spring the error is {rest}."
        return "The simulation is adequate: a mass, a damper and a spring explain the readings to within the noise."
    if diagnosis.verdict == "unexplained":
        return "The simulation lacks something, and this data does not show a cause of the library that it could be."
    if diagnosis.verdict == "ambiguous":
        choices = [listed([effect(c.name), *map(effect, c.tied_with)], "or") for c in diagnosis.causes]
        open_ends = "which" if any(cause.tied_with for cause in diagnosis.causes) else "for certain"
        lacks = "lacks" if any(map(said.likely, diagnosis.causes)) else "may lack"
        return f"The simulation {lacks} {listed(choices)}: this data cannot tell {open_ends}."
    if diagnosis.verdict == "mostly_explained":
        rest = f"{percent(diagnosis.left.extended.motion_percent)} of the motion stays unexplained"
        return f"The simulation lacks {listed([effect(name) for name in names])}, and something more: {rest}."
    if len(names) == 1:
        return f"The simulation lacks {effect(names[0])}: {meaning(names[0])}."
    return f"The simulation lacks {listed([effect(name) for name in names])}."


def remainder(diagnosis: Diagnosis) -> tuple[str, str]:
    """What the extended model leaves: of the motion, and as a force with its interval and its part of another."""
    left = diagnosis.left
    found = left.extended
    motion = percent(found.motion_percent) if found.seen else "not distinguishable from noise"
    return motion, f"{said.force(found, left.force_unit)}{said.part_of_force(left)}"


def gain(diagnosis: Diagnosis) -> str:
    """What the extension is worth on data that no fit saw, in a few words."""
    held = diagnosis.heldout
    if not diagnosis.causes or not math.isfinite(held.reduction_percent):
        return ""
    return f"{held.reduction_percent:.1f} % ({held.interval_percent[0]:.1f} to {held.interval_percent[1]:.1f} %)"

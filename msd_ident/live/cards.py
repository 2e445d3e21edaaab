"""What is known, as the page's cards: pieces of HTML from ``cards.html.j2``, every word from outside escaped."""

from __future__ import annotations

import math
import time
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from msd_ident.live.board import Diagnosed, Estimated, Known
from msd_ident.report.numbers import length_scale, number, shown, with_band
from msd_ident.report.tables import VERDICTS, WORDS

__all__ = ["VERDICTS", "data", "estimate", "jobs", "length", "lines", "verdict", "words"]


def words(name: str) -> str:
    """``quadratic drag`` for ``quadratic_drag``; proper words for the usual parameters."""
    return WORDS[name][0] if name in WORDS else name.replace("_", " ")


def length(value: float, unit: str) -> str:
    """A length or angle with its unit, in a size that people read; a dash when it is not known."""
    if not math.isfinite(value):
        return "–"
    scale = length_scale(abs(value), unit)
    return f"{number(value * scale.factor, 3)} {scale.unit}"


def data(known: Known) -> str:
    """How the measurements are doing."""
    return str(_cards().data(known))


def jobs(known: Known, now: float | None = None) -> str:
    """What is in progress, with bars; the recording."""
    since = 0.0 if known.recording is None else known.recording
    seconds = int(max((time.time() if now is None else now) - since, 0.0))
    return str(_cards().jobs(known, f"{seconds // 60}:{seconds % 60:02d}"))


def estimate(found: Estimated | None) -> str:
    """Parameters with their intervals."""
    return str(_cards().estimate(found))


def verdict(found: Diagnosed | None) -> str:
    """Verdict, causes and gain."""
    return str(_cards().verdict(found, [] if found is None else _gain(found)))


def lines(known: Known) -> str:
    """What came of the latest requests."""
    return str(_cards().lines(known))


@cache
def _cards() -> Any:
    """The macros of the template."""
    made = Environment(loader=PackageLoader("msd_ident.live", "."), autoescape=True, undefined=StrictUndefined)
    made.filters |= {"words": words, "shown": shown, "with_band": with_band, "clock": _clock}
    made.globals |= {"length": length, "verdicts": VERDICTS}
    return made.get_template("cards.html.j2").module


def _clock(at: float) -> str:
    return time.strftime("%H:%M:%S", time.localtime(at))


def _gain(found: Diagnosed) -> list[tuple[str, str]]:
    """Rows of errors, and of what is left."""
    pairs = [("SEE of m, b, k alone", length(found.see_base, found.unit))]
    if found.causes:
        pairs.append(("SEE with the cause", length(found.see_extended, found.unit)))
    pairs.append(("noise floor", length(found.noise, found.unit)))
    if math.isfinite(found.left_percent):
        pairs.append(
            ("unexplained motion", f"{number(found.left_percent, 2)} % (tolerance {found.tolerance_percent:g} %)")
        )
        force, lower, upper = (number(value, 2) for value in found.force)
        pairs.append(("missing force", f"{force} {found.force_unit} rms ({lower} to {upper})"))
    if found.causes and math.isfinite(found.heldout_percent):
        low, high = found.heldout_interval
        pairs.append(("gain on left-out data", f"{found.heldout_percent:.0f} % ({low:.0f} to {high:.0f})"))
    return pairs

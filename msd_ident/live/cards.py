"""What is known, as the page's cards: pieces of HTML, every word from outside escaped."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from html import escape

from msd_ident.live.board import Cause, Diagnosed, Estimated, Job, Known, Line, Row
from msd_ident.report.numbers import length_scale, number, shown, with_band
from msd_ident.report.tables import WORDS

VERDICTS = {
    "adequate": "the model is enough",
    "explained": "cause named",
    "mostly_explained": "cause named, more is missing",
    "ambiguous": "several causes possible",
    "unexplained": "no known cause",
}


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
    good, sentence = known.data
    place = f"<b>{escape(known.place)}</b> · " if known.place else ""
    state = " good" if good else ""
    return f'<span class="status{state}"><span>{place}{escape(sentence)}</span></span>'


def jobs(known: Known, now: float | None = None) -> str:
    """What is in progress, with bars; the recording."""
    parts = [_job(name, job) for name, job in known.jobs]
    if known.recording is not None:
        seconds = max((time.time() if now is None else now) - known.recording, 0.0)
        clock = f"{int(seconds) // 60}:{int(seconds) % 60:02d}"
        parts.append(f'<p><span class="recording">{clock}</span> <span class="quiet">{escape(known.bag)}</span></p>')
    return "".join(parts)


def estimate(found: Estimated | None) -> str:
    """Parameters with their intervals."""
    if found is None:
        hint = "None yet. It appears when the response to a force step has settled, or after <b>Identify</b>."
        return f'<h2>Estimate</h2><p class="quiet">{hint}</p>'
    rows = "".join(_row(row) for row in found.rows)
    see = f'<tr class="sum"><td>SEE</td><td>{length(found.see, found.unit)}</td><td></td></tr>'
    noise = f"<tr><td>noise floor</td><td>{length(found.noise, found.unit)}</td><td></td></tr>"
    gain = f", {found.reduction_percent:.0f} % below the linear model" if found.reduction_percent > 0 else ""
    missing = f", {found.missing} missing" if found.missing else ""
    source = f"{found.samples} samples of {escape(found.source)}{missing}{gain}"
    return f'<h2>Estimate</h2><table>{rows}{see}{noise}</table><p class="quiet">{source}</p>{_remarks(found.remarks)}'


def verdict(found: Diagnosed | None) -> str:
    """Verdict, causes and gain."""
    if found is None:
        hint = "None yet. <b>Diagnose</b> finds what the model lacks."
        return f'<h2>Verdict</h2><p class="quiet">{hint}</p>'
    pill = f'<span class="pill {escape(found.verdict)}">{VERDICTS.get(found.verdict, escape(found.verdict))}</span>'
    causes = "".join(_cause(cause) for cause in found.causes)
    return (
        f"<h2>Verdict {pill}</h2><p>{escape(found.summary)}</p>{causes}<table>{_gain(found)}</table>"
        f"{_remarks(found.warnings)}"
    )


def lines(known: Known) -> str:
    """What came of the latest requests."""
    items = "".join(_line(line) for line in known.lines)
    return f"<h2>Messages</h2><ul>{items}</ul>" if items else '<h2>Messages</h2><p class="quiet">None yet.</p>'


def _line(line: Line) -> str:
    clock = time.strftime("%H:%M:%S", time.localtime(line.at))
    return f'<li class="{"good" if line.good else "bad"}"><time>{clock}</time>{escape(line.text)}</li>'


def _row(row: Row) -> str:
    quantity = shown(row.quantity)
    symbol = f"<i>{escape(row.symbol)}</i>" if row.symbol else ""
    unit = "" if quantity.unit in ("1", "") else escape(quantity.unit.replace(".", "·"))
    return f"<tr><td>{escape(words(row.name))}{symbol}</td><td>{with_band(quantity)}</td><td>{unit}</td></tr>"


def _cause(cause: Cause) -> str:
    tied = f" or {escape(' or '.join(map(words, cause.tied_with)))}" if cause.tied_with else ""
    percent = 100.0 * cause.probability
    said = "> 99.9 %" if percent > 99.9 else f"{percent:.1f} %"
    rows = "".join(_row(row) for row in cause.rows)
    return (
        f'<div class="cause"><span><b>{escape(words(cause.name))}</b>{tied}</span><span>{said}</span>'
        f'<div class="bar"><span style="width:{min(max(percent, 0.0), 100.0):.1f}%"></span></div></div>'
        f"<table>{rows}</table>"
    )


def _gain(found: Diagnosed) -> str:
    pairs = [("SEE of m, b, k alone", length(found.see_base, found.unit))]
    if found.causes:
        pairs.append(("SEE with the cause", length(found.see_extended, found.unit)))
    pairs.append(("noise floor", length(found.noise, found.unit)))
    if math.isfinite(found.left_percent):
        pairs.append(
            ("unexplained motion", f"{number(found.left_percent, 2)} % (tolerance {found.tolerance_percent:g} %)")
        )
        force, lower, upper = (number(value, 2) for value in found.force)
        pairs.append(("missing force", f"{force} {escape(found.force_unit)} rms ({lower} to {upper})"))
    if found.causes and math.isfinite(found.heldout_percent):
        low, high = found.heldout_interval
        pairs.append(("gain on left-out data", f"{found.heldout_percent:.0f} % ({low:.0f} to {high:.0f})"))
    rows = "".join(f"<tr><td>{name}</td><td>{text}</td><td></td></tr>" for name, text in pairs)
    return rows.replace("<tr>", '<tr class="sum">', 1)


def _remarks(sentences: Iterable[str]) -> str:
    items = [f'<li class="remark">{escape(sentence)}</li>' for sentence in sentences]
    if not items:
        return ""
    word = "remark" if len(items) == 1 else "remarks"
    return f"<details><summary>{len(items)} {word}</summary><ul>{''.join(items)}</ul></details>"


def _job(name: str, job: Job) -> str:
    known = math.isfinite(job.fraction)
    width = f' style="width:{100.0 * job.fraction:.0f}%"' if known else ""
    percent = f" · {100.0 * job.fraction:.0f} %" if known else ""
    running = "" if known else " running"
    return (
        f'<p class="quiet">{escape(words(name))}: {escape(job.stage)}{percent}</p>'
        f'<div class="bar{running}"><span{width}></span></div>'
    )

"""What an effect does to a motion, and the force that a plain model then lacks: drawn for its page, as SVG.

A plant is pushed both ways with and without the effect by the identifier's own solver. The strength is four times the
effect's own first guess, so that it is seen at a glance; an effect that guesses from what it has left in a record gets
values here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.model import Effect, Model, Plant, simulate

PLANT = Plant(mass=1.0, damping=3.0, stiffness=400.0)
_PUSHES = ((0.0, 0.0), (0.1, 10.0), (1.1, 0.0), (2.1, -5.0), (3.1, 0.0))
_END, _RATE, _POINTS = 4.1, 2000.0, 700
_STRONGER = 4.0
#: Values of effects whose guesses need a record that shows them, in the order of their parameters.
_GIVEN = {
    "actuator_lag": (0.015,),
    "cogging": (1.0, 0.01, 0.0),
    "periodic_disturbance": (1.0, 45.0, 0.0),
    "time_offset": (0.01,),
}
#: Samples either side of a push in which differences of the velocity mean nothing; least range of forces shown [N].
_BLIND, _LEAST = 3, 0.4
_WIDTH, _HEIGHT, _LEFT, _BOTTOM = 300.0, 190.0, 44.0, 30.0


@dataclass(frozen=True)
class Line:
    """A curve of a panel: (k,) values over (k,) values, and its class in the style sheet."""

    over: FloatArray
    values: FloatArray
    style: str


def pushed() -> Record:
    """The experiment: pushes both ways, each let go, and the plain plant's answer."""
    time = np.arange(0.0, _END, 1.0 / _RATE)
    stamps, forces = (np.array(column) for column in zip(*_PUSHES, strict=True))
    still = Record(time=time, position=np.sin(time), force_time=stamps, force=forces)
    moved = simulate(PLANT, still).position
    return Record(time=time, position=moved, force_time=stamps, force=forces)


_record = cache(pushed)


def example(effect: type[Effect]) -> Effect:
    """The effect's own first guess, its strength multiplied; or given values."""
    if effect.name in _GIVEN:
        return effect(*_GIVEN[effect.name])
    guess = effect.guess(_record(), PLANT)[0]
    neutral = dict(effect.neutral)
    values = dict(zip((p.name for p in effect.parameters), guess.values, strict=True))
    return effect.within_bounds(*(v * (_STRONGER if neutral.get(n) == 0.0 else 1.0) for n, v in values.items()))


def lacking(model: Model) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Reading (n,) [m], its velocity [m/s], and F − m x″ − b x′ − k x [N] of the plain plant on it, NaN at a push."""
    record = _record()
    x = simulate(model, record).position
    v = np.gradient(x, record.time)
    a = np.gradient(v, record.time)
    force = record.force_at(record.time) - PLANT.mass * a - PLANT.damping * v - PLANT.stiffness * x
    for at, _ in _PUSHES:
        push = int(at * _RATE)
        force[max(push - _BLIND, 0) : push + _BLIND + 1] = np.nan
    force[-_BLIND:] = np.nan
    low, high = np.nanquantile(force, (0.002, 0.998))  # without single samples in which the velocity jumps
    margin = 0.05 * max(high - low, 1e-3)
    return x, v, np.where((force < low - margin) | (force > high + margin), np.nan, force)


def drawn(effect: type[Effect]) -> str:
    """Four panels: the motion over time, and the missing force over time, position and velocity."""
    record, made = _record(), example(effect)
    x, v, force = lacking(PLANT + made)
    keep = np.linspace(0, x.size - 1, _POINTS).astype(int)
    time, x, v, force, plain = (column[keep] for column in (record.time, 100.0 * x, v, force, 100.0 * record.position))
    panels = (
        panel("position [cm] over time [s]", (Line(time, plain, "without"), Line(time, x, "with"))),
        panel("missing force [N] over time [s]", (Line(time, force, "with"),), _LEAST),
        panel("missing force [N] over position [cm]", (Line(x, force, "cloud"),), _LEAST),
        panel("missing force [N] over velocity [m/s]", (Line(v, force, "cloud"),), _LEAST),
    )
    values = ", ".join(f"`{p.name}` = {v:.3g} {p.unit}" for p, v in zip(made.parameters, made.values, strict=True))
    return f'<div class="signature">{"".join(panels)}</div>\n\nDrawn with {values}.\n'


def panel(title: str, lines: Sequence[Line], least: float = 0.0) -> str:
    """One set of axes, 0 in its middle height where less than ``least`` is to be shown."""
    low_x, high_x = _ends([line.over for line in lines])
    low_y, high_y = _ends([line.values for line in lines], least)

    def across(value: Any) -> Any:
        return _LEFT + (value - low_x) / (high_x - low_x) * (_WIDTH - _LEFT - 4.0)

    def up(value: Any) -> Any:
        return _HEIGHT - _BOTTOM - (value - low_y) / (high_y - low_y) * (_HEIGHT - _BOTTOM - 22.0)

    parts = [f'<svg viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" role="img" aria-label="{title}">']
    parts.append(f'<text class="title" x="{_LEFT:g}" y="12">{title}</text>')
    for at in _ticks(low_x, high_x):
        parts.append(f'<text x="{across(at):.1f}" y="{_HEIGHT - 14:g}" text-anchor="middle">{at:g}</text>')
    for at in _ticks(low_y, high_y):
        parts.append(f'<line class="grid" x1="{_LEFT:g}" x2="{_WIDTH - 4:g}" y1="{up(at):.1f}" y2="{up(at):.1f}"/>')
        parts.append(f'<text x="{_LEFT - 5:g}" y="{up(at) + 3.5:.1f}" text-anchor="end">{at:g}</text>')
    for line in lines:
        parts.append(f'<path class="{line.style}" d="{_path(across(line.over), up(line.values), line.style)}"/>')
    return "".join(parts) + "</svg>"


def _path(across: FloatArray, up: FloatArray, style: str) -> str:
    """Points for a cloud, else lines that break where there is nothing to show."""
    path, pen = "", "M"
    for a, b in zip(across, up, strict=True):
        if b != b:
            pen = "M"
            continue
        path += f"{pen}{a:.1f},{b:.1f}" + ("h0" if style == "cloud" else "")
        pen = "M" if style == "cloud" else "L"
    return path


def _ends(curves: Sequence[FloatArray], least: float = 0.0) -> tuple[float, float]:
    low, high = min(float(np.nanmin(c)) for c in curves), max(float(np.nanmax(c)) for c in curves)
    if high - low < least:
        reach = max(least, 1.5 * abs(low), 1.5 * abs(high))
        return -reach, reach
    return low, high


def _ticks(low: float, high: float) -> list[float]:
    """Three to six round numbers."""
    size = 10.0 ** np.floor(np.log10((high - low) / 3.0))
    step = next(size * n for n in (1.0, 2.0, 5.0, 10.0) if (high - low) / (size * n) <= 5.0)
    return [round(n * step, 12) for n in range(int(np.ceil(low / step)), int(np.floor(high / step)) + 1)]

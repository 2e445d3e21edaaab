"""Plots of the page: plotly figures as JSON. Colours are names of CSS variables, which the page's script resolves."""

from __future__ import annotations

import base64
import html
import json
from typing import Any

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.report.plot import Panel, Plot, Series

_GAP = 0.045


def to_json(plot: Plot) -> str:
    """The figure as JSON that may stand inside a script element."""
    text = json.dumps(figure(plot), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def figure(plot: Plot) -> dict[str, Any]:
    """The figure as plotly.js takes it, without a width: it has that of its place."""
    axes: dict[str, Any] = {}
    traces: list[dict[str, Any]] = []
    for number, (panel, domain) in enumerate(zip(plot.panels, _domains(plot.panels), strict=True), start=1):
        tail = "" if number == 1 else str(number)
        ticks = 7 if domain[1] - domain[0] > 0.25 else 3
        axes[f"yaxis{tail}"] = _axis(panel.ylabel, panel.log, ticks) | {"domain": domain, "anchor": "x"}
        traces += [trace for series in panel.series for trace in _traces(series, f"y{tail}")]
    last = "" if len(plot.panels) == 1 else str(len(plot.panels))
    axes["xaxis"] = _axis(plot.xlabel, plot.log) | {"anchor": f"y{last}", "domain": [0.0, 1.0]}
    named = any(series.legend for panel in plot.panels for series in panel.series)
    return {"data": traces, "layout": axes | _layout(plot.height, 34 if named else 10)}


def _layout(height: int, top: int) -> dict[str, Any]:
    return {
        "height": height,
        "margin": {"l": 62, "r": 12, "t": top, "b": 46},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": "var(--ink)"},
        "hovermode": "closest",
        "hoverlabel": {"bgcolor": "var(--card)", "bordercolor": "var(--line)", "font": {"color": "var(--ink)"}},
        "legend": {
            "orientation": "h",
            "itemsizing": "constant",
            "x": 0.0,
            "y": 1.0,
            "xanchor": "left",
            "yanchor": "bottom",
        },
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "var(--quiet)", "activecolor": "var(--ink)"},
        "dragmode": "zoom",
    }


def _domains(panels: tuple[Panel, ...]) -> list[list[float]]:
    """Vertical ranges (bottom, top) of the panels, the first on top."""
    free = 1.0 - _GAP * (len(panels) - 1)
    total = sum(panel.share for panel in panels)
    found, top = [], 1.0
    for panel in panels:
        bottom = top - free * panel.share / total
        found.append([max(bottom, 0.0), top])
        top = bottom - _GAP
    return found


def _axis(title: str, log: bool, ticks: int = 7) -> dict[str, Any]:
    return {
        "title": {"text": html.escape(title), "standoff": 8},
        "type": "log" if log else "linear",
        "gridcolor": "var(--grid)",
        "linecolor": "var(--line)",
        "zeroline": not log,
        "zerolinecolor": "var(--line)",
        "ticks": "outside",
        "tickcolor": "var(--line)",
        "ticklen": 4,
        "automargin": True,
        **({"dtick": 1, "exponentformat": "power"} if log else {"nticks": ticks}),
    }


def _traces(series: Series, axis: str) -> list[dict[str, Any]]:
    colour = f"var(--{series.role})"
    shared = {"type": "scatter", "yaxis": axis, "name": html.escape(series.name), "x": _small(series.x)}
    if series.kind == "band":
        assert series.low is not None
        edge = {"mode": "lines", "line": {"width": 0}, "hoverinfo": "skip", "legendgroup": f"{axis}{series.name}"}
        fill = {"fill": "tonexty", "fillcolor": f"var(--{series.role}-soft)", "showlegend": series.legend}
        lower = shared | edge | {"y": _small(series.low), "showlegend": False}
        return [lower, shared | edge | fill | {"y": _small(series.y)}]
    trace = shared | {"y": _small(series.y), "showlegend": series.legend}
    if series.kind == "points":
        trace |= {"mode": "markers", "marker": {"color": colour, "size": 5 if series.x.size < 200 else 3}}
        if series.x.size >= 200:
            trace["opacity"] = 0.55
        if series.error is not None:
            trace["error_y"] = {
                "type": "data",
                "array": _small(series.error),
                "color": colour,
                "thickness": 1,
                "width": 2,
            }
        return [trace]
    shape = {"shape": "hv"} if series.kind == "steps" else {}
    dash = {"dash": "dash"} if series.dashed else {}
    width = {"measured": 2.6, "law": 2.4}.get(series.role, 1.4)
    return [trace | {"mode": "lines", "line": {"color": colour, "width": width, **shape, **dash}}]


def _small(values: FloatArray) -> dict[str, str]:
    """Seven digits are enough for the eye: base64 of 32-bit numbers takes half the room of text."""
    return {"dtype": "f4", "bdata": base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode("ascii")}

"""The three plots over one time axis, and the data of a frame for them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from bokeh.models import Band, ColumnDataSource, Line, PanTool, Range1d, ResetTool, Span, WheelZoomTool
from bokeh.plotting import figure

from msd_ident.data.record import FloatArray
from msd_ident.live.scope import Curve, Frame
from msd_ident.report.numbers import DisplayUnit

#: Names of the plots from top to bottom, with their heights [px].
PLOTS = {"force": 140, "position": 330, "residual": 190}
#: The curves, and the plot of each.
CURVES = {"force": "force", "measured": "position", "model": "position", "residual": "residual"}
#: Colours by light and dark; those of the report.
COLOURS = {
    "light": {"force": "#6b7280", "measured": "#2f3b4a", "model": "#d1495b", "residual": "#7048b6"}
    | {"noise": "#788799", "text": "#5b6673", "grid": "#e8ebef", "axis": "#d5dae1"},
    "dark": {"force": "#93a0b0", "measured": "#d7dee8", "model": "#ff7a86", "residual": "#b79bf5"}
    | {"noise": "#96a5be", "text": "#9aa6b5", "grid": "#29313c", "axis": "#36404d"},
}
#: Half of the noise band in standard deviations: 95 % of the noise.
BAND = 2.0
#: Least height of a plot, in its unit; one without any motion shows -1 to 1.
LEAST = 1e-9
#: Part of the widest motion seen that a plot shows at least.
SMALLEST_PART = 0.05
#: Room left of the plots for their numbers [px]: the same for all, so that they stand under each other.
LEFT, RIGHT = 56, 14


@dataclass
class Steady:
    """A range that holds still: it grows at once, and shrinks when most of it is empty, but not to mere noise."""

    low: float = math.nan
    high: float = math.nan
    widest: float = 0.0

    def over(self, values: FloatArray, least: float) -> tuple[float, float]:
        """The range for these values, at least ``least`` wide."""
        known = values[np.isfinite(values)]
        low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
        self.widest = max(self.widest, high - low)
        middle, half = (low + high) / 2.0, max(high - low, least, SMALLEST_PART * self.widest) / 2.0
        wide = not (self.low <= middle - half and middle + half <= self.high)
        if wide or half < 0.25 * (self.high - self.low):
            self.low, self.high = middle - 1.2 * half, middle + 1.2 * half
        return self.low, self.high


@dataclass
class Plots:
    """The plots of one page.

    A frame goes to the browser as one message and is laid into sources and ranges there; these do not report back.
    """

    figures: dict[str, figure]
    sources: dict[str, ColumnDataSource]
    time: Range1d
    lines: dict[str, Line]
    band: Band
    _steady: dict[str, Steady] = field(default_factory=lambda: {name: Steady() for name in PLOTS})

    @property
    def columns(self) -> int:
        """Pixels from the first to the last instant that is shown."""
        width = self.figures["position"].inner_width
        return int(width) if isinstance(width, int | float) and width > 0 else 800

    @property
    def ranges(self) -> dict[str, Range1d]:
        """Those of the values, by plot."""
        return {name: plot.y_range for name, plot in self.figures.items()}

    def colour(self, dark: bool) -> None:
        """Follow the browser's preference."""
        colours = COLOURS["dark" if dark else "light"]
        for plot in self.figures.values():
            _dress(plot, colours)
        for curve, line in self.lines.items():
            line.line_color = colours[curve]
        self.band.fill_color = self.band.line_color = colours["noise"]

    def shown(self, frame: Frame, scales: Mapping[str, DisplayUnit]) -> dict[str, object]:
        """A frame in the units that are shown, for the browser."""
        curves = {"force": frame.force, "measured": frame.position, "model": frame.model, "residual": frame.residual}
        scaled = {name: _scaled(curve, scales[CURVES[name]]) for name, curve in curves.items()}
        noise = BAND * frame.noise * scales["residual"].factor
        inside = {
            plot: [y[t >= frame.start] for name, (t, y) in scaled.items() if CURVES[name] == plot] for plot in PLOTS
        }
        ranges = {plot: self._steady[plot].over(*_span(parts, plot, noise)) for plot, parts in inside.items()}
        return {
            "time": [frame.start, frame.end],
            "ranges": ranges,
            "sizes": {name: t.size for name, (t, _) in scaled.items()},
            "points": _packed(scaled, frame.start),
            "noise": noise,
        }


def _packed(curves: Mapping[str, Curve], start: float) -> npt.NDArray[np.float32]:
    """All curves, time since ``start`` and values of one after the other: one array, so one message to the browser.

    Seven digits are more than the eye sees.
    """
    parts = [part for t, y in curves.values() for part in (t - start, y)]
    return np.concatenate(parts).astype(np.float32)


def _span(parts: list[FloatArray], plot: str, noise: float) -> tuple[FloatArray, float]:
    """Values that a plot must hold, and its least width."""
    values = np.concatenate([*parts, np.zeros(1)])
    if plot == "residual" and math.isfinite(noise):
        values = np.append(values, (-1.3 * noise, 1.3 * noise))
    return values, LEAST if np.ptp(values[np.isfinite(values)]) > 0.0 else 2.0


def made() -> Plots:
    """Plots without data."""
    time = Range1d(-10.0, 0.0, syncable=False)
    sources = {name: ColumnDataSource({"t": [], "y": []}, syncable=False) for name in CURVES}
    sources["noise"] = ColumnDataSource({"t": [], "low": [], "high": []}, syncable=False)
    figures = {name: _figure(name, height, time) for name, height in PLOTS.items()}
    band = Band(base="t", lower="low", upper="high", source=sources["noise"], fill_alpha=0.22, line_alpha=0.5)
    figures["residual"].add_layout(band)
    lines = {
        curve: figures[plot].line("t", "y", source=sources[curve], line_width=1.6, line_join="round").glyph
        for curve, plot in CURVES.items()
    }
    figures["residual"].add_layout(Span(location=0.0, dimension="width", line_alpha=0.4, line_color="#808890"))
    plots = Plots(figures, sources, time, lines, band)
    plots.colour(dark=False)
    return plots


def _figure(name: str, height: int, time: Range1d) -> figure:
    pan, zoom, reset = PanTool(dimensions="width"), WheelZoomTool(dimensions="width"), ResetTool()
    plot = figure(
        name=name,
        height=height,
        sizing_mode="stretch_width",
        x_range=time,
        y_range=Range1d(-1.0, 1.0, syncable=False),
        tools=[pan, zoom, reset],
        toolbar_location=None,
        active_drag=None,
        active_scroll=None,
        output_backend="canvas",
        min_border_left=LEFT,
        min_border_right=RIGHT,
        min_border_top=6,
        min_border_bottom=6,
        lod_threshold=None,
    )
    plot.background_fill_alpha = plot.border_fill_alpha = 0.0
    plot.outline_line_color = None
    plot.yaxis.ticker.desired_num_ticks = max(3, height // 50)
    plot.xaxis.visible = name == "residual"
    plot.xaxis.axis_label = "time [s]" if name == "residual" else None
    return plot


def _dress(plot: figure, colours: Mapping[str, str]) -> None:
    for axis in plot.axis:
        axis.axis_line_color = axis.major_tick_line_color = colours["axis"]
        axis.minor_tick_line_color = None
        axis.major_label_text_color = axis.axis_label_text_color = colours["text"]
        axis.major_label_text_font = axis.axis_label_text_font = "system-ui, sans-serif"
        axis.axis_label_text_font_style = "normal"
        axis.major_label_text_font_size = axis.axis_label_text_font_size = "12px"
    plot.grid.grid_line_color = colours["grid"]


def _scaled(curve: Curve, scale: DisplayUnit) -> Curve:
    time, values = curve
    return time, values * scale.factor

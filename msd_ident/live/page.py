"""One page: a Bokeh document for one browser tab, over the scope and the board that all tabs share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import jinja2
from bokeh.core.properties import Any as AnyProperty
from bokeh.core.properties import Bool, Float, Int
from bokeh.core.templates import get_env
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.model import DataModel
from bokeh.models import Button, CustomJS, Div, InlineStyleSheet, RadioButtonGroup, Spinner, Toggle

from msd_ident.live import cards, figures
from msd_ident.live.board import Board, Controls, Known
from msd_ident.live.scope import Frame, Scope
from msd_ident.report.numbers import DisplayUnit, length_scale

#: Lengths of the window to choose from [s], and the one chosen first.
WINDOWS = (5, 10, 30, 60)
FIRST_WINDOW = 1
#: Looks at the texts beside the curves a second: a number that changes 30 times a second cannot be read.
CALM_RATE = 5.0
#: Pixels of a paused page's window: finer, for zooming into it.
FINE = 4000


class Pulse(DataModel):
    """What page and server say to each other: the page asks for frame after frame, and gets them."""

    asked = Int(default=0)
    rate = Float(default=25.0)
    dark = Bool(default=False)
    paused = Bool(default=False)
    frame = AnyProperty(default=None)


@dataclass(frozen=True)
class Shown:
    """What all pages show, and what their buttons do.

    Attributes:
        scope, board, controls: shared by all pages.
        rate: most frames a second.
    """

    scope: Scope
    board: Board
    controls: Controls
    rate: float


class Page:
    """Fills a document and answers it."""

    def __init__(self, document: Document, shown: Shown) -> None:
        self._of = shown
        self._known: Known | None = None
        self._frames = 0
        self._texts: dict[str, str] = {}
        self._plots = figures.made()
        self._pulse = Pulse(name="pulse", rate=shown.rate)
        self._cards = {name: _div(name) for name in ("data", "jobs", "estimate", "verdict", "lines")}
        self._make_buttons()
        self._lay_out(document)

    # -- what it is made of

    def _make_buttons(self) -> None:
        known, do = self._of.board.known, self._of.controls
        self._amount = Spinner(
            name="amount",
            title=f"Force of the step [{known.force_unit}]",
            value=known.step_force,
            low=-known.step_limit,
            high=known.step_limit,
            step=known.step_limit / 20.0,
            stylesheets=[_style("widget.css")],
        )
        self._step = _button("step", "Step", "primary")
        self._record = _button("record", "Record")
        self._identify = _button("identify", "Identify")
        self._diagnose = _button("diagnose", "Diagnose")
        self._reset = _button("reset", "Reset")
        self._window = RadioButtonGroup(
            name="window",
            labels=[f"{seconds} s" for seconds in WINDOWS],
            active=FIRST_WINDOW,
            css_classes=["small"],
            stylesheets=[_style("widget.css")],
        )
        self._pause = Toggle(name="pause", label="Pause", css_classes=["small"], stylesheets=[_style("widget.css")])
        self._pause.js_link("active", self._pulse, "paused")
        self._step.on_click(lambda: do.step(0.0 if self._pushing else float(self._amount.value or 0.0)))
        self._record.on_click(lambda: do.record(self._of.board.known.recording is None))
        self._identify.on_click(lambda: do.identify())
        self._diagnose.on_click(lambda: do.cancel() if self._of.board.known.job("diagnose") else do.diagnose())
        self._reset.on_click(lambda: do.reset())

    def _lay_out(self, document: Document) -> None:
        document.title = "msd live"
        document.template = _template()
        document.template_variables["css"] = _text("page.css")
        buttons = (self._amount, self._step, self._record, self._identify, self._diagnose, self._reset)
        for model in (*buttons, self._window, self._pause, *self._cards.values(), *self._plots.figures.values()):
            document.add_root(model)
        arguments = {
            "pulse": self._pulse,
            "sources": self._plots.sources,
            "time": self._plots.time,
            "ranges": self._plots.ranges,
            "tools": [tool for plot in self._plots.figures.values() for tool in plot.toolbar.tools[:2]],
        }
        document.js_on_event(DocumentReady, CustomJS(args=arguments, code=_text("frames.js")))
        self._pulse.on_change("asked", lambda attr, old, new: self._answer())
        self._pulse.on_change("dark", lambda attr, old, new: self._plots.colour(self._pulse.dark))
        self._pulse.on_change("paused", lambda attr, old, new: self._on_pause())
        self._window.on_change("active", lambda attr, old, new: self._on_window())
        self._show_known()

    # -- what it does

    @property
    def _seconds(self) -> float:
        return float(WINDOWS[self._window.active or 0])

    @property
    def _pushing(self) -> bool:
        """Whether the step's button lets go."""
        return self._step.label != "Step"

    def _answer(self) -> None:
        frame = self._of.scope.frame(self._seconds, self._plots.columns)
        if self._frames % max(round(self._of.rate / CALM_RATE), 1) == 0:
            self._show_known()
            self._show_step(frame)
            self._texts = self._numbers(frame)
        self._frames += 1
        self._send(frame)

    def _on_pause(self) -> None:
        """Everything that is kept, finer, to look into; or go on."""
        self._pause.label = "Go on" if self._pulse.paused else "Pause"
        if self._pulse.paused:
            seconds = self._seconds
            self._send(self._of.scope.frame(seconds, FINE, keep=WINDOWS[-1] - seconds))

    def _on_window(self) -> None:
        if self._pulse.paused:
            self._on_pause()

    def _send(self, frame: Frame) -> None:
        scales = self._scales()
        # The number makes every frame another one: what is equal is not sent, and the page would wait for it.
        number = {"number": self._pulse.asked}
        self._pulse.frame = {**number, **self._plots.shown(frame, scales), "texts": self._texts}

    def _scales(self) -> dict[str, DisplayUnit]:
        known = self._of.board.known
        noise = max(self._sizes(), default=math.nan)
        return {
            "force": DisplayUnit(1.0, known.force_unit),
            "position": length_scale(1.0, known.position_unit),
            "residual": length_scale(10.0 * noise if math.isfinite(noise) else 1.0, known.position_unit),
        }

    def _sizes(self) -> list[float]:
        """Sizes that the residual may well have."""
        found, beside = self._of.board.known.estimated, self._of.scope.beside
        sizes = ([found.see] if found else []) + ([beside.noise] if beside else [])
        return [size for size in sizes if math.isfinite(size)]

    def _numbers(self, frame: Frame) -> dict[str, str]:
        """Texts beside the curves, by the place where they stand."""
        known, scales = self._of.board.known, self._scales()
        position = scales["position"]
        problem = self._of.scope.problem
        return {
            "force-now": _fixed(frame.force_now, known.force_unit, 3),
            "position-now": _fixed(frame.position_now * position.factor, position.unit, 3),
            "model-now": _fixed(frame.model_now * position.factor, position.unit, 3),
            "residual-rms": cards.length(frame.residual_rms, known.position_unit),
            "noise": f"± {cards.length(figures.BAND * frame.noise, known.position_unit)}" if frame.noise > 0 else "–",
            **{f"{name}-unit": f"[{scale.unit}]" for name, scale in scales.items()},
            "beside": f"No model runs: {problem}" if problem else known.beside,
        }

    def _show_step(self, frame: Frame) -> None:
        pushing = math.isfinite(frame.force_now) and frame.force_now != 0.0
        _set(self._step, "label", "Release" if pushing else "Step")
        _set(self._step, "css_classes", ["on"] if pushing else ["primary"])

    def _show_known(self) -> None:
        known = self._of.board.known
        jobs = cards.jobs(known)
        _set(self._cards["jobs"], "text", jobs)  # a recording's clock goes on by itself
        if known is self._known:
            return
        self._known = known
        _set(self._cards["data"], "text", cards.data(known))
        _set(self._cards["estimate"], "text", cards.estimate(known.estimated))
        _set(self._cards["verdict"], "text", cards.verdict(known.diagnosed))
        _set(self._cards["lines"], "text", cards.lines(known))
        self._show_buttons(known)

    def _show_buttons(self, known: Known) -> None:
        recording, diagnosing = known.recording is not None, known.job("diagnose") is not None
        for button in (self._step, self._record, self._identify, self._diagnose, self._reset):
            _set(button, "disabled", button.name not in known.present)
        if known.job("identify"):
            _set(self._identify, "disabled", True)
        _set(self._record, "label", "Stop" if recording else "Record")
        _set(self._record, "css_classes", ["on"] if recording else [])
        _set(self._diagnose, "label", "Cancel" if diagnosing else "Diagnose")
        _set(self._diagnose, "css_classes", ["on"] if diagnosing else [])


def _set(model: Any, name: str, value: object) -> None:
    """Change a property if it is another: every change is a message to the browser."""
    if getattr(model, name) != value:
        setattr(model, name, value)


def _fixed(value: float, unit: str, places: int) -> str:
    if not math.isfinite(value):
        return "–"
    rounded = round(value, places) + 0.0  # no minus before a zero
    return f"{rounded:.{places}f} {unit}".replace("-", "−")


def _div(name: str) -> Div:
    return Div(name=name, text="", stylesheets=[_style("card.css")])


def _button(name: str, label: str, *classes: str) -> Button:
    return Button(name=name, label=label, css_classes=list(classes), stylesheets=[_style("widget.css")])


def _style(name: str) -> InlineStyleSheet:
    return InlineStyleSheet(css=_text(name))


@cache
def _text(name: str) -> str:
    return files("msd_ident.live").joinpath(name).read_text(encoding="utf-8")


@cache
def _template() -> jinja2.Template:
    """The page's template, on top of Bokeh's own."""
    return get_env().from_string(_text("page.html"))

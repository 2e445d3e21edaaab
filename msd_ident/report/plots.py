"""The plots of a result: measured and simulated motion, residuals, missing force, ring-down, frequency response."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.report import words
from msd_ident.report.numbers import DisplayUnit, length_scale
from msd_ident.report.plot import Panel, Plot, Role, Series
from msd_ident.report.thinning import MAXIMUM_POINTS, spread, thinned

if TYPE_CHECKING:
    from msd_ident.data.record import FloatArray, Record
    from msd_ident.diagnosis import Diagnosis
    from msd_ident.diagnosis.nonlinear_laws import Beyond
    from msd_ident.estimate import FitResult
    from msd_ident.model.frequency_response import FrequencyResponse
    from msd_ident.residuals.disturbance import DisturbanceEstimate
    from msd_ident.residuals.ringdown import RingDown
    from msd_ident.workflow.identification import Identification


#: Points of curves and clouds of each kind that a page can carry.
_CURVES, _CLOUDS = 24_000, 6000


@dataclass(frozen=True)
class Detail:
    """Most points of a curve and of a cloud."""

    curve: int = MAXIMUM_POINTS
    cloud: int = 1000

    @classmethod
    def shared_by(cls, records: int) -> Detail:
        """What each of so many records may have for a page to stay small; one alone has all."""
        return cls(
            min(MAXIMUM_POINTS, max(_CURVES // max(records, 1), 150)), min(1000, max(_CLOUDS // max(records, 1), 150))
        )


@dataclass(frozen=True)
class ModelCurve:
    """A model's reading (n,) and residual, model − data (n,), of each record, in the position unit."""

    label: str
    role: Role
    predicted: tuple[FloatArray, ...]
    residuals: tuple[FloatArray, ...]

    @classmethod
    def of_readings(
        cls, label: str, role: Role, records: Sequence[Record], predicted: tuple[FloatArray, ...]
    ) -> ModelCurve:
        """From the model's readings of each record."""
        left = tuple(run - record.position for run, record in zip(predicted, records, strict=True))
        return cls(label, role, predicted, left)

    @classmethod
    def of_fit(cls, label: str, role: Role, records: Sequence[Record], fit: FitResult) -> ModelCurve:
        """From a fit to the records."""
        readings = tuple(record.position + left for record, left in zip(records, fit.residuals, strict=True))
        return cls(label, role, readings, fit.residuals)


def diagnosis_curves(diagnosis: Diagnosis) -> tuple[ModelCurve, ...]:
    """Base and extended model; the base alone where nothing was added."""
    base = ModelCurve.of_fit("base model", "base", diagnosis.records, diagnosis.base)
    if not diagnosis.causes:
        return (base,)
    return base, ModelCurve.of_fit("extended model", "extended", diagnosis.records, diagnosis.extended)


#: Label and role of each of the fits of an identification, by its key in the JSON.
STAGES: dict[str, tuple[str, Role]] = {
    "original": ("original (m, b, k)", "base"),
    "paper_refined": ("friction raised", "paper"),
    "refined": ("joint refit", "extended"),
}


def identification_curves(found: Identification) -> tuple[ModelCurve, ...]:
    """Original model, friction raised, joint refit."""
    fits = found.fits.items()
    return tuple(ModelCurve.of_readings(*STAGES[key], found.records, one.predicted) for key, one in fits)


def fit_plot(
    record: Record,
    curves: Sequence[ModelCurve],
    index: int,
    noise_floor: float,
    detail: Detail = Detail(),  # noqa: B008
) -> Plot:
    """Force, motion and residuals over the whole record, with a band of twice the noise floor.

    Args:
        record: measured force and motion.
        curves: simulated motions, each with a name and a role.
        index: number of the record on the page.
        noise_floor: half the width of the band [m].
        detail: points per curve.
    """
    points, most = record.time, detail.curve
    span = length_scale(float(np.ptp(record.position)), record.position_unit)
    left = length_scale(max(float(np.std(curve.residuals[index])) for curve in curves), record.position_unit)
    motion = [line("measured", "measured", points, span.factor * record.position, most)]
    motion += [line(c.label, c.role, points, span.factor * c.predicted[index], most) for c in curves]
    residuals = [noise_band(record, noise_floor, left)]
    for curve in curves:
        residuals.append(_unnamed(line(curve.label, curve.role, points, left.factor * curve.residuals[index], most)))
    return Plot(
        "fit",
        f"Measured and simulated motion: {record.name}",
        "time [s]",
        (
            force_panel(record, most),
            Panel(f"position [{span.unit}]", tuple(motion), 2.2),
            Panel(f"model − data [{left.unit}]", tuple(residuals), 1.3),
        ),
        height=620,
    )


def line(name: str, role: Role, x: FloatArray, y: FloatArray, points: int = MAXIMUM_POINTS) -> Series:
    """A thinned curve.

    Args:
        name: in the legend.
        role: what it shows; decides colour and width.
        x, y: values (n,).
        points: most points that are drawn.
    """
    return Series(name, role, *thinned(x, y, points))


def _unnamed(series: Series) -> Series:
    return Series(series.name, series.role, series.x, series.y, series.kind, legend=False)


def force_panel(record: Record, points: int = MAXIMUM_POINTS) -> Panel:
    """The force on top of a plot."""
    return Panel(f"force [{record.force_unit}]", (_force(record, points),), 0.7)


def noise_band(record: Record, noise_floor: float, scale: DisplayUnit) -> Series:
    """Twice the noise floor either way, over the whole record."""
    ends = record.time[[0, -1]]
    edge = np.full(2, 2.0 * noise_floor * scale.factor)
    return Series("noise, ± 2σ", "noise", ends, edge, "band", low=-edge)


def _force(record: Record, points: int) -> Series:
    start, end = float(record.time[0]), float(record.time[-1])
    inside = (record.force_time > start) & (record.force_time < end)
    stamps = np.concatenate(([start], record.force_time[inside], [end]))
    kind = "steps" if record.hold == "zero" else "line"
    return Series("force", "force", *thinned(stamps, record.force_at(stamps), points), kind, legend=False)  # type: ignore[arg-type]


@dataclass(frozen=True)
class MissingForceView:
    """The missing force of the base model on one record of a page.

    Attributes:
        beyond: estimate of the missing force, and what the extended model gives for it.
        unit: of the missing force.
        record: of the estimate.
        index: number of the record on the page.
        detail: points per curve.
        model: name of the model that explains it.
    """

    beyond: Beyond
    unit: str
    record: Record
    index: int
    detail: Detail
    model: str


def missing_force_plots(view: MissingForceView) -> tuple[Plot, Plot, Plot]:
    """The missing force against time with its band, and against velocity and position with the law of the causes."""
    length = view.record.position_unit
    scale = length_scale(float(np.ptp(view.beyond.measured[view.index].position)), length)
    velocity = _Axis("velocity", f"velocity [{length}/s]", 1.0)
    position = _Axis("position", f"position from rest [{scale.unit}]", scale.factor)
    return _missing_over_time(view), _cloud(velocity, view), _cloud(position, view)


def _missing_over_time(view: MissingForceView) -> Plot:
    part, detail = view.beyond.measured[view.index], view.detail
    time, force = thinned(part.time, part.force, detail.curve)
    spread = 2.0 * np.interp(time, part.time, part.std)
    series = [
        Series("± 2σ", "noise", time, force + spread, "band", low=force - spread),
        Series("missing force, smoothed from the data", "measured", time, force),
    ]
    if view.beyond.explained:
        other = view.beyond.explained[view.index]
        series.append(line(f"the same, of the {view.model}", "extended", other.time, other.force, detail.curve))
    panel = Panel(f"missing force [{view.unit}]", tuple(series))
    return Plot("missing_time", "Missing force against time", "time [s]", (panel,), 300)


@dataclass(frozen=True)
class _Axis:
    """What a cloud is drawn against: a signal of ``DisturbanceEstimate``, its label, and its factor to be shown."""

    signal: str
    label: str
    factor: float


def _cloud(axis: _Axis, view: MissingForceView) -> Plot:
    beyond, detail = view.beyond, view.detail
    part, signal = beyond.measured[view.index], axis.signal
    series = [_points("smoothed from the data", "measured", part, axis, detail)]
    law = next((law for law in beyond.laws if law.signal == signal), None)
    if beyond.explained and not (beyond.whole and law is not None):
        series.append(_points(view.model, "extended", beyond.explained[view.index], axis, detail))
    if law is not None:
        name = " + ".join(words.effect(cause) for cause in law.causes)
        series.append(Series(f"law: {name}", "law", axis.factor * law.over, law.force))
    panel = Panel(f"missing force [{view.unit}]", tuple(series))
    return Plot(f"missing_{signal}", f"Missing force against {signal}", axis.label, (panel,), 340)


def _points(name: str, role: Role, part: DisturbanceEstimate, axis: _Axis, detail: Detail) -> Series:
    signal = getattr(part, axis.signal)
    keep = spread(signal, detail.cloud)
    return Series(name, role, axis.factor * signal[keep], part.force[keep], "points")


def ring_down_plot(ring_down: RingDown, scale: DisplayUnit) -> Plot:
    """Damping ratio and natural frequency against the amplitude of the swing, ± 2σ."""
    amplitude = scale.factor * np.asarray(ring_down.amplitude)

    def panel(label: str, name: str) -> Panel:
        values, spread = np.asarray(getattr(ring_down, name)), 2.0 * np.asarray(getattr(ring_down, f"{name}_std"))
        return Panel(label, (Series(label, "measured", amplitude, values, "points", error=spread, legend=False),))

    panels = (panel("damping ratio ζ", "damping_ratio"), panel("ωn [rad/s]", "natural_frequency"))
    return Plot("ring_down", "Ring-down", f"amplitude of the swing [{scale.unit}]", panels, 380)


def bode_plot(
    models: Sequence[tuple[str, Role, FrequencyResponse]], measured: FrequencyResponse | None, units: tuple[str, str]
) -> Plot:
    """Bode plot of the linear parts, with the measured response where there is one; ``units`` of position and force."""
    rows = [(name, role, response, "line") for name, role, response in models]
    if measured is not None:
        rows.insert(0, ("measured", "measured", measured, "points"))
    size = [Series(name, role, r.frequency, r.magnitude, kind) for name, role, r, kind in rows]  # type: ignore[arg-type]
    turn = [Series(name, role, r.frequency, r.phase, kind, legend=False) for name, role, r, kind in rows]  # type: ignore[arg-type]
    panels = (Panel(f"|x / F| [{units[0]}/{units[1]}]", tuple(size), 1.4, log=True), Panel("phase [°]", tuple(turn)))
    return Plot("bode", "Frequency response", "frequency [rad/s]", panels, 460, log=True)


def probability_plot(names: Sequence[str], probabilities: Sequence[float]) -> Plot:
    """Causes and their probabilities as bars, the first on top."""
    percent = 100.0 * np.asarray(probabilities, dtype=np.float64)
    place = np.arange(percent.size, 0.0, -1.0)
    bars = Series("probability", "law", percent, place, "bars", legend=False)
    panel = Panel("", (bars,), ticks=tuple(zip(place.tolist(), names, strict=True)))
    return Plot("causes", "Causes", "probability [%]", (panel,), height=120 + 28 * len(names))

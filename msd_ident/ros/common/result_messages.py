"""Converts an identification into its ROS message, and the message into a sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from msd_ident.data import quality
from msd_ident.data.record import Origin, Record
from msd_ident.model import Model
from msd_ident.quantity import Quantity
from msd_ident.ros.common.conversions import time_message
from msd_ident.workflow.identification import Identification
from msd_interfaces.msg import Estimate, Loss
from msd_interfaces.msg import Parameter as ParameterMessage

#: Symbols of what is no parameter of a model.
_SYMBOLS = {
    "natural_frequency": "ωn",
    "damping_ratio": "ζ",
    "static_gain": "K",
    "friction_coefficient": "µ",
}
_UNKNOWN = Quantity(math.nan, math.nan, "")


def to_parameter(name: str, quantity: Quantity, symbols: Mapping[str, str]) -> ParameterMessage:
    """A quantity under its canonical name."""
    return ParameterMessage(
        name=name,
        symbol=symbols.get(name, ""),
        value=float(quantity.value),
        std=float(quantity.std),
        lower=float(quantity.low),
        upper=float(quantity.high),
        unit="" if quantity.unit == "1" else quantity.unit,
    )


def to_parameters(quantities: Mapping[str, Quantity], symbols: Mapping[str, str]) -> list[ParameterMessage]:
    """Quantities by name as messages, with the symbols of a model."""
    return [to_parameter(name, quantity, symbols) for name, quantity in quantities.items()]


def to_estimate(found: Identification, source: str, made_ns: int, frame: str = "") -> Estimate:
    """An identification of one record as a message.

    Args:
        found: what was identified.
        source: ``live``, or the path of the bag.
        made_ns: when [ns].
        frame: frame_id of the encoder.
    """
    record = found.records[0]
    symbols = model_symbols(found.refined.model)
    form = found.standard_form.quantities if found.standard_form else {}
    original = found.original.parameters
    message = Estimate(
        source=source,
        window_start=time_message(stamp_of(record, 0)),
        window_end=time_message(stamp_of(record, -1)),
        samples=record.samples,
        missing_samples=found.missing_samples,
        losses=to_losses(found.records),
        force_unit=record.force_unit,
        position_unit=record.position_unit,
        route=found.route,
        method=found.refined.method,
        paper_refined=to_parameters(found.paper_refined.parameters if found.paper_refined else {}, symbols),
        refined=to_parameters(found.refined.parameters, symbols),
        see_original=found.original.see,
        see_paper_refined=found.paper_refined.see if found.paper_refined else math.nan,
        see_refined=found.refined.see,
        paper_see_reduction_percent=found.paper_see_reduction_percent,
        see_reduction_percent=found.see_reduction_percent,
        noise_floor=found.noise_floor,
        warnings=list(found.warnings),
        open=list(found.open),
    )
    message.header.stamp = time_message(made_ns)
    message.header.frame_id = frame
    for name in ("natural_frequency", "damping_ratio", "static_gain"):
        setattr(message, name, to_parameter(name, form.get(name, _UNKNOWN), symbols))
    for name in ("mass", "damping", "stiffness"):
        setattr(message, name, to_parameter(name, original.get(name, _UNKNOWN), symbols))
    return message


def to_losses(records: Sequence[Record]) -> list[Loss]:
    """What is missing in each signal of each record."""
    losses = []
    for record in records:
        known: dict[str, Origin] = {origin.signal: origin for origin in record.origins}
        for signal, time in (("position", record.time), ("force", record.force_time)):
            origin = known.get(signal)
            loss = Loss(signal=signal, samples=time.size, missing_by_stamps=quality.missing_in(time))
            if origin is not None:
                loss.topic, loss.missing_by_sequence = origin.topic, origin.lost
            losses.append(loss)
    return losses


def stamp_of(record: Record, index: int) -> int:
    """Absolute stamp of a position sample [ns]."""
    return record.start_ns + round(float(record.time[index]) * 1e9)


def differences(one: Estimate, other: Estimate) -> tuple[str, ...]:
    """Fields in which two estimates differ in any digit, those that say when and where from aside."""
    fields = [name for name in one.get_fields_and_field_types() if name not in ("header", "source")]
    return tuple(name for name in fields if repr(getattr(one, name)) != repr(getattr(other, name)))


def sentence(estimate: Estimate) -> str:
    """The refined parameters and what they leave, in one line."""
    values = ", ".join(f"{p.symbol or p.name} = {p.value:.4g} {p.unit}".rstrip() for p in estimate.refined)
    less = estimate.see_reduction_percent
    below = f", {less:.0f} % below the linear model" if math.isfinite(less) else ""
    return (
        f"{values}; SEE {estimate.see_refined:.3g} {estimate.position_unit}{below}, from {estimate.samples} samples of "
        f"{estimate.source}"
    )


def model_symbols(model: Model) -> dict[str, str]:
    """Symbols of all quantities of a model, by name."""
    return {**{parameter.name: parameter.symbol for parameter in model.parameters}, **_SYMBOLS}

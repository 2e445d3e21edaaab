"""Messages into samples, results into messages: the only place that knows both sides."""

from __future__ import annotations

import importlib
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time

from msd_ident.bag.choose import BATCH, FORCE_FIELDS, POSITION_FIELDS
from msd_ident.bag.fields import joint_names, parse_field
from msd_ident.errors import DataError, SetupError
from msd_ident.identification import Identification, ModelFit
from msd_ident.model import Model
from msd_ident.quantity import Quantity
from msd_ident.record import FloatArray, Record, batch_stamps
from msd_ident.ros.buffer import StampArray
from msd_interfaces.msg import Estimate
from msd_interfaces.msg import Parameter as ParameterMessage

#: Symbols of what is no parameter of a model.
_SYMBOLS = {
    "natural_frequency": "ωn",
    "damping_ratio": "ζ",
    "static_gain": "K",
    "friction_coefficient": "µ",
}
_UNKNOWN = Quantity(math.nan, math.nan, "")


def message_class(type_name: str) -> Any:
    """Python class of a message type such as ``sensor_msgs/msg/JointState``.

    Raises:
        SetupError: its package is not installed or not sourced.
    """
    package, _, rest = type_name.partition("/")
    try:
        module = importlib.import_module(f"{package}.{rest.rpartition('/')[0] or 'msg'}")
        return getattr(module, rest.rpartition("/")[2])
    except (ImportError, AttributeError, ValueError):
        raise SetupError(
            f"message type {type_name} is not here; expected its package to be installed: "
            "source the workspace that has it"
        ) from None


def nanoseconds(stamp: Time) -> int:
    """A stamp as one whole number [ns]."""
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def time_message(ns: int) -> Time:
    """The stamp of a whole number of nanoseconds."""
    return Time(sec=ns // 10**9, nanosec=ns % 10**9)


class Signal:
    """Takes the samples of one signal out of messages of one type, as the bag reader does.

    Args:
        what: ``force`` or ``position``.
        type_name: of the messages.
        field: path to the number; empty for the usual one of the type.
        scale: factor to the unit of the record.

    Raises:
        UsageError: the field cannot be read.
        DataError: the type needs to be told a field.
    """

    def __init__(self, what: str, type_name: str, field: str = "", scale: float = 1.0) -> None:
        usual = FORCE_FIELDS if what == "force" else POSITION_FIELDS
        text = field or usual.get(type_name, "")
        if not text:
            raise DataError(
                f"{what} topic is of type {type_name}; expected to be told which field to use: write TOPIC:FIELD"
            )
        self.field = parse_field(text)
        self.is_batch = type_name == BATCH and text == "positions"
        self.frame = ""
        self.without = 0
        self.missing = 0
        self._scale = scale
        self._expected: int | None = None
        self._joints: tuple[str, ...] = ()

    @property
    def problem(self) -> str:
        """What is odd about the messages; empty when nothing is."""
        if self.without:
            joints = f"; the joints are: {', '.join(self._joints)}" if self._joints else ""
            return f"{self.without} messages hold no {self.field.text}{joints}"
        if self.missing:
            return f"{self.missing} samples are missing by the sequence numbers of the batches"
        return ""

    def sample(self, message: Any, received_ns: int) -> tuple[int, float] | None:
        """Stamp [ns] and value of a message with one sample, ``None`` when the entry is not in it.

        Raises:
            DataError: the type has no such field.
        """
        value = self.field.value(message)
        if value is None:
            self.without += 1
            self._joints = joint_names(message)
            return None
        return self._stamp(message, received_ns), value * self._scale

    def batch(self, message: Any, received_ns: int) -> tuple[StampArray, FloatArray]:
        """Stamps [ns] and values of a message with many samples."""
        count = len(message.positions)
        sequence = int(message.sequence)
        if self._expected is not None and sequence > self._expected:
            self.missing += sequence - self._expected
        self._expected = sequence + count
        stamps = batch_stamps(self._stamp(message, received_ns), int(message.period_ns), count)
        return stamps, np.array(message.positions, dtype=np.float64) * self._scale

    def _stamp(self, message: Any, received_ns: int) -> int:
        header = getattr(message, "header", None)
        if header is None:
            return received_ns
        self.frame = header.frame_id
        return nanoseconds(header.stamp) or received_ns


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


def to_estimate(found: Identification, source: str, made_ns: int, frame: str = "") -> Estimate:
    """An identification of one record as a message.

    Args:
        found: what was identified.
        source: ``live``, or the path of the bag.
        made_ns: when [ns].
        frame: frame_id of the encoder.
    """
    record = found.records[0]
    symbols = _symbols(found.refined.model)
    form = found.standard_form.quantities if found.standard_form else {}
    original = found.original.parameters
    message = Estimate(
        source=source,
        window_start=time_message(stamp_of(record, 0)),
        window_end=time_message(stamp_of(record, -1)),
        samples=record.samples,
        missing_samples=found.missing_samples,
        force_unit=record.force_unit,
        position_unit=record.position_unit,
        route=found.route,
        method=found.refined.method,
        paper_refined=_parameters(found.paper_refined, symbols),
        refined=_parameters(found.refined, symbols),
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


def stamp_of(record: Record, index: int) -> int:
    """Absolute stamp of a position sample [ns]."""
    return record.start_ns + round(float(record.time[index]) * 1e9)


def sentence(estimate: Estimate) -> str:
    """The refined parameters and what they leave, in one line."""
    values = ", ".join(f"{p.symbol or p.name} = {p.value:.4g} {p.unit}".rstrip() for p in estimate.refined)
    return (
        f"{values}; SEE {estimate.see_refined:.3g} {estimate.position_unit}, {estimate.see_reduction_percent:.0f} % "
        f"below the linear model, from {estimate.samples} samples of {estimate.source}"
    )


def _parameters(found: ModelFit | None, symbols: Mapping[str, str]) -> list[ParameterMessage]:
    parameters: Iterable[tuple[str, Quantity]] = found.parameters.items() if found else ()
    return [to_parameter(name, quantity, symbols) for name, quantity in parameters]


def _symbols(model: Model) -> dict[str, str]:
    return {**{parameter.name: parameter.symbol for parameter in model.parameters}, **_SYMBOLS}

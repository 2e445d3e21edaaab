"""Converts estimates and diagnoses from ROS messages into the values that the live view shows."""

from __future__ import annotations

from collections.abc import Iterable

from msd_ident.errors import UsageError
from msd_ident.live import Beside, Cause, Diagnosed, Estimated, Row, model_of
from msd_ident.quantity import Quantity
from msd_interfaces.msg import Diagnosis, Estimate, Parameter

ALONE = "uses only the force, not the encoder"


def to_estimated(message: Estimate) -> Estimated:
    """The present estimate."""
    standard = (message.natural_frequency, message.damping_ratio)
    known = [parameter for parameter in standard if parameter.value == parameter.value]
    return Estimated(
        rows=rows([*known, *message.refined]),
        see=message.see_refined,
        reduction_percent=message.see_reduction_percent,
        noise=message.noise_floor,
        unit=message.position_unit,
        source=message.source,
        samples=message.samples,
        missing=message.missing_samples,
        remarks=(*message.warnings, *message.open),
    )


def to_diagnosed(message: Diagnosis) -> Diagnosed:
    """The present verdict."""
    return Diagnosed(
        verdict=message.verdict,
        summary=message.summary,
        causes=tuple(
            Cause(cause.name, cause.probability, rows(cause.parameters), tuple(cause.tied_with))
            for cause in message.causes
        ),
        see_base=message.base_see,
        see_extended=message.extended_see,
        heldout_percent=message.heldout_reduction_percent,
        heldout_interval=(message.heldout_reduction_lower, message.heldout_reduction_upper),
        noise=message.noise_floor,
        unit=message.position_unit,
        source=message.path,
        left_percent=message.left_percent,
        tolerance_percent=message.tolerance_percent,
        force=(message.missing_force, message.missing_force_lower, message.missing_force_upper),
        force_unit=message.force_unit,
        warnings=tuple(message.warnings),
    )


def rows(parameters: Iterable[Parameter]) -> tuple[Row, ...]:
    """Parameters with their intervals."""
    return tuple(Row(p.name, p.symbol, Quantity(p.value, p.std, p.unit or "1")) for p in parameters)


def beside_of_estimate(message: Estimate) -> Beside:
    """The refined model of an estimate.

    Raises:
        UsageError: it cannot run beside the rig.
    """
    model = model_of({p.name: p.value for p in message.refined})
    symbols = ", ".join(p.symbol or p.name for p in message.refined if p.name in model.names)
    label = f"The model ({symbols} of the estimate) {ALONE}."
    return Beside(model, label, message.noise_floor, turned(message))


def beside_of_diagnosis(message: Diagnosis, is_turned: bool) -> Beside | None:
    """The extended model of a diagnosis, ``None`` where it extends nothing.

    Raises:
        UsageError: it cannot run beside the rig.
    """
    if not message.causes or not message.extended:
        return None
    causes = " and ".join(cause.name.replace("_", " ") for cause in message.causes)
    model = model_of({p.name: p.value for p in message.extended})
    return Beside(model, f"The model (with {causes}, of the diagnosis) {ALONE}.", message.noise_floor, is_turned)


def turned(message: Estimate) -> bool:
    """Whether a positive force moves the encoder downwards, so that the force was turned round for the fit."""
    return bool(message.static_gain.value < 0.0)


def chosen(estimate: Estimate | None, diagnosis: Diagnosis | None) -> tuple[Beside | None, str]:
    """The model that shall run, the newer of the two that can, and why one cannot (empty when both can)."""
    is_turned = estimate is not None and turned(estimate)
    found: list[tuple[tuple[int, int], Beside | None]] = []
    problem = ""
    try:
        if estimate is not None:
            found.append((_made(estimate), beside_of_estimate(estimate)))
    except UsageError as error:
        problem = f"the estimate's model does not run: {error}"
    try:
        if diagnosis is not None:
            found.append((_made(diagnosis), beside_of_diagnosis(diagnosis, is_turned)))
    except UsageError as error:
        problem = f"the diagnosis's model does not run: {error}"
    able = [(at, beside) for at, beside in found if beside is not None]
    return (max(able, key=lambda pair: pair[0])[1] if able else None), problem


def _made(message: Estimate | Diagnosis) -> tuple[int, int]:
    return message.header.stamp.sec, message.header.stamp.nanosec

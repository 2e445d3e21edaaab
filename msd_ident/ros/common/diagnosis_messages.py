"""Converts a diagnosis into its ROS message."""

from __future__ import annotations

import json
from collections.abc import Mapping

from msd_ident.data import quality
from msd_ident.diagnosis import Diagnosis
from msd_ident.diagnosis.result import Cause
from msd_ident.ros.common.codes import with_nan
from msd_ident.ros.common.conversions import time_message
from msd_ident.ros.common.result_messages import model_symbols, stamp_of, to_losses, to_parameters
from msd_interfaces.msg import Cause as CauseMessage
from msd_interfaces.msg import Diagnosis as DiagnosisMessage


def to_diagnosis(found: Diagnosis, path: str, made_ns: int, frame: str = "") -> DiagnosisMessage:
    """A diagnosis as a message.

    Args:
        found: what was found.
        path: ``live``, or the paths of the bags.
        made_ns: when [ns].
        frame: frame_id of the encoder.
    """
    symbols = model_symbols(found.extended.model)
    held, left = found.heldout, found.left.extended
    message = DiagnosisMessage(
        path=path,
        window_start=time_message(stamp_of(found.records[0], 0)),
        window_end=time_message(stamp_of(found.records[-1], -1)),
        samples=sum(record.samples for record in found.records),
        missing_samples=sum(quality.missing_samples(record) for record in found.records),
        losses=to_losses(found.records),
        position_unit=found.records[0].position_unit,
        verdict=found.verdict,
        summary=found.summary,
        causes=[_cause(cause, symbols) for cause in found.causes],
        base=to_parameters(found.base.quantities, symbols),
        base_see=found.base.see,
        extended=to_parameters(found.extended.quantities, symbols),
        extended_see=found.extended.see,
        see_reduction_percent=found.see_reduction_percent,
        heldout_see_base=held.see_base,
        heldout_see_extended=held.see_extended,
        heldout_reduction_percent=held.reduction_percent,
        heldout_reduction_lower=held.interval_percent[0],
        heldout_reduction_upper=held.interval_percent[1],
        tolerance_percent=found.left.tolerance_percent,
        base_left_percent=found.left.base.motion_percent,
        left_percent=left.motion_percent,
        left_seen=left.seen,
        force_unit=found.left.force_unit,
        base_missing_force=found.left.base.force,
        missing_force=left.force,
        missing_force_lower=left.force_interval[0],
        missing_force_upper=left.force_interval[1],
        missing_force_percent=left.force_percent,
        missing_force_of=found.left.yardstick,
        noise_percent=found.left.noise_percent,
        noise_floor=found.noise_floor,
        warnings=list(found.warnings),
        next_experiment=json.dumps(found.next_experiment) if found.next_experiment else "",
    )
    message.header.stamp = time_message(made_ns)
    message.header.frame_id = frame
    return message


def failed(path: str, reason: str) -> DiagnosisMessage:
    """Stands in the place of a diagnosis that could not be made."""
    message = DiagnosisMessage(path=path, summary=reason)
    with_nan(message)
    return message


def healthy(found: Diagnosis) -> bool:
    """Whether the model is good enough: nothing is missing, or what is missing has one name and repairs it."""
    if found.verdict == "explained":
        return found.heldout.better
    return found.verdict == "adequate"


def _cause(cause: Cause, symbols: Mapping[str, str]) -> CauseMessage:
    return CauseMessage(
        name=cause.name,
        probability=cause.probability,
        parameters=to_parameters(cause.parameters, symbols),
        tied_with=list(cause.tied_with),
        tied_probability=cause.tied_probability,
    )

"""Whether the record holds a motion and its cause."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.quality.finding import Finding, error, info
from msd_ident.data.record import Record


def excitation(record: Record, motion: Motion) -> Iterator[Finding]:
    """Findings on force and position that cannot belong together or tell too little: a copy, no motion, no force."""
    unit = record.position_unit
    factor = _same_signal(record)
    if factor:
        yield error(
            "same_signal",
            f"the force is the position times {factor:.4g} in every sample: name a force of its own",
        )
        return
    if motion.span == 0:
        yield error(
            "constant_position",
            f"the position never changes ({record.position[0]:g} {unit} in all {record.samples} samples): "
            "check the encoder and the choice of the signal",
        )
        return
    if motion.still and motion.force_span == 0:
        yield error(
            "no_excitation",
            f"the force never changes and the position only by {motion.span:.3g} {unit}, which is noise: "
            "apply a force step or release the cart from a displacement",
        )
    elif motion.still:
        yield error(
            "no_motion",
            f"the force changes by {motion.force_span:.3g} {record.force_unit} and the position only by "
            f"{motion.span:.3g} {unit}, which is noise: push harder, or check the encoder",
        )
    elif motion.force_span == 0:
        held = f"constant at {record.force[-1]:g} {record.force_unit}" if record.force[-1] else "zero"
        yield info(
            "free_decay",
            f"the force is {held} all the time: a free decay, which gives the parameters relative to each other only",
        )


def _same_signal(record: Record) -> float:
    """Factor that makes the position the force, 0.0 when they are two signals."""
    largest = int(np.argmax(np.abs(record.position)))
    if not record.shared_clock or not record.position[largest]:
        return 0.0
    factor = float(record.force[largest] / record.position[largest])
    same = np.allclose(record.force, factor * record.position, rtol=1e-9, atol=0.0)
    return factor if same and np.ptp(record.position) > 0 else 0.0

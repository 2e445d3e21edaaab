"""Whether the record holds a motion and its cause."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from msd_ident.data.motion import Motion
from msd_ident.data.quality.finding import Finding, error, info, warning
from msd_ident.data.record import FloatArray, Record
from msd_ident.data.streams import OTHER_VALUES

#: Parts of the variance of force and of motion that lie at one frequency where both are a single tone. A controller
#: that leads a rig along a sine leaves 0.92 to 1 of the force there, and 0.998 to 1 of the motion; a drive under a sine
#: that a wheel drifts away from 0.977 of the motion. A square wave has 0.81, a measured sweep or steps 0.84 and 0.81.
_TONE_OF_FORCE, _TONE_OF_MOTION = 0.9, 0.97
#: Fewest periods of a tone, and lines of the spectrum on either side of it that a window of Hann spreads it over.
_PERIODS, _SPREAD = 2, 2
#: Part of the samples at which a force in steps changes, at most.
_JUMPS = 0.02
#: Fewest levels of a force in steps: an encoder of a cart that stands may flip by a count.
_LEVELS = 3


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
    elif swapped(record, motion):
        yield error(
            "no_motion",
            f"the position jumps within {np.ptp(record.position):.3g} {unit} and stays where it is in between, as a "
            f"force in steps does, and the force runs smoothly over {motion.force_span:.3g} {record.force_unit}, as a "
            "position does: "
            "are the two swapped? Name them with --force and --position; if not, push harder, or check the encoder",
        )
    elif motion.still and (coarse := next((note for note in record.notes if OTHER_VALUES in note), "")):
        yield error(
            "no_motion",
            f"the {record.samples} samples that have stamps of their own are too few to tell the motion, over "
            f"{motion.span:.3g} {unit}, from noise; {coarse[:-1]}",
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
    elif tone := single_tone(record):
        yield warning(
            "single_tone",
            f"force and motion are a single tone of {tone:.3g} Hz: this record alone shows k - m·omega² and b, and "
            "what tells m from k in it may be noise: add records at other frequencies, a sweep or steps",
        )


def swapped(record: Record, motion: Motion) -> bool:
    """Whether the position of a cart that seems to stand looks like a force in steps, and the force like a motion.

    Args:
        record: force and position.
        motion: what moves in it, apart from jumps of the position.
    """
    if not motion.still or not record.shared_clock or motion.span <= motion.force_span:
        return False
    jumps, changes = np.diff(record.position), np.diff(record.force)
    steady = np.count_nonzero(jumps) <= _JUMPS * jumps.size and np.unique(record.position).size >= _LEVELS
    moves = np.count_nonzero(changes) >= 10 * np.count_nonzero(jumps)
    return bool(steady and moves and np.max(np.abs(changes)) < motion.force_span / 5.0)


def single_tone(record: Record) -> float:
    """Frequency [Hz] of the only tone in force and motion; 0 if there are more."""
    return record.kept("single tone", lambda: _tone(record), small=True)


def _tone(record: Record) -> float:
    line, of_force = _strongest(record.force_at(record.time))
    same, of_motion = _strongest(record.position)
    alone = of_force > _TONE_OF_FORCE and of_motion > _TONE_OF_MOTION and line == same >= _PERIODS
    return line / record.duration if alone else 0.0


def _strongest(signal: FloatArray) -> tuple[int, float]:
    """Line of the strongest tone in the spectrum of a signal (n,), and its part of the variance."""
    power = np.abs(np.fft.rfft((signal - signal.mean()) * np.hanning(signal.size))) ** 2
    line = int(np.argmax(power))
    return line, float(np.sum(power[max(line - _SPREAD, 0) : line + _SPREAD + 1]) / max(np.sum(power), 1e-300))


def _same_signal(record: Record) -> float:
    """Factor that makes the position the force, 0.0 when they are two signals."""
    largest = int(np.argmax(np.abs(record.position)))
    if not record.shared_clock or not record.position[largest]:
        return 0.0
    factor = float(record.force[largest] / record.position[largest])
    same = np.allclose(record.force, factor * record.position, rtol=1e-9, atol=0.0)
    return factor if same and np.ptp(record.position) > 0 else 0.0

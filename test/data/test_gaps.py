"""Long gaps in which the force is not known: the longest part without one is used, and the options for others named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from msd_ident.data.quality import Examined, examine
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError
from msd_ident.io import SourceOptions, read, write_csv
from msd_ident.workflow.preparation import prepare

TIME = 0.004 * np.arange(3750)
#: A sweep from 0.3 to 5 Hz, and a cart on a spring that follows it.
FORCE = 6.0 * np.sin(2.0 * np.pi * (0.3 * TIME + 2.35 * TIME**2 / 15.0))
SWEEP = from_samples(TIME, FORCE, np.round(FORCE / 400.0, 5))


def without(record: Record, *gaps: tuple[float, float]) -> Record:
    """A shared clock whose samples inside the gaps are lost."""
    kept = np.all([(record.time <= begin) | (record.time >= end) for begin, end in gaps], axis=0)
    return from_samples(record.time[kept], record.force[kept], record.position[kept])


def said(found: Examined) -> list[str]:
    return [finding.sentence for finding in found.findings if finding.code == "long_gap"]


def test_the_longest_part_without_a_gap_is_used_and_the_other_is_named() -> None:
    """Simulated over half a second of a lost sweep, friction was 64 % likely, with 8 % of the motion left over."""
    record = without(SWEEP, (6.0, 6.5))
    found = examine(record)
    part = record.cut(6.5, 15.0)
    assert found.given is record and found.record.position.tolist() == part.position.tolist()
    assert found.record.time.tolist() == part.time.tolist() and found.record.origin == part.origin
    assert said(found) == [
        "the force is not known in a long gap of 0.5 s at 6 s: only the longest part without one is used, 6.5 s to "
        "14.996 s (59 % of the samples); for another part, use --start 0 --end 6 (41 %)"
    ]
    assert prepare([record]).records[0].time[0] == 6.5
    chosen = examine(record.cut(0.0, 6.0))
    assert not said(chosen) and chosen.record.samples == 1501


def test_several_gaps() -> None:
    found = examine(without(SWEEP, (3.0, 3.4), (10.0, 10.7), (11.0, 11.5)))
    assert found.record.time[[0, -1]].tolist() == [3.4, 10.0]
    assert said(found) == [
        "the force is not known in 3 long gaps, the longest of 0.7 s at 10 s: only the longest part without one is "
        "used, 3.4 s to 10 s (49 % of the samples); for another part, use --start 11.5 --end 14.996 (26 %) or "
        "--start 0 --end 3 (22 %)"
    ]


def test_a_record_in_pieces_is_used_whole_with_a_warning() -> None:
    pieces = without(SWEEP, *((at, at + 0.5) for at in np.arange(1.0, 15.0, 1.5)))
    found = examine(pieces)
    assert found.record.samples == pieces.samples
    (sentence,) = said(found)
    assert "no part without one is long enough to stand for the record" in sentence
    assert "record again without losses" in sentence


def test_a_part_in_which_the_cart_rests_does_not_stand_for_the_record() -> None:
    moving = TIME < 6.0
    still = from_samples(TIME, np.where(moving, FORCE, 0.3 * (TIME > 6.2)), np.where(moving, SWEEP.position, 0.0))
    assert "no part without one is long enough" in said(examine(without(still, (6.0, 6.5))))[0]


STEPS = np.where(TIME > 3.0, 5.0, 0.0) - np.where(TIME > 9.0, 8.0, 0.0)


@pytest.mark.parametrize(
    "record",
    [
        SWEEP,
        without(SWEEP, *((at, at + 0.02) for at in np.arange(0.5, 14.0, 0.7))),  # four samples each
        replace(SWEEP, time=np.delete(TIME, slice(1500, 1625)), position=np.delete(SWEEP.position, slice(1500, 1625))),
        without(from_samples(TIME, STEPS, SWEEP.position), (6.0, 6.5)),
        replace(without(SWEEP, (6.0, 6.5)), force_time=TIME[::500], force=FORCE[::500]),  # commands, now and then
        replace(without(SWEEP, (6.0, 6.5)), force_time=TIME[::100], force=FORCE[::100]),  # at a slow rate
        replace(without(SWEEP, (6.0, 6.5)), force_time=TIME[:1], force=np.zeros(1)),
    ],
    ids=["no gap", "short gaps", "the force goes on", "a constant force", "commands", "a slow force", "no force"],
)
def test_other_records_stay_whole(record: Record) -> None:
    found = examine(record)
    assert found.record.samples == record.samples and not said(found)


def test_a_band_limited_force_of_a_part_without_gaps(tmp_path: Path) -> None:
    """The whole was interpolated before it was cut, and refused whatever the window."""
    write_csv(without(SWEEP, (6.0, 6.5)), tmp_path / "sweep.csv")
    with pytest.raises(DataError, match="use --hold linear, or --start and --end for a part without gaps"):
        read(tmp_path / "sweep.csv", SourceOptions(hold="band_limited"))
    part = read(tmp_path / "sweep.csv", SourceOptions(hold="band_limited", start=6.5))
    assert part.samples == 2125 and part.upsampled == 4

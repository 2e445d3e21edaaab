"""Laws of time begin with the part of a record that is used: what was recorded before it changes no result."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from effect_examples import EXAMPLES, model, plant, record

from msd_ident.data.record import Record
from msd_ident.io import SourceOptions, read, write_csv
from msd_ident.model import simulate
from msd_ident.model.effects.typical import lines
from msd_ident.selection import starting_values

#: How long the recorder waits before the experiment [s].
WAIT = 600.0


def late(own: Record) -> Record:
    """The same experiment, cut from a recording that began long before."""
    before = np.arange(20) * 10.0
    whole = replace(
        own,
        time=np.concatenate([before, own.time + WAIT]),
        position=np.concatenate([0.0 * before, own.position]),
        force_time=own.force_time + WAIT,
    )
    return whole.cut(WAIT, np.inf)


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_a_cut_record_moves_like_one_that_begins_there(name: str) -> None:
    own = record(duration=2.0)
    first = simulate(model(name), own, 0.004, 0.05).position
    assert simulate(model(name), late(own), 0.004, 0.05).position == pytest.approx(first, abs=1e-8)


def test_tones_of_a_cut_record_begin_there_too() -> None:
    """Starting values of a disturbance, from its force and from the residual that it leaves."""
    own = record(duration=6.0)
    moved = replace(own, position=simulate(model("periodic_disturbance"), own).position)
    left = simulate(plant(), own).position - moved.position
    assert lines(late(moved), plant(), 1)[0] == pytest.approx(lines(moved, plant(), 1)[0], rel=1e-6)
    ours, theirs = (starting_values.lines(one, plant(), left)[0] for one in (moved, late(moved)))
    assert theirs == pytest.approx(ours, rel=1e-6)


def test_a_window_keeps_the_origin_and_a_cut_moves_it(tmp_path: Path) -> None:
    own = record(duration=3.0)
    assert own.window(1.0, 2.0).origin == 0.0 and own.cut(1.0, 2.0).origin == 1.0
    assert own.cut(1.0, 3.0).window(2.0, 3.0).origin == 1.0
    assert own.cut(1.0, 3.0).from_origin().time[0] == 0.0 and own.from_origin() is own
    moving = replace(own, position=simulate(plant(), own).position)
    write_csv(moving, tmp_path / "rig.csv")
    found = read(tmp_path / "rig.csv", SourceOptions(start=1.0))
    assert found.time[0] == pytest.approx(1.0) and found.origin == found.time[0], "the clock of messages stays"

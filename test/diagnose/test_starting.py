"""Where sets of causes start."""

from __future__ import annotations

import numpy as np

from msd_ident import pipeline
from msd_ident.record import Record
from msd_sim import api


def test_friction_and_drag_of_one_step_at_few_samples_a_swing_are_not_taken_for_three_other_causes() -> None:
    """Where the cart comes to stick makes valleys: beside friction alone, the drag ends at none; a regression helps."""
    made = api.simulate(
        {"mass": 0.9407, "damping": 3.927, "stiffness": 694.1, "friction_coefficient": 0.0133,
         "effects": {"quadratic_drag": {"drag_coefficient": 4.0}}, "rate": 100.0, "duration": 3.0, "seed": 7,
         "encoder": {"counts_per_metre": 226600.0, "noise": 1e-5}, "force_time": [0.0], "force": [10.0]}
    )  # fmt: skip
    record = Record(time=made.time, position=made.position, force_time=made.time, force=np.full(made.time.size, 10.0))
    found = pipeline.diagnose([record])
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "quadratic_drag"}
    assert found.adequacy.ratio < 1.15

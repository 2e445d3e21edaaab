"""What rest before the first push says, where the samples leave it open."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.workflow import pipeline
from msd_sim import api, lottery


@pytest.mark.usefixtures("without_copies")
def test_a_start_on_the_edge_of_sticking_is_not_taken_for_sharp() -> None:
    """One step from rest with dry friction: all forces may be larger or smaller by Fc/F, and the intervals say so."""
    spec = lottery.draw(24, "coulomb_friction", False, "step").spec
    step = float(spec["experiment"]["force"])
    rest = {key: value for key, value in spec.items() if key != "experiment"}
    made = api.simulate(rest | {"force_time": [0.0, 0.3], "force": [0.0, step], "duration": 3.0, "seed": 25})
    record = Record(
        time=made.time, position=made.position, force_time=np.array([0.0, 0.3]), force=np.array([0.0, step])
    )
    found = pipeline.diagnose([record]).extended.quantities
    unsure = float(spec["effects"]["coulomb_friction"]["coulomb_force"]) / step
    for name in ("mass", "damping", "stiffness"):
        true = float(spec[name])
        assert abs(found[name].value - true) < 3.0 * found[name].std
        assert 0.2 * unsure < found[name].std / true < 2.0 * unsure


def test_a_breakaway_that_rest_leaves_open_stays_above_the_sliding_friction(asking_about: Callable[..., None]) -> None:
    """Below it nothing would tell of it: a rival that is Coulomb friction under another name can be parted by no
    experiment.
    """
    asking_about("coulomb_friction", "stribeck_friction", "position_dependent_friction")
    spec = lottery.draw(5023, "coulomb_friction", True, "step").spec
    rest = {key: value for key, value in spec.items() if key != "experiment"}
    at, force = np.array([0.0, 0.3]), np.array([0.0, float(spec["experiment"]["force"])])
    made = api.simulate(rest | {"force_time": at, "force": force, "duration": 3.0, "seed": int(spec["seed"]) + 1})
    found = pipeline.diagnose([Record(time=made.time, position=made.position, force_time=at, force=force)])
    assert found.contenders[0].causes == ("coulomb_friction",)
    (rival,) = (one for one in found.contenders if one.model.has("stribeck_friction"))
    assert rival.model["static_force"] > rival.model["coulomb_force"]
    assert np.linalg.matrix_rank(rival.information) == len(rival.free)

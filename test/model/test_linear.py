"""The linear model against the control library, and the standard form."""

from __future__ import annotations

import control
import numpy as np
import pytest
from effect_examples import EXAMPLES, model, plant

from msd_ident.data.record import Record
from msd_ident.errors import UsageError
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.linear import physical, standard_form, transfer_function


def linear_response(whole: Model, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the solver and of ``control.forced_response``, whose input is linear between samples."""
    time = np.arange(int(3.0 * rate) + 1) / rate
    force = 9.0 * np.sin(11.0 * time) + np.where(time > 1.0, 4.0, 0.0)
    measured = Record(time=time, position=0.0 * time, force_time=time, force=force, hold="linear")
    return simulate(whole, measured).position, control.forced_response(transfer_function(whole), time, force).outputs


@pytest.mark.parametrize("rate", [250.0, 1000.0])
@pytest.mark.parametrize("whole", [plant(), Plant(1.0, 60.0, 694.1), Plant(1.0, 0.0, 100.0)])
def test_plant_agrees_with_forced_response(whole: Model, rate: float) -> None:
    ours, theirs = linear_response(whole, rate)
    assert np.max(np.abs(ours - theirs)) <= 1e-9 * np.max(np.abs(theirs))


def test_a_relaxing_spring_agrees_with_forced_response() -> None:
    ours, theirs = linear_response(model("relaxing_spring"), 1000.0)
    assert np.max(np.abs(ours - theirs)) <= 1e-6 * np.max(np.abs(theirs))
    # A brake that acts while the drive is on is no part of the linear model.
    braked = transfer_function(model("lagging_drive_damping"))(20j)
    assert braked == transfer_function(plant())(20j)


def test_lag_and_second_mode_agree_with_forced_response() -> None:
    ours, theirs = linear_response(model("actuator_lag"), 1000.0)
    assert np.max(np.abs(ours - theirs)) <= 1e-9 * np.max(np.abs(theirs))
    ours, theirs = linear_response(model("second_mode"), 1000.0)
    assert np.max(np.abs(ours - theirs)) <= 1e-6 * np.max(np.abs(theirs))
    assert "second_mode" in EXAMPLES


def test_standard_form_of_the_paper_and_back() -> None:
    """Tables 2 and 3: m 0.9407, b 3.927, k 694.1 against 27.16 rad/s, 0.0769, 0.1441 cm/N."""
    form = standard_form(0.9407, 3.927, 694.1)
    assert form.natural_frequency == pytest.approx(27.16, abs=0.005)
    assert form.damping_ratio == pytest.approx(0.0769, abs=0.0001)
    assert 100.0 * form.static_gain == pytest.approx(0.1441, abs=0.0001)
    again = physical(form)
    assert again.values == pytest.approx([0.9407, 3.927, 694.1], rel=1e-12)
    poles = transfer_function(again).poles()
    assert np.abs(poles) == pytest.approx([form.natural_frequency] * 2)


def test_no_spring_has_no_standard_form() -> None:
    with pytest.raises(UsageError, match="stiffness 0 N/m have no standard form"):
        standard_form(1.0, 1.0, 0.0)

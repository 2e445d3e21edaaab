"""Fits of real measurements that nobody on this project made."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import FitResult, fit
from msd_ident.model import Model, Plant
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.hysteresis import Hysteresis
from msd_ident.model.effects.time_offset import TimeOffset

#: A. Janot, M. Gautier, M. Brunot 2019; offset on the left-hand side.
PUBLISHED = {"mass": 95.1089, "damping": 203.5034, "coulomb_force": 20.3935, "offset_force": -3.1648}


@pytest.fixture(scope="module")
def emps(shared_data: Path) -> Record:
    return from_samples(*np.loadtxt(shared_data / "emps" / "emps_train.csv", delimiter=",", skiprows=1).T, name="emps")


@pytest.fixture(scope="module")
def ecp(shared_data: Path) -> tuple[Record, Record]:
    """Two steps of the ECP 210 in volts and metres; +V moves to −counts."""
    records = []
    for name in ("step_1", "step_2"):
        time, volts, counts = np.loadtxt(shared_data / "ecp210" / f"{name}.csv", delimiter=",", skiprows=1).T
        records.append(Record(time, -counts / 56000.0, time, volts, force_unit="V", name=name))
    return records[0], records[1]


def _residual_percent(result: FitResult, records: tuple[Record, ...]) -> float:
    spread = np.std(np.concatenate([record.position for record in records]))
    return float(100.0 * result.see / spread)


@pytest.mark.parametrize("start", [Plant(50.0, 100.0, 0.0), Plant(130.0, 500.0, 0.0)])
def test_emps(emps: Record, start: Model) -> None:
    result = fit(start + CoulombFriction(10.0) + ForceOffset(0.0), emps, fixed=["stiffness"])
    rmse = float(np.sqrt(np.mean(result.residuals[0] ** 2)))
    assert rmse < 2.6e-3
    for name, within in (("mass", 0.06), ("damping", 0.12), ("coulomb_force", 0.15), ("offset_force", 0.15)):
        assert result.quantities[name].value == pytest.approx(PUBLISHED[name], rel=within), name
    assert result.effective_samples < 500


def test_emps_friction_is_what_matters(emps: Record) -> None:
    without = fit(Plant(50.0, 100.0, 0.0) + ForceOffset(0.0), emps, fixed=["stiffness"])
    result = fit(Plant(50.0, 100.0, 0.0) + CoulombFriction(10.0) + ForceOffset(0.0), emps, fixed=["stiffness"])
    assert result.see < 0.6 * without.see
    friction = result.quantities["coulomb_force"]
    assert friction.value > 5.0 * friction.std


def test_ecp_friction_is_significant(ecp: tuple[Record, Record]) -> None:
    result = fit(Plant(0.3, 1.0, 150.0) + CoulombFriction(0.01), ecp)
    friction = result.quantities["coulomb_force"]
    assert friction.value > 5.0 * friction.std
    assert _residual_percent(result, ecp) < 3.1
    assert "The force is in V and its gain in newtons is unknown" in result.open_directions[-1]


def test_ecp_with_the_best_library_model(ecp: tuple[Record, Record]) -> None:
    model = Plant(0.37, 0.2, 177.0) + CoulombFriction(0.02) + Hysteresis(0.03, 5e-4) + TimeOffset(-0.004)
    three = fit(model, ecp)
    assert _residual_percent(three, ecp) < 2.1
    four = fit(three.model + CubicSpring(1e5), ecp, search="near", initial=three.initial)
    assert _residual_percent(four, ecp) < 2.0


def test_ecp_how_the_force_is_held_matters(ecp: tuple[Record, Record]) -> None:
    model = Plant(0.3, 1.0, 150.0) + CoulombFriction(0.01)
    joined = tuple(replace(record, hold="linear") for record in ecp)
    assert _residual_percent(fit(model, joined), ecp) > _residual_percent(fit(model, ecp), ecp) + 0.3

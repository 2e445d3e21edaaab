"""The search of a diagnosis: its data, its leading set as a fit, and its refusal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.quality import Finding
from msd_ident.data.record import Record, from_samples
from msd_ident.diagnosis import Task, concluded, diagnose_records, search
from msd_ident.diagnosis.searching import prepare
from msd_ident.errors import UsageError
from msd_ident.model import Plant, simulate
from msd_ident.model.base_model import DryFriction


def rubbing() -> Record:
    """A rig with 0.3 N of dry friction, in steps, with noise."""
    time = np.arange(1500) / 250.0
    force = 8.0 * np.sign(np.sin(2.0 * np.pi * time / 1.4)) * (time > 0.3)
    told = from_samples(time, force, np.zeros(time.size))
    noise = np.random.default_rng(2).normal(0.0, 1e-5, time.size)
    moved = simulate(Plant(1.0, 2.0, 600.0) + DryFriction(0.3), told).position
    return from_samples(time, force, moved + noise)


def test_a_conclusion_from_a_search_is_the_diagnosis(asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring")
    task = Task((rubbing(),))
    found = search(task)
    assert found.ranking.best.causes == {"coulomb_friction"}
    assert found.fitted.quantities["coulomb_force"].value == pytest.approx(0.3, rel=0.02)
    one, other = concluded(task, found), diagnose_records(task)
    assert one.to_json_dict() == other.to_json_dict()


def test_what_the_data_cannot_give_is_fixed() -> None:
    record = rubbing()
    free = from_samples(record.time, np.zeros(record.samples), record.position)
    assert prepare(Task((record,))).fixed == frozenset()
    assert prepare(Task((record,), sprung=False)).fixed == {"stiffness"}
    assert prepare(Task((free,))).fixed == {"mass"}


def test_laws_that_need_no_force_are_looked_for_where_they_may_follow_the_motion() -> None:
    record = rubbing()
    time = np.arange(0.0, 20.0, 0.01)
    asked = from_samples(time, np.sin(2.0 * np.pi * time), np.zeros(time.size), hold="linear")
    tone = replace(asked, position=simulate(Plant(1.0, 5.0, 60.0), asked).position)
    follows = Finding("warning", "closed_loop", "the force follows the readings")
    assert not prepare(Task((record,))).led
    assert prepare(Task((record,), balanced=True)).led
    assert prepare(Task((record,), findings=(follows,))).led
    assert prepare(Task((tone,))).led and not prepare(Task((record, tone))).led


def test_no_records_are_refused() -> None:
    with pytest.raises(UsageError, match="no records to diagnose; expected at least one"):
        search(Task(()))

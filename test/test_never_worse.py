"""What ``diagnose`` hands over simulates at least as well as what ``identify`` found on the same record."""

from __future__ import annotations

from pathlib import Path

import pytest
from once import diagnosed

from bench.real.rigs import RIGS
from msd_ident.data.record import Record
from msd_ident.estimate import fit
from msd_ident.io import read
from msd_ident.model import Model
from msd_ident.workflow.pipeline import identify
from msd_ident.workflow.starting_plant import typical_plant
from msd_sim import lottery
from msd_sim.api import simulate

#: Rounding, and what rest before the first push is allowed to cost.
CLOSE = 1.0 + 1e-6
#: Seed, hidden effect, whether Coulomb friction acts beside it, experiment.
DRAWN = (
    pytest.param(1, "coulomb_friction", False, "steps", marks=pytest.mark.long),
    (2, "quadratic_drag", True, "steps"),
    (3, "cubic_spring", True, "step"),
    (4, "coulomb_friction", False, "release"),
    pytest.param(7, "quadratic_drag", True, "release", marks=pytest.mark.long),
    pytest.param(8, "end_stop", True, "steps", marks=pytest.mark.long),
)
#: Measured rigs; a step of one is diagnosed once for all tests that ask for it.
MEASURED = (
    pytest.param("step_1", marks=pytest.mark.xdist_group("step_1")),
    *(
        pytest.param(name, marks=pytest.mark.long)
        for name in ("polimi_decay_stiff", "ecp2023_release_2", "spring_cart_1")
    ),
)


def never_worse(record: Record, friction_known: bool, copied: bool = False) -> None:
    """Compare both, and the base model with a fit of mass, damping and stiffness alone.

    Copies of a poor experiment change probabilities and seldom the model.
    """
    identified, found = identify([record]), diagnosed([record], copied=copied)
    causes = {cause.name for cause in found.causes}
    effects = set(identified.refined.model.effect_names)
    assert not friction_known or effects <= causes
    if effects <= causes:
        assert found.extended.see <= CLOSE * identified.refined.see
    assert found.base.see <= CLOSE * linear(found.records, identified.refined.model)
    assert found.extended.see <= CLOSE * found.base.see


def linear(records: tuple[Record, ...], found: Model) -> float:
    """SEE of mass, damping and stiffness, fitted from two starts."""
    fixed = {} if found["stiffness"] > 0.0 else {"stiffness": 0.0}
    if not records[0].force.any():
        fixed["mass"] = 1.0
    near = fit(found.without("coulomb_friction", "force_offset"), records, fixed=fixed, search="near")
    return min(near.see, fit(typical_plant(records[0]).with_values(fixed), records, fixed=fixed).see)


@pytest.mark.parametrize(("seed", "hidden", "beside", "experiment"), DRAWN)
def test_on_drawn_rigs(seed: int, hidden: str, beside: bool, experiment: str) -> None:
    made = simulate(dict(lottery.draw(seed, hidden, beside, experiment).spec))
    never_worse(Record(made.time, made.position, made.force_time, made.force, hold=made.hold), friction_known=True)


@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", MEASURED)
def test_on_measured_rigs(shared_data: Path, name: str) -> None:
    (rig,) = (rig for rig in RIGS if rig.name == name)
    if not (shared_data / rig.path).is_file():
        pytest.skip(f"no {rig.path} among the measured data")
    never_worse(read(shared_data / rig.path, rig.options), friction_known=False, copied=name != "step_1")

"""Every effect in every target: a stated class, and what is called exact moves like the model itself."""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path

import effect_examples
import numpy as np
import pytest
from exportrigs import ALL, saved

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import Initial
from msd_ident.export import TARGETS, Target
from msd_ident.export.mujoco_replay import imported, lagged
from msd_ident.export.plan import Plan
from msd_ident.export.support import WORDS, rows
from msd_ident.export.target import InitialState
from msd_ident.model import Simulator
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.model.effects.law import COMMAND_LOOP

LAWS = ("coulomb_friction", "stribeck_friction", "load_dependent_friction")
BY_NAME = {target.name: target for target in TARGETS}
ZERO = 0.003
#: Part of what an effect does to the motion that its replay may miss; with dry friction at four steps a sample.
CLOSE = {"mujoco": 5e-3, "mujoco-xml": 5e-3, "python": 1e-4, "python-msd": 1e-9, "fmu": 3e-4}


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_every_effect_has_a_class(target: Target) -> None:
    said = rows(target)
    assert [row.effect for row in said] == [effect.name for effect in LIBRARY]
    assert all(row.support.kind in WORDS and len(row.support.how) > 1 for row in said)


def test_no_table_has_a_role_that_no_effect_plays() -> None:
    """What a format says of a role that is gone would never be read."""
    from msd_ident.export import gains, gazebo, mujoco_elements, mujoco_plain, python_source, roles

    tables = (gains._SUPPORT, gazebo._SUPPORT, mujoco_elements.NATIVE, mujoco_plain._SUPPORT)
    assert {role for table in tables for role in table} <= set(map(roles.role, LIBRARY))
    # A drive's loop over its commands is in no file yet: each says so.
    assert {by_name(name).structure for name in ALL} == {"", *python_source.STRUCTURES, COMMAND_LOOP}


@pytest.mark.parametrize("name", ["cubic_spring", "asymmetric_spring", "quadratic_drag"])
def test_a_power_is_known_by_its_law_alone(name: str) -> None:
    """Under any name, and not by chance: with a further term it is another law."""
    from msd_ident.export.roles import role

    own = by_name(name)
    renamed = type("Renamed", (own,), {"name": "renamed"})

    @functools.wraps(own.force)
    def force(*given: float) -> float:
        return own.force(*given) + 1e-3 * given[0]

    bent = type("Bent", (own,), {"force": staticmethod(force)})
    assert role(renamed) == role(own) != "" == role(bent)


def test_an_effect_without_element_and_law_is_no_secret() -> None:
    class Unknown(by_name("backlash")):  # type: ignore[misc]
        name = "unknown"
        structure = "a part that no file has"

    assert all(BY_NAME[name].supports(Unknown).kind == "cannot" for name in ("mujoco", "python", "fmu"))


def _replayed(
    target: Target, name: str, hold: str, folder: Path, *others: str, steps: int = 4, duration: float = 0.75
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Readings in the target, here, and here without the effect."""
    record = effect_examples.record(1000.0, hold, duration=duration)  # type: ignore[arg-type]
    model, bare = effect_examples.model(name, *others), effect_examples.model(*others)
    plan = Plan(saved(model), model, zero=ZERO, steps=steps)
    out = folder / f"rig{target.suffixes[0]}"
    for path, content in target.files(plan, out).items():
        path.write_bytes(content)
    got = target.replay(out, plan, InitialState(record, Initial(0.0, 0.0, ZERO)))
    ours, without = (Simulator(one, record).positions(one.values) + ZERO for one in (model, bare))
    return got, ours, without


@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize("effect", ALL)
@pytest.mark.parametrize("target", ["mujoco", "mujoco-xml", "python", "python-msd"])
def test_exact_is_exact(target: str, effect: str, hold: str, tmp_path: Path) -> None:
    one = BY_NAME[target]
    if one.support(effect_examples.example(effect), effect_examples.plant()).kind != "exact":
        pytest.skip("not called exact")
    duration = 0.5 if hold == "zero" else 0.75  # a chirp takes longer until it reaches a stop
    got, ours, without = _replayed(one, effect, hold, tmp_path, duration=duration)
    does = np.sqrt(np.mean((ours - without) ** 2))
    assert does > 1e-6
    assert np.sqrt(np.mean((got - ours) ** 2)) < CLOSE[target] * does


@pytest.mark.parametrize(
    ("law", "beside"),
    [
        pytest.param(law, beside, marks=pytest.mark.long if law != LAWS[0] and beside else ())
        for law in LAWS
        for beside in ("", "actuator_lag", "second_mode", "end_stop", "hysteresis")
    ],
)
def test_dry_friction_is_exact_at_the_records_own_step(law: str, beside: str, tmp_path: Path) -> None:
    """Each law alone, and Coulomb's beside what a file has as a part of its own; the other pairs are ``long``."""
    others = (beside,) if beside else ()
    got, ours, without = _replayed(BY_NAME["mujoco"], law, "zero", tmp_path, *others, steps=1, duration=1.5)
    assert np.sqrt(np.mean((got - ours) ** 2)) < 5e-4 * np.sqrt(np.mean((ours - without) ** 2))


def test_a_limit_that_takes_part_of_all_forces_is_exact_in_mujoco_but_beside_the_callbacks_friction() -> None:
    """The constraint would have to know the callback's friction: 0.35 % off where friction holds in the limit."""
    limit = effect_examples.example("constraint_stop")
    rubbing = effect_examples.model("coulomb_friction")
    assert BY_NAME["mujoco"].support(limit, effect_examples.plant()).kind == "exact"
    assert BY_NAME["mujoco"].support(limit, rubbing).kind == "approximated"
    assert BY_NAME["mujoco-xml"].support(limit, rubbing).kind == "exact"


def test_gains_send_the_reference_away_from_every_kind_of_stop() -> None:
    stops = ("end_stop", "one_sided_stop", "buffered_stop", "constraint_stop")
    assert {BY_NAME["gains"].supports(by_name(name)).how for name in stops} == {"keep the reference away from the stop"}


@pytest.mark.parametrize("integrator", ["RK4", "Euler", "implicitfast"])
def test_the_callback_holds_at_rest_and_gives_the_constraint_back(integrator: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = effect_examples.model("coulomb_friction")
    for path, content in BY_NAME["mujoco"].files(Plan(saved(model), model), tmp_path / "rig.xml").items():
        path.write_bytes(content.replace(b'"RK4"', f'"{integrator}"'.encode()))
    read = mujoco.MjModel.from_xml_path(str(tmp_path / "rig.xml"))
    data = mujoco.MjData(read)
    callback = imported(tmp_path / "rig_callback.py")
    callback.install(read)
    try:
        data.ctrl[0] = 0.99 * model["coulomb_force"]
        mujoco.mj_step(read, data, 1000)
        assert read.dof_frictionloss[0] == 0.0 and abs(data.qpos[0]) < 1e-12
        data.qvel[0] = 0.05
        mujoco.mj_step(read, data, 1000)
        held = float(data.qpos[0])
        mujoco.mj_step(read, data, 1000)
        assert held > 1e-4 and abs(data.qpos[0] - held) < 1e-9
    finally:
        callback.remove()
    assert read.dof_frictionloss[0] == model["coulomb_force"]


def test_a_buffer_only_pushes_in_mujoco(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = effect_examples.model("buffered_stop")
    plan = Plan(saved(model), model, zero=ZERO)
    for path, content in BY_NAME["mujoco-xml"].files(plan, tmp_path / "rig.xml").items():
        path.write_bytes(content)
    read = mujoco.MjModel.from_xml_path(str(tmp_path / "rig.xml"))
    data = mujoco.MjData(read)
    stop = model.effect("buffered_stop")
    centre, reach, stiffness, damping = stop.values
    for depth, speed in ((-1e-4, 0.5), (1e-3, 0.2), (1e-3, -0.2), (1e-3, -0.4)):
        data.qpos[0], data.qvel[0] = ZERO + centre + reach + depth, speed
        mujoco.mj_forward(read, data)
        expected = max(stiffness * depth + damping * speed, 0.0) if depth > 0.0 else 0.0
        assert -data.qfrc_constraint[0] == pytest.approx(expected, rel=1e-3, abs=2e-3)


@pytest.mark.xdist_group("fmu")
@pytest.mark.parametrize(
    "effects",
    [("coulomb_friction", "actuator_lag", "end_stop"), ("hysteresis", "time_offset"), ("relaxing_spring",)],
)
def test_fmu_moves_alike(effects: tuple[str, ...], tmp_path: Path) -> None:
    record = effect_examples.record(1000.0, "zero", duration=0.5)
    model, target = effect_examples.model(*effects), BY_NAME["fmu"]
    plan = Plan(saved(model), model, zero=ZERO)
    out = tmp_path / "rig.fmu"
    for path, content in target.files(plan, out).items():
        path.write_bytes(content)
    got = target.replay(out, plan, InitialState(record, Initial(0.0, 0.0, ZERO)))
    ours = Simulator(model, record).positions(model.values) + ZERO
    assert np.sqrt(np.mean((got - ours) ** 2)) < 1e-3 * np.std(ours)


@pytest.mark.parametrize("start", [(0.02, 0.0), (-0.01, 0.2)])
@pytest.mark.parametrize("target", ["mujoco", "python", "fmu"])
def test_what_is_remembered_begins_where_the_motion_does(
    target: str, start: tuple[float, float], tmp_path: Path
) -> None:
    record, model = effect_examples.silent(1000.0, 0.5), effect_examples.model("hysteresis")
    one, plan = BY_NAME[target], Plan(saved(model), model, steps=2)
    out = tmp_path / f"rig{one.suffixes[0]}"
    for path, content in one.files(plan, out).items():
        path.write_bytes(content)
    got = one.replay(out, plan, InitialState(record, Initial(*start, 0.0)))
    ours = Simulator(model, record).positions(model.values, *start)
    assert np.sqrt(np.mean((got - ours) ** 2)) < 1e-4 * np.std(ours)


@pytest.mark.xdist_group("fmu")
@pytest.mark.parametrize(
    ("target", "slope", "sign"),
    [("mujoco", 0.0, 1), ("mujoco", 0.0, -1), ("mujoco", 0.05, 1), ("mujoco", 0.05, -1), ("python", 0.0, 1),
     ("fmu", 0.0, 1)],
)  # fmt: skip
def test_a_lagged_force_that_was_in_volts_begins_in_newtons(
    target: str, slope: float, sign: int, tmp_path: Path
) -> None:
    """Ten volts, which are twenty newtons, have acted for long on an actuator with a limit of five newtons."""
    time = np.arange(301) / 1000.0
    record = Record(time, 0.0 * time, np.array([-1.0, 0.1]), np.array([10.0, -10.0]), force_unit="V")
    model = effect_examples.plant() + by_name("actuator_lag")(0.05) + by_name("force_gain_nonlinearity")(slope, 5.0)
    plan = Plan(replace(saved(model), force_sign=sign), model, zero=ZERO, steps=4, force_scale=2.0)
    assert lagged(record, plan) == pytest.approx(5.0)
    one = BY_NAME[target]
    out = tmp_path / f"rig{one.suffixes[0]}"
    for path, content in one.files(plan, out).items():
        path.write_bytes(content)
    got = one.replay(out, plan, InitialState(record, Initial(0.0, 0.0, ZERO)))
    ours = Simulator(model, replace(record, force=2.0 * record.force)).positions(model.values) + ZERO
    assert np.sqrt(np.mean((got - ours) ** 2)) < 1e-3 * np.std(ours)


@pytest.mark.parametrize("target", ["mujoco", "python"])
def test_all_together(target: str, tmp_path: Path) -> None:
    """Eleven effects at once, a force that was turned, and a start in motion."""
    names = (
        "hysteresis", "actuator_lag", "time_offset", "force_gain_nonlinearity", "stribeck_friction", "sensor_drift",
        "end_stop", "stiffness_drift", "backlash", "second_mode", "force_offset",
    )  # fmt: skip
    model = effect_examples.model(*names)
    record: Record = effect_examples.record(1000.0, "zero", duration=0.6)
    plan = Plan(replace(saved(model), force_sign=-1), model, zero=ZERO, steps=4)
    one = BY_NAME[target]
    out = tmp_path / f"rig{one.suffixes[0]}"
    for path, content in one.files(plan, out).items():
        path.write_bytes(content)
    got = one.replay(out, plan, InitialState(record, Initial(0.004, 0.1, ZERO)))
    ours = Simulator(model, record).positions(model.values, 0.004, 0.1) + ZERO
    assert np.sqrt(np.mean((got - ours) ** 2)) < 5e-3 * np.std(ours)

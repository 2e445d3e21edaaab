"""identify: the demo rig's truth, measured data, other plants, and what it refuses."""

from __future__ import annotations

import io
import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from msd_ident.cli.results import jsonable
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError, UsageError
from msd_ident.features import response
from msd_ident.io import SourceOptions, read
from msd_ident.report import markdown, page
from msd_ident.report.tables import print_identification
from msd_ident.workflow.identification import Identification
from msd_ident.workflow.pipeline import Options, identify
from msd_sim.api import simulate

MASS, DAMPING, STIFFNESS, MU = 0.9407, 3.927, 694.1, 0.0133
COUNT = 1.0 / 226600.0


def record_of(spec: dict[str, object], name: str = "rig") -> Record:
    """A record of the simulated rig, without its truth."""
    data = simulate(spec)
    return Record(
        time=data.time, position=data.position, force_time=data.force_time, force=data.force, hold=data.hold, name=name
    )


@pytest.fixture(scope="module")
def demo() -> Identification:
    return identify([record_of({"rig": "ecp", "experiment": "paper", "seed": 7})])


def test_demo_rig_is_recovered_by_the_joint_refit(demo: Identification) -> None:
    found = demo.refined.parameters
    assert found["mass"].value == pytest.approx(MASS, rel=1e-3)
    assert found["stiffness"].value == pytest.approx(STIFFNESS, rel=1e-3)
    assert found["damping"].value == pytest.approx(DAMPING, rel=1e-2)
    assert found["friction_coefficient"].value == pytest.approx(MU, rel=1e-2)


def test_joint_refit_leaves_no_more_than_the_encoder_makes(demo: Identification) -> None:
    encoder = COUNT / math.sqrt(12.0)
    assert demo.noise_floor == pytest.approx(encoder, rel=0.1)
    assert demo.refined.see < 1.5 * encoder


def test_both_reductions_are_stated_and_the_joint_one_is_larger(demo: Identification) -> None:
    assert demo.paper_refined is not None
    assert demo.paper_refined.see <= demo.original.see
    expected = 100.0 * (demo.original.see - demo.refined.see) / demo.original.see
    assert demo.see_reduction_percent == pytest.approx(expected)
    assert demo.see_reduction_percent > demo.paper_see_reduction_percent >= 0.0
    kept = ("mass", "damping", "stiffness")
    assert all(demo.paper_refined.model[name] == demo.original.model[name] for name in kept)


def test_standard_form_agrees_with_the_physical_parameters_by_eqs_11_to_13(demo: Identification) -> None:
    form, physical = demo.two_peak_form, demo.original.parameters
    assert form is not None and form.static_gain is not None
    m, b, k = (physical[name].value for name in ("mass", "damping", "stiffness"))
    assert k == pytest.approx(1.0 / form.static_gain.value)
    assert math.sqrt(k / m) == pytest.approx(form.natural_frequency.value)
    assert b / (2.0 * math.sqrt(k * m)) == pytest.approx(form.damping_ratio.value)


def test_json_holds_the_contract_and_is_strict(demo: Identification) -> None:
    found = json.loads(json.dumps(jsonable(demo.to_json_dict()), allow_nan=False))
    assert found["schema"] == "msd.identification/1"
    for form in ("standard_form", "standard_form_two_peaks"):
        assert set(found[form]) == {"natural_frequency", "damping_ratio", "static_gain"}
    assert {"mass", "damping", "stiffness"} <= set(found["original"]["parameters"])
    assert {"value", "std", "unit"} == set(found["refined"]["parameters"]["coulomb_force"])
    assert found["refined"]["see_m"] == demo.refined.see
    assert found["see_reduction_percent"] == demo.see_reduction_percent
    assert found["noise_floor_m"] == demo.noise_floor


def test_predicted_curves_are_what_the_see_says(demo: Identification) -> None:
    for fit in (demo.original, demo.refined):
        rest = fit.predicted[0] - demo.records[0].position
        assert math.sqrt(float(rest @ rest) / (rest.size - 2)) == pytest.approx(fit.see, rel=1e-9)


def test_negative_gain_gives_the_same_plant_and_a_warning() -> None:
    record = record_of({"rig": "ecp", "experiment": "paper", "seed": 7})
    found = identify([replace(record, position=-record.position)])
    assert found.standard_form is not None and found.standard_form.static_gain is not None
    assert found.standard_form.static_gain.value < 0.0
    assert found.refined.parameters["mass"].value == pytest.approx(MASS, rel=1e-3)
    assert any("moves the encoder downwards" in sentence for sentence in found.warnings)


def test_two_records_together_tighten_the_intervals() -> None:
    # Without noise they would be one record twice.
    noisy = {"rig": "ecp", "experiment": "paper", "encoder": {"noise": 2e-6}}
    records = [record_of({**noisy, "seed": seed}, f"run {seed}") for seed in (1, 2)]
    alone, together = identify(records[:1]), identify(records)
    assert together.refined.parameters["mass"].std < alone.refined.parameters["mass"].std
    assert together.paper_refined is None and math.isnan(together.paper_see_reduction_percent)
    assert together.refined.parameters["mass"].value == pytest.approx(MASS, rel=1e-3)


def test_free_decay_gives_ratios_and_says_what_to_measure() -> None:
    record = record_of(
        {
            "mass": 2.0, "damping": 1.0, "stiffness": 800.0, "initial_position": 0.02,
            "time": np.arange(0.0, 6.0, 1e-3), "force_time": [0.0], "force": [0.0],
            "encoder": {"counts_per_metre": 226600.0},
        }
    )  # fmt: skip
    found = identify([record])
    assert found.refined.parameters["mass"].value == 1.0
    assert found.refined.parameters["stiffness"].value == pytest.approx(400.0, rel=1e-3)
    assert any("known only as ratios" in sentence and "weigh the moving mass" in sentence for sentence in found.open)


def test_axis_without_a_spring_is_seen() -> None:
    time = np.arange(0.0, 8.0, 1e-3)
    force = 8.0 * np.sign(np.sin(2.0 * np.pi * 0.7 * time)) + 3.0 * np.sin(2.0 * np.pi * 2.3 * time)
    record = record_of(
        {
            "mass": 3.0, "damping": 20.0, "stiffness": 0.0, "effects": {"coulomb_friction": {"coulomb_force": 1.5}},
            "time": time, "force_time": time, "force": force, "encoder": {"counts_per_metre": 1e6},
        }
    )  # fmt: skip
    found = identify([record])
    assert found.features[0].kind == "none" and found.standard_form is None
    assert found.refined.model["stiffness"] == 0.0
    assert found.refined.parameters["mass"].value == pytest.approx(3.0, rel=0.01)
    assert found.refined.parameters["coulomb_force"].value == pytest.approx(1.5, rel=0.02)


def test_telling_the_model_overrides_what_the_data_seems_to_say() -> None:
    record = record_of({"rig": "ecp", "experiment": "paper", "seed": 7}).window(0.0, 0.1)
    assert identify([record], Options(model="no_spring")).refined.model["stiffness"] == 0.0


def test_unknown_words_in_options_are_refused() -> None:
    with pytest.raises(UsageError, match="model is 'springy'; expected one of auto, spring, no_spring"):
        Options(model="springy")


def test_records_in_different_units_are_refused() -> None:
    record = record_of({"rig": "ecp", "experiment": "paper", "seed": 7})
    with pytest.raises(UsageError, match="expected one pair of units"):
        identify([record, replace(record, force_unit="V")])


def test_no_records_are_refused() -> None:
    with pytest.raises(UsageError, match="no records to identify; expected at least one"):
        identify([])


def test_signal_that_never_moves_is_refused_in_one_line() -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    with pytest.raises(DataError) as refusal:
        identify([from_samples(time, np.where(time > 1, 1.0, 0.0), np.full(time.size, 0.25))])
    assert "\n" not in str(refusal.value)
    assert "the position never changes (0.25 m in all 2000 samples): check the encoder" in str(refusal.value)


ECP = SourceOptions(
    force="control_effort_v", force_unit="V", position="encoder_counts", position_scale=1 / 56000, position_unit="m"
)


def test_measured_steps_know_m_and_k_only_up_to_newtons_per_volt(shared_data: Path) -> None:
    found = identify([read(shared_data / "ecp210/step_1.csv", ECP)])
    assert found.standard_form is not None and all(q.known for q in found.standard_form.quantities.values())
    assert any("gain in newtons is unknown" in s and "mass" in s and "stiffness" in s for s in found.open)
    assert found.refined.parameters["mass"].unit == "V·s²/m"
    assert found.refined.parameters["coulomb_force"].low > 0.0
    assert len(found.features[0].responses) == 2


def test_measured_axis_agrees_with_the_published_values(shared_data: Path) -> None:
    found = identify([read(shared_data / "emps/emps_train.csv", SourceOptions())])
    values = found.refined.parameters
    assert found.refined.model["stiffness"] == 0.0
    assert values["mass"].value == pytest.approx(95.1089, rel=0.06)
    assert values["damping"].value == pytest.approx(203.5034, rel=0.12)
    assert values["coulomb_force"].value == pytest.approx(20.3935, rel=0.15)
    assert values["offset_force"].value == pytest.approx(-3.1648, rel=0.15)
    rest = found.refined.predicted[0] - found.records[0].position
    assert math.sqrt(float(np.mean(rest**2))) <= 2.6e-3


def creeping() -> Record:
    """A lag of first order: no reading shows its inertia."""
    time = np.arange(0.0, 8.0, 5e-3)
    after = [np.maximum(time - at, 0.0) for at in (1.0, 4.5)]
    noise = 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    force = np.where((time > 1.0) & (time < 4.5), 0.3, 0.0)
    return from_samples(time, force, 0.03 * (np.exp(-after[1]) - np.exp(-after[0])) + noise)


def test_a_plant_whose_inertia_no_reading_shows_is_fitted() -> None:
    found = identify([creeping()])
    assert found.standard_form is None
    assert found.refined.parameters["stiffness"].value == pytest.approx(10.0, rel=0.01)
    assert found.refined.parameters["damping"].value == pytest.approx(10.0, rel=0.01)


def test_an_original_model_that_runs_away_leaves_the_reduction_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(response, "_believable", lambda *_: True)
    found = identify([creeping()])
    assert found.standard_form is not None and found.standard_form.natural_frequency.value > 1e6
    assert found.paper_refined is None and math.isfinite(found.refined.see)
    assert any("has no finite error" in sentence for sentence in found.warnings)
    told = json.loads(json.dumps(jsonable(found.to_json_dict()), allow_nan=False))
    assert told["see_reduction_percent"] is None and told["original"]["see_m"] is None
    console = Console(file=io.StringIO(), width=80)
    print_identification(found, console)
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    read = re.sub(r"<script.*?</script>", "", page.render([found]), flags=re.DOTALL)  # plotly's own text
    for text in (shown, read, markdown.render([found])):
        assert not re.search(r"\b(nan|NaN)\b", text)
    assert re.search(r"SEE reduction +– +– ", shown)

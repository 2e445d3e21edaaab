"""A saved model on another record: what it explains, what it says where it does not, what it refuses."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from badinputs import run

import msd_ident
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError, UsageError
from msd_ident.estimate import fit
from msd_ident.io import SourceOptions, read, write_csv
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.effects import by_name
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.report import page
from msd_ident.workflow import pipeline, saved_model, validation
from msd_ident.workflow.known_parameters import Known

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs" / "generate"))
import json_contract  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
RIG = Plant(mass=0.9, damping=3.0, stiffness=700.0) + CoulombFriction(0.1)
NOISE = 2e-6


def record(model: Model = RIG, height: float = 5.0, zero: float = 0.0, seed: int = 1) -> Record:
    """Three steps of the force, by the model."""
    time = np.arange(4000) * 1e-3
    force = np.select([time < 0.3, time < 1.5, time < 2.7], [0.0, height, -height], 0.5 * height)
    asked = from_samples(time, force, np.zeros(4000), name=f"record {seed}")
    noise = np.random.default_rng(seed).normal(0.0, NOISE, 4000)
    return replace(asked, position=simulate(model, asked).position + zero + noise)


def result(*records: Record) -> dict[str, Any]:
    """What ``msd identify`` writes about the records, through JSON."""
    found = pipeline.identify(list(records) or [record()])
    told: dict[str, Any] = json.loads(json.dumps({"path": "own.csv", **found.to_json_dict()}))
    return told


@pytest.fixture(scope="module")
def told() -> dict[str, Any]:
    return result()


@pytest.mark.xdist_group("validation")
def test_the_right_model_reaches_the_noise_on_another_record(told: dict[str, Any]) -> None:
    found = validation.validate(saved_model.from_json_dict(told), [record(height=9.0, seed=2)])
    assert found.see == pytest.approx(NOISE, rel=0.1)
    assert found.adequacy.consistent and found.missing == () and found.missing_size == 0.0
    assert found.explained_percent > 99.999
    assert found.refitted == ("initial position", "initial velocity")
    assert found.warnings == ()


@pytest.mark.xdist_group("validation")
def test_a_rig_that_has_changed_is_seen(told: dict[str, Any]) -> None:
    changed = record(RIG + QuadraticDrag(20.0), height=9.0, seed=2)
    found = validation.validate(saved_model.from_json_dict(told), [changed])
    assert not found.adequacy.consistent and found.see > 20.0 * NOISE
    speed = np.concatenate([part.velocity for part in found.missing])
    lacking = np.concatenate([part.force for part in found.missing])
    assert np.corrcoef(lacking, speed * np.abs(speed))[0, 1] > 0.7, "the missing force is the drag"


@pytest.mark.xdist_group("validation")
def test_nothing_but_the_start_is_refitted(told: dict[str, Any]) -> None:
    heavier = record(Plant(1.2, 3.0, 700.0) + CoulombFriction(0.1), seed=2)
    found = validation.validate(saved_model.from_json_dict(told), [heavier])
    assert found.saved.model["mass"] == pytest.approx(0.9, rel=1e-3)
    assert found.explained_percent < 97.0


@pytest.mark.xdist_group("validation")
def test_a_moved_zero_is_told_and_refitted_on_demand(told: dict[str, Any]) -> None:
    model, moved = saved_model.from_json_dict(told), record(zero=0.01, seed=2)
    kept = validation.validate(model, [moved])
    said = "The encoder's zero has moved since the model's own record (record 2 by about 0.01 m): use --refit-zero."
    assert said in kept.warnings
    assert kept.see == pytest.approx(0.01, rel=0.05)
    refitted = validation.validate(model, [moved], validation.Options(refit_zero=True))
    assert refitted.see == pytest.approx(NOISE, rel=0.1)
    assert refitted.initial[0].zero == pytest.approx(0.01, abs=1e-5)
    assert refitted.refitted[-1] == "zero" and refitted.warnings == ()


def test_the_sign_of_the_force_is_the_results() -> None:
    turned = replace(record(), force=-record().force)
    told = result(turned)
    model = saved_model.from_json_dict(told)
    assert told["force_sign"] == model.force_sign == -1
    other = record(height=9.0, seed=2)
    assert validation.validate(model, [replace(other, force=-other.force)]).see == pytest.approx(NOISE, rel=0.1)
    wired = validation.validate(model, [other])
    assert any(
        "moves the encoder in the other direction than on the model's own record" in said for said in wired.warnings
    )
    assert wired.explained_percent < 0.0
    del told["force_sign"]
    assert saved_model.from_json_dict(told).force_sign == -1, "older results tell it in a warning"


def test_a_diagnosis_is_read_back_and_says_what_became_of_the_missing_force() -> None:
    dragged = RIG.without("coulomb_friction") + QuadraticDrag(15.0)
    told = json.loads(json.dumps(pipeline.diagnose([record(dragged)]).to_json_dict(), default=float))
    model = saved_model.from_json_dict(told)
    assert model.causes == ("quadratic_drag",) and model.model["drag_coefficient"] == pytest.approx(15.0, rel=0.05)
    same = validation.validate(model, [record(dragged, height=8.0, seed=2)])
    assert set(same.states.values()) == {"gone"}
    rubbing = validation.validate(model, [record(dragged + CoulombFriction(0.4), height=8.0, seed=2)])
    assert "still there" in rubbing.states.values()


def test_every_effect_with_its_limits_comes_back() -> None:
    values = {"force_gain_slope": 0.01, "force_limit": np.inf}
    gain = by_name("force_gain_nonlinearity")
    model = Plant(1.0, 1.0, 100.0) + gain.from_values({p.name: values.get(p.name, 0.01) for p in gain.parameters})
    quantities = {p.name: {"value": None if np.isinf(v) else v, "std": None, "unit": p.unit} for p, v in
                  zip(model.parameters, model.values.tolist(), strict=True)}  # fmt: skip
    told = {
        "schema": "msd.diagnosis/2", "base": {}, "extended": {"parameters": quantities, "see_m": 1.0, "new": 1},
        "causes": [{"name": gain.name}], "data": [{"force_unit": "N", "position_unit": "m"}], "newer": {},
    }  # fmt: skip
    np.testing.assert_array_equal(saved_model.from_json_dict(told).model.values, model.values)


def test_older_results_are_read_by_their_parameters(told: dict[str, Any]) -> None:
    old = {key: value for key, value in told.items() if key not in ("effects", "force_sign", "initial", "known")}
    model = saved_model.from_json_dict(old)
    assert model.model.effect_names == ("coulomb_friction",) and model.zeros == ()
    found = validation.validate(model, [record(zero=0.01, seed=2)])
    assert found.see == pytest.approx(NOISE, rel=0.1)
    assert "The saved result does not contain the encoder's zero, so it was fitted too." in found.warnings


def test_a_file_is_loaded(told: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text(json.dumps(told, indent=1), encoding="utf-8")
    assert msd_ident.load(path).parameters["mass"].unit == "kg"
    line = json.dumps(told)
    path.write_text(f"{line}\n{line}\n", encoding="utf-8")
    assert len(saved_model.load_all(path)) == 2
    with pytest.raises(UsageError, match="holds 2 results; expected one: say which with --line 1 to 2"):
        msd_ident.load(path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty; expected a result that msd identify or msd diagnose wrote with --json"),
        (
            "time_s,force_n\n0,1\n",
            "line 1 is no JSON object; expected a result that msd identify or msd diagnose wrote",
        ),
        ('{"schema": "msd.info/1"}', "is of schema msd.info/1; expected msd.identification/1 or msd.diagnosis/1 or"),
        ('{"schema": "msd.diagnosis/0"}', "renew it with msd diagnose PATH --json FILE"),
        ('{"a": 1}', "names no schema; expected"),
        ('{"path": "x", "error": "no force"}', "holds no model but an error (no force); expected"),
        ('{"schema": "msd.identification/1"}', "lacks what a simulation needs ('refined'); expected all keys of"),
    ],
)
def test_what_is_no_result_is_refused(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DataError) as refused:
        msd_ident.load(path)
    assert words in str(refused.value) and "\n" not in str(refused.value)
    with pytest.raises(DataError, match="cannot read .*nothing.json: No such file or directory; expected a result"):
        msd_ident.load(tmp_path / "nothing.json")


@pytest.mark.xdist_group("validation")
@pytest.mark.parametrize("value", [None, float("nan"), float("inf")])
@pytest.mark.parametrize("name", ["zero_m", "coulomb_force"])
def test_a_number_that_is_missing_is_not_taken_for_an_infinite_one(
    name: str, value: float | None, told: dict[str, Any]
) -> None:
    broken = json.loads(json.dumps(told))
    place = broken["initial"][0] if name == "zero_m" else broken["refined"]["parameters"]["coulomb_force"]
    place[name if name == "zero_m" else "value"] = value
    with pytest.raises(DataError, match=rf"lacks what a simulation needs \(.*{name}.*\); expected .*: renew it with"):
        saved_model.from_json_dict(broken)


@pytest.mark.xdist_group("validation")
@pytest.mark.parametrize(
    ("place", "words"),
    [
        (("refined", "parameters", "mass", "value"), "mass has 400 digits, beyond 1e+18"),
        (("refined", "parameters", "mass", "std"), "the std of mass has 400 digits"),
        (("original", "parameters", "damping", "value"), "damping has 400 digits"),
        (("initial", 0, "zero_m"), "zero_m has 400 digits"),
        (("data", 0, "force_lead_s"), "force_lead_s has 400 digits"),
        (("data", 0, "origin_s"), "origin_s has 400 digits"),
        (("noise_floor_m",), "noise_floor_m has 400 digits"),
    ],
)
def test_a_whole_number_that_no_computer_can_use_is_refused(
    place: tuple[str | int, ...], words: str, told: dict[str, Any], tmp_path: Path
) -> None:
    broken = json.loads(json.dumps(told))
    inner = broken
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = -(10**399)
    path = tmp_path / "model.json"
    path.write_text(json.dumps(broken), encoding="utf-8")
    found = run("validate", path, tmp_path / "other.csv")
    assert found.code == 2 and found.err.count("\n") == 1
    assert f"{path} lacks what a simulation needs ({words}" in found.err and "renew it with msd identify" in found.err


@pytest.mark.xdist_group("validation")
@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("value", "0.8", 'mass is "0.8", which is no number'),
        ("value", True, "mass is true, which is no number"),
        ("std", "small", 'the std of mass is "small", which is no number'),
        ("std", -1.0, "the std of mass is -1, below 0"),
    ],
)
def test_a_word_or_a_negative_spread_in_the_place_of_a_number_is_refused(
    key: str, value: object, words: str, told: dict[str, Any]
) -> None:
    broken = json.loads(json.dumps(told))
    broken["refined"]["parameters"]["mass"][key] = value
    with pytest.raises(DataError) as refused:
        saved_model.from_json_dict(broken)
    assert f"lacks what a simulation needs ({words})" in str(refused.value)


@pytest.mark.xdist_group("validation")
def test_a_result_that_an_editor_marked_as_unicode_is_read(told: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text(json.dumps(told), encoding="utf-8-sig")
    assert msd_ident.load(path).model == saved_model.from_json_dict(told).model


def test_other_units_and_demands_that_make_no_sense_are_refused(told: dict[str, Any]) -> None:
    model = saved_model.from_json_dict(told)
    with pytest.raises(
        UsageError, match="record 1 is in V and m; expected N and m, the units of the model: give --forc"
    ):
        validation.validate(model, [replace(record(), force_unit="V")])
    with pytest.raises(UsageError, match="no records to validate the model on; expected at least one"):
        validation.validate(model, [])
    with pytest.raises(UsageError, match="the required part is 120 %; expected 0 to 100, e.g. --require 99"):
        validation.Options(require=120.0)


@pytest.mark.xdist_group("validation")
def test_the_command(told: dict[str, Any], tmp_path: Path) -> None:
    model, other, report = tmp_path / "model.json", tmp_path / "other.csv", tmp_path / "trial.html"
    model.write_text(json.dumps(told), encoding="utf-8")
    write_csv(record(RIG + QuadraticDrag(100.0), height=9.0, seed=2), other)
    found = run("validate", model, other, "--require", "99.99", "--report", report, "--json", tmp_path / "out.json")
    assert found.code == 1
    assert "99.99 % are required, which is not met." in " ".join(found.out.split())
    told_here = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert told_here["schema"] == "msd.validation/1" and not told_here["met"]
    assert "saved model" in report.read_text(encoding="utf-8")
    assert run("validate", model, other, "--require", "50", "--quiet").code == 0
    third = run("validate", model, other, "--line", "3")
    assert f"{model} holds 1 results; expected one with number 3: give another --line" in third.err
    assert run("validate", model, tmp_path / "no.csv", "--require", "50").code == 2


@pytest.mark.xdist_group("validation")
def test_on_tries_the_model_that_was_just_found(tmp_path: Path) -> None:
    own, other = tmp_path / "own.csv", tmp_path / "other.csv"
    write_csv(record(), own)
    write_csv(record(height=9.0, seed=2), other)
    found = run("identify", own, "--on", other, "--json", "-")
    (trial,) = json.loads(found.out)["validations"]
    assert (trial["schema"], trial["path"]) == ("msd.validation/1", str(other))
    assert trial["see_m"] == pytest.approx(NOISE, rel=0.1)
    assert "validations" not in json.loads(run("identify", own, "--json", "-").out)
    assert "The model explains 99.99" in run("identify", own, "--on", other).out
    bad = run("identify", own, "--on", tmp_path / "no.csv", "--json", "-")
    assert bad.code == 2 and "no.csv does not exist" in bad.err and json.loads(bad.out)["refined"]


@pytest.mark.xdist_group("validation")
def test_every_key_is_documented_and_there(told: dict[str, Any]) -> None:
    model = replace(saved_model.from_json_dict(told), base_depends_on={"velocity": 0.9})
    lacking = record(RIG + QuadraticDrag(100.0), height=9.0, seed=2)
    found = validation.validate(model, [lacking]).to_json_dict()
    found |= {"path": "x", "warnings": ["…"], "findings": [{"severity": "info", "code": "x", "sentence": "…"}]}
    contract = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
    assert json_contract.documented(contract, "msd.validation/1") == set(json_contract.paths(found))


@pytest.mark.xdist_group("validation")
def test_the_page_shows_both_and_its_numbers_are_the_jsons(told: dict[str, Any]) -> None:
    found = validation.validate(saved_model.from_json_dict(told), [record(height=9.0, seed=2)])
    article = page.article(found)
    motion = article.plots[0].panels[1]
    assert [series.name for series in motion.series] == ["measured", "saved model"]
    text = page.render([found])
    assert f'<data value="{found.see!r}" data-key="see_m">' in text
    assert f'<data value="{found.explained_percent!r}" data-key="explained_percent">' in text


def test_silverbox_on_another_part_of_itself(shared_data: Path) -> None:
    path = shared_data / "real" / "silverbox_multisine.csv"
    if not path.exists():
        pytest.skip(f"no {path}")
    whole = read(path, SourceOptions("V1", "V2", force_unit="V", position_unit="V", hold="band_limited"))
    base = Plant(5e-6, 2e-4, 1.0) + by_name("cubic_spring").from_values({"cubic_stiffness": 3.0})
    fitted = fit(
        base + by_name("force_offset").from_values({"offset_force": 0.0}), whole.window(0.0, 6.0), zero="known"
    )
    told = {
        "schema": "msd.diagnosis/1", "data": [{"force_unit": "V", "position_unit": "V"}], "initial": [{"zero_m": 0.0}],
        "causes": [{"name": "cubic_spring"}, {"name": "force_offset"}],
        "extended": {"see_m": fitted.see, "parameters": {n: vars(q) for n, q in fitted.quantities.items()}},
    }  # fmt: skip
    found = validation.validate(saved_model.from_json_dict(told), [whole.window(7.0, 14.0)])
    assert found.see < 0.6e-3


@pytest.mark.xdist_group("validation")
def test_a_drift_goes_on_in_a_later_part_of_the_same_record(told: dict[str, Any]) -> None:
    """A model from one part of a file, tested on the next part; of another file nobody knows when the drift began."""
    drifting = RIG + by_name("stiffness_drift").from_values({"stiffness_drift_rate": 0.02})
    own = record(drifting)
    saved = replace(saved_model.from_json_dict(told), model=drifting, origins={"record 1": 0.0})
    later = own.cut(1.5, 4.0)
    assert validation.validate(saved, [later]).see == pytest.approx(NOISE, rel=0.1)
    said = validation.as_saved(saved, [later]).warnings
    assert said and said[-1].endswith(
        "count the time from 0 s there, not from 1.5 s; rename it if it is another recording."
    )
    assert said[-1] not in validation.as_saved(replace(saved, model=RIG), [later]).warnings
    assert validation.validate(saved, [replace(later, name="another")]).see > 20.0 * NOISE
    assert saved_model.from_json_dict(told).origins == {"record 1": 0.0}


def release(start: float, seed: int = 1) -> Record:
    """The rig let go at ``start`` [m], without a force."""
    time = np.arange(3000) * 1e-3
    asked = from_samples(time, np.zeros(3000), np.zeros(3000), name=f"release {seed}")
    noise = np.random.default_rng(seed).normal(0.0, NOISE, 3000)
    return replace(asked, position=simulate(RIG, asked, start).position + noise)


@pytest.fixture(scope="module")
def ratios() -> dict[str, Any]:
    return result(release(0.02))


@pytest.mark.xdist_group("validation")
def test_a_model_that_knows_only_ratios_is_refused_on_a_driven_record(ratios: dict[str, Any], tmp_path: Path) -> None:
    said = (
        "a force drives record 1, and in the model's own record no force moved the cart, so only ratios are known (its "
        "mass of 1 kg is assumed); expected a force scale: identify again with the moving mass, --mass, or validate on "
    )
    model = saved_model.from_json_dict(ratios)
    assert model.scale_assumed
    for records in ([record()], [release(0.015, seed=2), record()]):
        with pytest.raises(UsageError) as refused:
            validation.validate(model, records)
        assert said in str(refused.value)
    own, other = tmp_path / "own.csv", tmp_path / "other.csv"
    write_csv(release(0.02), own)
    write_csv(record(), other)
    found = run("identify", own, "--on", other, "--quiet")
    assert found.code == 2 and said.replace("record 1", "other.csv") in found.err


@pytest.mark.xdist_group("validation")
def test_a_model_that_knows_only_ratios_goes_on_on_a_free_decay(ratios: dict[str, Any]) -> None:
    model, other = saved_model.from_json_dict(ratios), release(0.015, seed=2)
    assert validation.validate(model, [other]).see == pytest.approx(NOISE, rel=0.1)
    held = replace(other, force=np.full(other.samples, 0.5))
    assert validation.validate(model, [held], validation.Options(refit_zero=True)).explained_percent > 99.99
    weighed = pipeline.identify([release(0.02)], pipeline.Options(known=(Known("mass", 0.9),))).to_json_dict()
    scaled = saved_model.from_json_dict({"path": "own.csv", **weighed})
    assert validation.validate(scaled, [record()]).explained_percent > 99.9

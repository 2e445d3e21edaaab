"""How a force goes on between its samples: the true hold is found, on rigs whose model is incomplete too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import chirp

from msd_ident.data.record import Record, from_samples
from msd_ident.data.resampling import band_limited
from msd_ident.errors import DataError, UsageError
from msd_ident.estimate import fit
from msd_ident.io import SourceOptions, read, write_csv
from msd_ident.model import Model, Plant, simulate
from msd_ident.model.base_model import DryFriction
from msd_ident.model.effects import by_name
from msd_ident.workflow import pipeline
from msd_ident.workflow.force_hold import choose_hold, is_open, stands_for_a_hold, with_hold
from msd_ident.workflow.preparation import prepare
from msd_ident.workflow.starting_plant import typical_plant
from msd_sim import api

#: Fine steps per sample, and sampling period [s]: eight samples an oscillation.
FINE, PERIOD = 16, 0.02
RIG = Plant(mass=1.0, damping=1.0, stiffness=1500.0)
CUBIC = RIG + by_name("cubic_spring").from_values({"cubic_stiffness": 3e5})


@cache
def measured(hold: str, model: Model = RIG, samples: int = 600, noise: float = 1e-6) -> Record:
    """A rig under a random force up to 0.8 of the Nyquist frequency, of which only the samples are told."""
    rng = np.random.default_rng(7)
    time = PERIOD / FINE * np.arange(samples * FINE)
    count = samples // 2 * 8 // 10
    phase = rng.uniform(0.0, 2.0 * np.pi, count)
    rate = np.arange(1, count + 1) / (samples * PERIOD)
    fine = 2.0 / np.sqrt(count) * np.cos(2.0 * np.pi * np.outer(time, rate) + phase).sum(axis=1)
    kept = slice(None, None, FINE)
    if hold != "band_limited":
        told = from_samples(time[kept], fine[kept], np.zeros(samples), hold="linear" if hold == "linear" else "zero")
        fine = told.force_at(time)
    truth = from_samples(time, fine, np.zeros(time.size), hold="linear")
    if hold == "zero":
        truth = replace(truth, force_time=time[kept], force=fine[kept], hold="zero")
    position = simulate(model, truth).position[kept] + rng.normal(0.0, noise, samples)
    return replace(from_samples(time[kept], fine[kept], position), hold_known=False)


@pytest.mark.parametrize("hold", ["zero", "linear", "band_limited"])
@pytest.mark.parametrize("model", [RIG, CUBIC], ids=["complete", "cubic spring missing"])
def test_the_true_hold_is_found(hold: str, model: Model) -> None:
    choice = choose_hold([measured(hold, model)], RIG)
    assert choice.hold == hold and not choice.tied, choice
    word = hold.replace("zero", "held").replace("_", "-")
    assert choice.sentence.startswith(
        f"Between its samples the force is assumed to be {word}: the log-likelihood ratio"
    )


def test_a_slow_ramp_that_is_held_is_not_taken_for_a_smooth_force() -> None:
    """Its first samples hardly move: with one hold the cart counted as at rest, with the others not."""
    time = np.arange(4000) / 250.0
    force = np.interp(time, [0.0, 4.0, 12.0, 16.0], [0.0, 7.0, -7.0, 0.0])
    still = from_samples(time, force, np.zeros(time.size))
    plant = Plant(0.379, 1.04, 408.0)
    noise = 2e-6 * np.random.default_rng(1).normal(size=time.size)
    record = replace(still, position=simulate(plant, still).position + noise)
    assert choose_hold([record], plant).hold == "zero"
    assert fit(plant, record).see < 1.05 * 2e-6


def test_dry_friction_does_not_hide_the_hold() -> None:
    """With a plain plant alone, what friction leaves speaks for the wrong hold by 61 nats."""
    time = np.arange(5000) / 500.0
    force = 12.0 * chirp(time, 1.7, 10.0, 14.6, method="logarithmic", phi=-90)
    rig = Plant(1.65, 6.38, 2228.0) + DryFriction(1.73) + by_name("actuator_lag").from_values({"lag_time": 5.6e-4})
    still = from_samples(time, force, np.zeros(time.size))
    noise = 4.5e-5 * np.random.default_rng(3).normal(size=time.size)
    record = replace(still, position=simulate(rig, still).position + noise, hold_known=False)
    choice = choose_hold([record], typical_plant(record))
    assert choice.hold == "zero" and not choice.tied, choice


def test_a_wrong_hold_spoils_the_fit_and_the_right_one_reaches_the_noise() -> None:
    record = measured("band_limited", CUBIC)
    left = {hold: fit(CUBIC, with_hold(record, hold), search="near").see for hold in ("zero", "linear", "band_limited")}
    assert 10.0 * left["band_limited"] < left["linear"] < 0.6 * left["zero"], left


def test_what_the_data_does_not_tell_is_said_and_the_simplest_is_taken() -> None:
    choice = choose_hold([measured("linear", noise=2e-2)], RIG)
    assert choice.hold == "zero"
    assert choice.tied == ("linear", "band_limited")
    assert "(this data does not distinguish that from linear or band-limited); if you know it, use" in choice.sentence


def test_only_a_dense_force_of_unknown_hold_is_asked() -> None:
    record = measured("zero")
    steps = np.where(record.time > 5.0, 1.0, 0.0)
    assert is_open(record)
    assert not is_open(replace(record, hold_known=True))
    assert not is_open(replace(record, force=steps)), "a force that seldom changes is a command"
    assert not is_open(replace(record, force_time=record.time + 0.01)), "a force with stamps of its own is a topic's"


def test_a_force_that_changes_gradually_is_asked_however_seldom() -> None:
    """A hammer's blow, ramps between plateaus: they were taken as held, and half a sample of delay for a cause."""
    record = measured("zero")
    blow = np.where(abs(record.time - 5.0) < 0.05, np.cos(10.0 * np.pi * (record.time - 5.0)), 0.0)
    ramps = np.interp(record.time, [5.0, 5.1, 9.0, 9.1], [0.0, 1.0, 1.0, 0.0])
    command = np.repeat(np.sin(np.arange(record.samples // 20)), 20)
    for force, asked in ((blow, True), (ramps, True), (command, False)):
        assert is_open(replace(record, force=force)) == asked


def test_a_force_that_fades_to_nothing_is_no_reason_to_refuse_the_record(tmp_path: Path) -> None:
    """A filter leaves 1e-200 N of what was or will be; a stretch with nothing else was refused as out of scale."""
    record = measured("zero")
    force = record.force * np.exp(-np.maximum(5.0 - record.time, 0.0) * 100.0)
    quiet = replace(record, force=force).window(0.0, 0.4)
    assert np.all(quiet.force == 0.0)
    assert np.any(replace(record, force=force).window(0.0, 6.0).force != 0.0)


def test_a_table_is_asked_and_the_answer_stands_in_the_result(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    write_csv(measured("band_limited", samples=1200), path)
    found = pipeline.identify([read(path)])
    told = found.to_json_dict()
    assert found.refined.parameters["mass"].value == pytest.approx(1.0, rel=2e-3)
    assert [finding["severity"] for finding in told["findings"] if finding["code"] == "force_hold"] == ["warning"]
    assert any("assumed to be band-limited" in sentence for sentence in told["warnings"])
    assert told["data"][0]["force_hold"] == "band_limited"
    assert told["data"][0]["force_samples"] == 1200


def test_an_option_ends_the_question(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    write_csv(measured("band_limited"), path)
    for hold in ("zero", "linear", "band_limited"):
        record = read(path, SourceOptions(hold=hold))  # type: ignore[arg-type]
        data = prepare([record])
        assert not [finding for finding in data.findings if finding.code == "force_hold"]
        assert (data.records[0].upsampled > 1) == (hold == "band_limited")
        assert data.records[0].hold == ("zero" if hold == "zero" else "linear")
    with pytest.raises(UsageError, match="hold is 'cubic'; expected one of auto, zero, linear, band_limited"):
        SourceOptions(hold="cubic")  # type: ignore[arg-type]


def test_a_held_force_is_only_noted(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    write_csv(measured("zero"), path)
    data = prepare([read(path)])
    assert [finding.severity for finding in data.findings if finding.code == "force_hold"] == ["info"]
    assert not any("assumed to be held" in sentence for sentence in data.warnings)


def test_an_interpolated_force_has_the_impulse_of_the_smooth_one() -> None:
    """Over each interval of the samples, at two fifths of the Nyquist frequency and not near the ends."""
    time, rate = np.arange(400) * 0.01, 2 * np.pi * 20.0
    dense = band_limited(from_samples(time, np.sin(rate * time), np.cos(time)))
    middle = 0.5 * (dense.force[1:] + dense.force[:-1]) * np.diff(dense.force_time)
    found = middle.reshape(-1, dense.upsampled).sum(axis=1)[50:-50]
    true = -np.diff(np.cos(rate * time))[50:-50] / rate
    np.testing.assert_allclose(found, true, atol=1e-3 * float(np.max(np.abs(true))))
    assert dense.force_time[-1] == time[-1]


def test_an_uneven_force_is_not_interpolated() -> None:
    time = np.delete(np.arange(400) * 0.01, [50])
    with pytest.raises(DataError, match="399 samples that are not evenly spaced; expected at least 20 even ones"):
        band_limited(from_samples(time, np.sin(time), np.cos(time)))


@pytest.mark.parametrize(
    ("file", "source", "hold"),
    [
        ("silverbox_multisine.csv", SourceOptions("V1", "V2", force_unit="V", position_unit="V"), "band_limited"),
        ("boucwen_train.csv", SourceOptions(), "linear"),
        (
            "ecp2023_closed_loop.csv",
            SourceOptions("effort_v", "encoder", force_unit="V", position_scale=1.7857e-5),
            "zero",
        ),
    ],
)
def test_measured_records(file: str, source: SourceOptions, hold: str, shared_data: Path) -> None:
    path = shared_data / "real" / file
    if not path.exists():
        pytest.skip(f"no {path}")
    record = read(path, source)
    assert choose_hold([record], Plant(1e-5 if hold == "band_limited" else 1.0, 1e-4, 1.0)).hold == hold


def swept_with_a_peak() -> Record:
    """A sweep that is held, as a file has it, on a rig whose friction falls from five times to once Coulomb's."""
    made = api.simulate(
        {"mass": 1.906, "damping": 2.72, "stiffness": 1609.6, "friction_coefficient": 0.0, "rate": 500.0, "seed": 3,
         "effects": {"stribeck_friction": {"coulomb_force": 0.488, "static_force": 2.41, "stribeck_velocity": 0.127}},
         "experiment": {"name": "sweep", "force": 6.0, "duration": 8.3, "rate": 500.0, "natural_frequency": 29.06},
         "encoder": {"counts_per_metre": 4e5, "noise": 2e-6}}
    )  # fmt: skip
    place = np.searchsorted(made.force_time, made.time + 1e-9, side="right") - 1
    record = from_samples(made.time, made.force[np.maximum(place, 0)], made.position)
    return replace(record, hold_known=False)


def test_a_hold_that_a_missing_law_hides_is_decided_again_with_that_law(asking_about: Callable[..., None]) -> None:
    """Otherwise a delay of half a sample is certain: it makes up for the wrong hold."""
    asking_about("coulomb_friction", "stribeck_friction", "time_offset")
    record = swept_with_a_peak()
    assert [one.hold for one in prepare([record]).records] == ["linear"], "with plant and dry friction alone"
    found = pipeline.diagnose([record])
    assert [cause.name for cause in found.causes] == ["stribeck_friction"] and found.verdict == "explained"
    (said,) = [one for one in found.findings if one.code == "force_hold"]
    assert "assumed to be held" in said.sentence and said.severity == "info"
    assert not [one for one in found.warnings if "Between its samples" in one]


def test_a_delay_of_half_a_sample_stands_for_a_hold_and_another_does_not() -> None:
    record = measured("zero")
    for delay, stands in ((0.5, True), (-0.5, True), (0.52, True), (0.4, False), (1.0, False)):
        model = RIG + by_name("time_offset").from_values({"time_offset": delay * PERIOD})
        assert stands_for_a_hold(model, [record]) is stands
    assert not stands_for_a_hold(RIG, [record])

"""A small, seeded part of the recovery and coverage studies in ``bench``."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from msd_ident.estimate import fit
from msd_ident.model import Plant
from msd_ident.model.effects import LIBRARY, by_name

#: Causes whose law the rig has in another form, so that the study does not draw them; the variants do.
NOT_DRAWN = (
    "bilinear_spring", "direction_dependent_damping", "drive_damping", "frame_compliance", "gain_drift",
    "gravity",
    "load_dependent_friction",
    "position_dependent_damping", "position_dependent_gain", "position_dependent_inertia",
    "relaxing_spring", "scale_drift",
    "sensor_eccentricity", "sensor_nonlinearity",
)  # fmt: skip


def _study(repository: Path, name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, repository / "bench" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    "effect", [effect.name for effect in LIBRARY if not effect.form_of and effect.name not in NOT_DRAWN]
)
def test_every_effect_is_found_again(effect: str, repository: Path) -> None:
    one = _study(repository, "study_recovery").trial(effect, seed=1)
    assert one.recovered, (dict(one.deviations), one.message)
    assert one.see_over_floor < 1.2


@pytest.mark.parametrize(
    ("effect", "seed"),
    [
        ("backlash", 216),
        pytest.param("backlash", 222, marks=pytest.mark.long),
        ("stribeck_friction", 7),
        pytest.param("stribeck_friction", 386, marks=pytest.mark.long),
    ],
)
def test_a_fit_is_not_left_in_the_valley_next_to_its_own(effect: str, seed: int, repository: Path) -> None:
    """A play a few per cent off, a friction without its peak: 6 to 16 noise floors, and no jump leads out."""
    one = _study(repository, "study_recovery").trial(effect, seed)
    assert one.recovered and one.see_over_floor < 1.1


@pytest.mark.parametrize("rigs", [30, pytest.param(60, marks=pytest.mark.long)])
def test_intervals_cover_the_truth(rigs: int, repository: Path) -> None:
    study = _study(repository, "study_coverage")
    deviations = np.array([study.trial(seed).deviations for seed in range(rigs)])
    inside = np.mean(np.abs(deviations) < 1.96, axis=0)
    # With 95 % each: at least 52 of 60 rigs with a probability of 99.7 %, 26 of 30 with one of 98 %.
    assert np.all(inside >= 52 / 60), inside


def test_a_start_up_to_four_times_wrong(repository: Path) -> None:
    study = _study(repository, "study_recovery")
    rng = np.random.default_rng([0, 6, 77])
    plant, values, force = study.draw("end_stop", rng)
    records = study.measure(plant, "end_stop", values, force, rng)
    truth = Plant(**plant) + by_name("end_stop").from_values(values)
    wrong = truth.with_values(truth.values * 4.0 ** rng.uniform(-1.0, 1.0, truth.values.size))
    result = fit(wrong, records)
    assert result.see < 1.15 * result.noise_floor


def _trial(seed: int, deviation: float, see_over_floor: float = 1.0) -> dict[str, object]:
    return {
        "effect": "cogging", "seed": seed, "deviations": {"mass": deviation, "damping": 0.5}, "seconds": 0.1,
        "see_over_floor": see_over_floor, "message": "", "recovered": abs(deviation) <= 3.0,
    }  # fmt: skip


@pytest.mark.parametrize(("worst", "floors", "code"), [(1.0, 1.0, 0), (3.5, 1.0, 1), (1.0, 2.0, 1)])
def test_the_page_of_both_studies(
    worst: float, floors: float, code: int, repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recovery = [_trial(seed, 1.0) for seed in range(9)] + [_trial(9, worst, floors)]
    coverage = [{"seed": seed, "deviations": [2.5 if seed == 0 else 1.0] * 4} for seed in range(20)]
    (tmp_path / "r.json").write_text(json.dumps(recovery))
    (tmp_path / "c.json").write_text(json.dumps(coverage))
    page = tmp_path / "page.md"
    files = ["--recovery", str(tmp_path / "r.json"), "--coverage", str(tmp_path / "c.json"), "--out", str(page)]
    monkeypatch.setattr(sys, "argv", ["study_table.py", *files])
    assert _study(repository, "study_table").main() == code
    text = page.read_text()
    assert f"| {10 - (worst > 3.0)} of 10 |" in text
    assert ("- `cogging`: 9: mass 3.5" in text) == (worst > 3.0)
    assert "| 0–19 | 20 | 95.0 | 95.0 | 95.0 | 95.0 |" in text

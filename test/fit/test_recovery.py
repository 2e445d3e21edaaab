"""A small, seeded part of the recovery and coverage studies in ``bench``."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from msd_ident.model.effects import LIBRARY


def _study(repository: Path, name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, repository / "bench" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("effect", [effect.name for effect in LIBRARY])
def test_every_effect_is_found_again(effect: str, repository: Path) -> None:
    one = _study(repository, "study_recovery").trial(effect, seed=1)
    assert one.recovered, (dict(one.deviations), one.message)
    assert one.see_over_floor < 1.2


def test_intervals_cover_the_truth(repository: Path) -> None:
    study = _study(repository, "study_coverage")
    deviations = np.array([study.trial(seed).deviations for seed in range(60)])
    inside = np.mean(np.abs(deviations) < 1.96, axis=0)
    # 60 rigs with 95 % each: at least 52 with a probability of 99.9 %.
    assert np.all(inside >= 52 / 60), inside

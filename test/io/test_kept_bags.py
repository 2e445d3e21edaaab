"""The bags in bags/ open, stay small, and give the results written beside them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from msd_ident.io import SourceOptions, read
from msd_ident.workflow.pipeline import identify

BAGS = Path(__file__).resolve().parents[2] / "bags"
EXPECTED = json.loads((BAGS / "expected.json").read_text(encoding="utf-8"))


def test_every_bag_has_an_expected_result_and_all_are_small() -> None:
    folders = sorted(path.name for path in BAGS.iterdir() if path.is_dir())
    assert folders == sorted(EXPECTED) and len(folders) >= 3
    assert sum(file.stat().st_size for file in BAGS.rglob("*") if file.is_file()) <= 1_000_000


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_bag_gives_what_the_rig_was(name: str) -> None:
    found = identify([read(BAGS / name, SourceOptions())])
    for parameter, (truth, relative) in EXPECTED[name]["parameters"].items():
        assert found.refined.parameters[parameter].value == pytest.approx(truth, rel=relative), parameter
    said = any("the model lacks something" in sentence for sentence in found.warnings)
    assert said == EXPECTED[name]["something_missing"]
    assert any("known only as ratios" in sentence for sentence in found.open) == EXPECTED[name]["ratios_only"]

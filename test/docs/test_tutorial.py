"""The tutorial: its commands print what the page says, and its JSON has the keys that the contract documents."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any
from unittest import mock

import json_contract
import numpy as np
import pytest
import transcript

from msd_ident.data.quality import Finding
from msd_ident.design.profile import Profile, Segment
from msd_ident.design.proposal import Proposal
from msd_ident.diagnosis import Diagnosis
from msd_ident.residuals.nonparametric import Characteristics, Curve
from msd_ident.selection.calibration import Calibration, Row
from msd_ident.workflow import pipeline

PAGES = Path(__file__).resolve().parents[2] / "docs"
CONTRACT = (PAGES / "json.md").read_text(encoding="utf-8")
STEPS = transcript.steps((PAGES / "tutorial.md").read_text(encoding="utf-8"))

pytestmark = pytest.mark.xdist_group("tutorial")


@dataclass(frozen=True)
class Lesson:
    """What the commands printed, the objects that they wrote, and the diagnosis behind one of them."""

    printed: tuple[str, ...]
    objects: dict[str, Any]
    diagnosis: Diagnosis


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lesson]:
    folder = tmp_path_factory.mktemp("tutorial")
    real, seen = pipeline.diagnose, []

    def noted(*args: Any, **options: Any) -> Diagnosis:
        seen.append(real(*args, **options))
        return seen[-1]

    with transcript.inside(folder), mock.patch.object(pipeline, "diagnose", noted):
        printed = tuple(transcript.run(step.command) for step in STEPS)
    objects = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in folder.glob("*.json")}
    assert (folder / "report.html").stat().st_size > 10_000
    yield Lesson(printed, objects, seen[0])


@pytest.mark.parametrize("number", range(len(STEPS)))
def test_commands_print_what_the_page_says(lesson: Lesson, number: int) -> None:
    wrong = list(transcript.differences(STEPS[number].output, lesson.printed[number]))
    assert not wrong, f"{STEPS[number].command}: `make docs-output` writes the page anew\n" + "\n".join(wrong)


def test_a_file_is_shown_as_the_real_command_shows_it(lesson: Lesson, tmp_path: Path) -> None:
    shown = [step.command for step in STEPS if not step.command.startswith("msd ")]
    assert shown
    for command in shown:
        program, *rest = shlex.split(command)
        told = json.dumps(lesson.objects[Path(rest[-1]).stem], ensure_ascii=False)
        (tmp_path / rest[-1]).write_text(f"{told}\n", encoding="utf-8")
        real = [sys.executable if program == "python3" else program, *rest]
        done = subprocess.run(real, cwd=tmp_path, capture_output=True, text=True, check=True)
        with transcript.inside(tmp_path):
            assert transcript.run(command) == done.stdout.rstrip("\n")


def test_the_hidden_effect_is_named(lesson: Lesson) -> None:
    hidden, found = lesson.objects["sealed"]["effects"], lesson.objects["diagnosis"]
    assert found["verdict"] == "explained"
    assert {cause["name"] for cause in found["causes"]} == set(hidden) and "backlash" in hidden


@cache
def documented(schema: str) -> set[str]:
    return json_contract.documented(CONTRACT, schema)


def undocumented(value: Any, schema: str) -> set[str]:
    """Paths that are not in the tables; an empty list or object may be the beginning of one that is."""
    known = documented(schema)
    begun = {path for path in json_contract.paths(value) if any(k.startswith((f"{path}.", f"{path}[")) for k in known)}
    return set(json_contract.paths(value)) - known - begun


def test_every_key_of_an_identification_is_documented_and_there(lesson: Lesson) -> None:
    found = lesson.objects["identification"]
    new = undocumented(found, "msd.identification/1")
    assert not new, f"{new} has no line in docs/json.md"
    known = [{"name": "mass", "value": 1.0, "std": 0.1, "unit": "kg"}]
    found |= {
        "read_with": {"OPTION": "…"},
        "known": known,
        "open": ["…"],
        "findings": [vars(Finding("info", "code", "sentence"))],
    }
    assert documented("msd.identification/1") == set(json_contract.paths(found))


def test_every_key_of_a_diagnosis_is_documented_and_there(lesson: Lesson) -> None:
    found = lesson.objects["diagnosis"]
    new = undocumented(found, "msd.diagnosis/2")
    assert not new, f"{new} has no line in docs/json.md"
    whole = {"path": found["path"], "read_with": {"OPTION": "…"}, **everything(lesson.diagnosis).to_json_dict()}
    there = set(json_contract.paths(whole)) - experiment_paths(whole)
    empty = {path for path in there if f"{path}[]" in there}  # a rival without causes, beside one with some
    assert documented("msd.diagnosis/2") == there - empty


def experiment_paths(whole: dict[str, Any]) -> set[str]:
    """Paths inside the next experiment, which have a table of their own."""
    return {path for path in json_contract.paths(whole) if path.startswith("next_experiment.")}


def everything(diagnosis: Diagnosis) -> Diagnosis:
    """The same with what only other verdicts have: curves, a spread, a tie, a finding, a warning, a second k."""
    curve = Curve(np.zeros(2), np.zeros(2), np.zeros(2))
    return replace(
        diagnosis,
        characteristics=Characteristics(curve, curve, 1.0, 1e-5, 90.0),
        causes=tuple(replace(cause, tied_with=("end_stop",)) for cause in diagnosis.causes),
        spread={"mass": (0.9, 1.1)},
        findings=(Finding("info", "code", "sentence"),),
        warnings=("…",),
        calibration=Calibration(
            (Row(frozenset({"backlash"}), True, {frozenset({"end_stop"}): 1}),), {"a": 1.0}, {"a": 0.9}
        ),
        derived={"stiffness_at_rest": diagnosis.extended.quantities["stiffness"]},
    )


def test_every_key_of_a_next_experiment_is_documented_and_there() -> None:
    motion, none = np.zeros((2, 3)), np.zeros(3)
    proposal = Proposal(
        Profile((Segment("step", 1.0, force=2.0),)), ("a", "b"), 0.9, np.ones(2), (0.0, 0.01), 0.3, none, motion, none,
        (0, 1), 1e-5, (("push", 1.0, 0.9),), "Push.", ("weigh it",),
    )  # fmt: skip
    found = proposal.to_json_dict()
    found["profile"]["segments"] = ["…"]  # their keys depend on the kind
    assert documented("msd.next_experiment") == set(json_contract.paths(found))


def test_a_difference_is_noticed() -> None:
    page = "mass   0.946 ± 0.021   kg\n\ncauses   1"
    assert not list(transcript.differences(page, "mass  0.947 ±   0.0215 kg\n\ncauses 1"))
    for now in ("mass 0.99 ± 0.021 kg\n\ncauses 1", "mass 0.946 ± 0.021 g\n\ncauses 1", "mass 0.946 ± 0.021 kg"):
        assert list(transcript.differences(page, now)), now

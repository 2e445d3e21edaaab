"""The table of measured rigs: what counts as right, and where each record is read from."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import once
import pytest

from bench.real import __main__ as table
from bench.real.rigs import DRY, RIGS, Reference, Rig
from bench.real.score import Row, judgement, line, refused, score, totals
from msd_ident.io import SourceOptions
from msd_ident.model.effects import by_name
from msd_ident.workflow import pipeline

RIG = Rig(
    "real/cart.csv", SourceOptions(), acts=(DRY, frozenset({"force_offset"})), false=frozenset({"end_stop"}),
    false_findings=frozenset({"missing_samples"}),
    references=(Reference("ωn [rad/s]", 9.9, 10.0, 0.01, lambda v: (v["stiffness"] / v["mass"]) ** 0.5),),
    expert_see=1e-4,
)  # fmt: skip


Named = tuple[str, float, tuple[str, ...]]


def diagnosis(*causes: Named, see: float = 1.5e-4, k: float = 100.0, code: str = "") -> Any:
    """What the table reads of a diagnosis, in this schema and later ones."""
    return SimpleNamespace(
        verdict="explained",
        causes=[SimpleNamespace(name=name, probability=p, tied_with=ties) for name, p, ties in causes],
        findings=[SimpleNamespace(code=code)],
        extended=SimpleNamespace(
            quantities={"mass": SimpleNamespace(value=1.0), "stiffness": SimpleNamespace(value=k)}, see=see
        ),
        records=[SimpleNamespace(position_unit="m", position=[1.0, 7.0])],
    )


def row(*causes: Named, **others: Any) -> Row:
    return score(RIG, diagnosis(*causes, **others), 2.0)


RUBS, PUSHED = ("hysteresis", 0.7, ("coulomb_friction",)), ("force_offset", 0.99, ())


def test_one_of_each_group_named_is_right() -> None:
    found = row(RUBS, PUSHED)
    assert found.right and judgement(found) == "right"
    assert found.reached is True and "(1.50×)" in line(found)
    assert row(("cogging", 0.99, ("coulomb_friction",)), PUSHED).right, "a tie with the truth counts"
    assert row(RUBS, PUSHED, see=1.51e-4).reached is False


@pytest.mark.parametrize(
    ("found", "said"),
    [
        (row(RUBS), "not named (force_offset)"),
        (row(), "no cause named"),
        (row(RUBS, PUSHED, ("end_stop", 0.91, ())), "false cause (end_stop, p 0.910)"),
        (row(RUBS, PUSHED, k=90.0), "published value missed"),
        (row(RUBS, PUSHED, k=math.nan), "published value missed"),
        (row(RUBS, PUSHED, code="missing_samples"), "false finding (missing_samples)"),
        (refused(RIG, "no column"), "no cause named, published value missed"),
    ],
)
def test_what_is_wrong_is_said(found: Row, said: str) -> None:
    assert not found.right
    assert judgement(found) == said


def test_a_false_cause_counts_from_its_probability_and_not_from_the_verdict() -> None:
    doubtful = row(RUBS, PUSHED, ("end_stop", 0.6, ()))
    assert doubtful.right and not doubtful.surely_false
    sure = row(RUBS, PUSHED, ("end_stop", 0.95, ()))
    rows = [doubtful, replace(sure, verdict="unexplained"), replace(sure, extra=True)]
    real, extra = totals(rows)
    assert "right 1 of 2; false cause with p > 0.9 in 1; SEE at most 1.5 times that of the manual fit in 2 of 2" in real
    assert "right 0 of 1; false cause with p > 0.9 in 1" in extra
    (alone,) = totals([replace(doubtful, lacks="gravity")])
    assert "in 0 of 0" in alone, "what the library has no law for is not compared with one who had it"


def test_an_expert_s_share_is_one_of_the_signal_about_zero() -> None:
    rig = replace(RIG, expert_see=None, expert_share=0.02)
    assert score(rig, diagnosis(RUBS, PUSHED), 0.0).expert == pytest.approx(0.02 * 5.0)
    assert score(replace(RIG, expert_see=None), diagnosis(RUBS, PUSHED), 0.0).reached is None


def test_rigs_speak_of_effects_that_there_are() -> None:
    for rig in RIGS:
        for name in rig.false.union(*rig.acts):
            by_name(name)
        assert not rig.false & frozenset().union(*rig.acts), rig.name
    assert sum(not rig.extra for rig in RIGS) == 12


def test_without_the_data_one_line_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("MSD_SHARED_DATA", str(tmp_path / "nowhere"))
    assert table.main([]) == 0
    said = capsys.readouterr().out
    assert said.count("\n") == 1 and "nowhere" in said


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("name", "total"),
    [
        pytest.param("step_1", "further", marks=pytest.mark.xdist_group("step_1")),
        pytest.param("spring_cart_1", "main", marks=pytest.mark.long),
    ],
)
def test_a_measured_rig_is_read_and_compared(
    name: str, total: str, shared_data: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (rig,) = (rig for rig in RIGS if rig.name == name)
    if not (shared_data / rig.path).is_file():
        pytest.skip(f"no {rig.path} among the measured data")
    diagnosed = partial(once.diagnosed, copied=name != "step_1")  # other tests ask for the same one
    monkeypatch.setattr(pipeline, "diagnose", diagnosed)
    assert table.main(["--only", name]) == 0
    said = capsys.readouterr().out
    assert f"| {name} |" in said and f"{total}: right 1 of 1" in said


def test_every_record_of_the_folder_is_in_the_table(shared_data: Path) -> None:
    if not (shared_data / "real").is_dir():
        pytest.skip(f"no real rigs in {shared_data}")
    there = {f"real/{path.name}" for path in (shared_data / "real").iterdir() if path.suffix in (".csv", ".txt")}
    assert there == {rig.path for rig in RIGS if not rig.extra}


def test_rows_are_read_back_and_the_page_says_what_is_wrong(tmp_path: Path) -> None:
    """The page has every row, the totals, and each failure with its reason."""
    good, bad = row(RUBS, PUSHED), row(("end_stop", 0.95, ()), see=1.0)
    rows = [replace(good, rig="spring_cart_1"), replace(bad, rig="hanging_spring_disc")]
    file = tmp_path / "rows.jsonl"
    file.write_text("".join(json.dumps(asdict(one)) + "\n" for one in rows), encoding="utf-8")
    assert table.read_rows(file) == rows
    assert table.main(["--score", str(file), "--docs", str(tmp_path)]) == 0
    said = (tmp_path / "real-rigs.md").read_text(encoding="utf-8")
    assert "| spring_cart_1 | cart between springs: Coulomb friction |" in said
    assert "images/real_spring_cart_1.png" in said
    wrong = said.partition("## Errors")[2].partition("##")[0]
    assert "`hanging_spring_disc`: false cause (end_stop, p 0.950)" in wrong and "spring_cart_1" not in wrong
    assert "times that of the manual fit" in wrong

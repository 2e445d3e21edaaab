"""Every verdict has its words, its colour and its headline, wherever a person reads it."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest
from reportrigs import diagnosed
from rich.console import Console

import msd_ident
from msd_ident.diagnosis.result import Rival, Verdict
from msd_ident.live import cards
from msd_ident.report import diagnosis, words
from msd_ident.report.sections.parameters import diagnosis_columns, parameters

pytestmark = pytest.mark.xdist_group("report")

ROOT = Path(msd_ident.__file__).parent


@pytest.mark.parametrize("verdict", get_args(Verdict))
def test_every_verdict_is_known_everywhere(verdict: Verdict) -> None:
    assert verdict in words.VERDICTS and cards.VERDICTS[verdict] == words.VERDICTS[verdict]
    assert verdict in diagnosis._COLOURS
    for sheet in ("report/templates/page.css", "live/card.css"):
        assert f".pill.{verdict}" in (ROOT / sheet).read_text()
    interfaces = ROOT.parent / "msd_interfaces" / "msg" / "Diagnosis.msg"
    assert f'{verdict.upper()}="{verdict}"' in interfaces.read_text()


def test_headlines_of_what_is_left_and_of_what_is_not_certain() -> None:
    found = diagnosed()
    left = replace(found.left, extended=replace(found.left.extended, motion_percent=4.2, seen=True))
    told = words.headline(replace(found, verdict="mostly_explained", left=left))
    assert told == "The simulation lacks Coulomb friction, and something more: 4.2 % of the motion stays unexplained."
    assert words.headline(replace(found, verdict="ambiguous")).endswith("this data cannot tell for certain.")
    enough = replace(left, extended=replace(left.extended, motion_percent=0.4))
    told = words.headline(replace(found, verdict="adequate", causes=(), left=enough))
    assert told.endswith("the error is less than the tolerance of 1 % of the motion.")


def test_where_laws_fit_alike_their_range_stands_in_the_place_of_one_interval() -> None:
    found = replace(diagnosed(), spread={"mass": (2.6, 2.9)})
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(diagnosis.models_table(found))
    text = console.export_text()
    assert "ranges: over all equally good fits" in text
    (row,) = (line for line in text.splitlines() if line.strip().startswith("mass"))
    assert row.rstrip().endswith("2.6 to 2.9             kg") and "±" in row.split("2.6 to")[0]
    columns = diagnosis_columns(found)
    section = parameters(found.records, columns, (), found.spread)
    assert [row[4] for row in section.context["rows"]][0] == "2.600 to 2.900"
    assert not parameters(found.records, columns, ()).context["ranges"]


def test_a_star_marks_explanations_whose_probability_the_named_causes_count() -> None:
    """ "constraint_stop > 99.9 %" stood above "buffered_stop 50.0 %"."""
    (named,) = diagnosed().causes
    stop = replace(named, name="constraint_stop")
    rivals = [("buffered_stop",), ("cogging", "end_stop"), ("cogging",), ()]
    found = replace(diagnosed(), causes=(stop,), rivals=tuple(Rival(causes, 0.2, 3.0) for causes in rivals))
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(diagnosis.rivals_table(found))
    text = console.export_text()
    assert [line.count("20.0 % *") for line in text.splitlines() if "20.0 %" in line] == [1, 1, 0, 0]
    assert "* with the named causes, in this or another law: their probability counts it" in " ".join(text.split())
    alone = diagnosis.rivals_table(replace(found, rivals=found.rivals[2:]))
    assert alone is not None and alone.caption is None


def test_a_title_names_few_records_and_counts_many() -> None:
    assert words.records(["a.csv", "b.csv"]) == "a.csv + b.csv"
    assert words.records([f"{n}.csv" for n in range(1, 23)]) == "1.csv … 22.csv (22 records)"
    assert words.folder(["a.csv", "b.csv"]) == "a.csv+b.csv"
    assert words.folder([f"{n}.csv" for n in range(1, 23)]) == "1.csv+21_more"
    many = replace(diagnosed(), records=diagnosed().records[:1] * 6)
    out = io.StringIO()
    diagnosis.print_diagnosis(many, Console(file=out, width=200))
    assert "(6 records): " in out.getvalue().splitlines()[0]

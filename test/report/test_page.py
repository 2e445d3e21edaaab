"""The page: every section, the JSON's numbers, one file that asks for nothing, and names that cannot break out."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from reportrigs import diagnosed, identified, provenance, with_everything

from msd_ident.cli.results import jsonable
from msd_ident.diagnosis import Diagnosis
from msd_ident.model.effects import LIBRARY
from msd_ident.report import markdown, page, plotly_figure
from msd_ident.report.plots import Detail
from msd_ident.workflow.identification import Identification

pytestmark = pytest.mark.xdist_group("report")

SECTIONS = ["verdict", "fit", "missing_force", "causes", "calibration", "parameters", "data", "next_experiment"]
EVIL = "</script><script>window.pwned=1</script><img src=x onerror=window.pwned=1>"
FACTORS = {"cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "ms": 1e-3, "µs": 1e-6}


class Reader(HTMLParser):
    """Ids of sections, marked numbers with their text, tags, addresses and the text that a person sees."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.sections: list[str] = []
        self.marked: list[tuple[str, str, str]] = []
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.seen = ""
        self._open: tuple[str, str] | None = None
        self._silent = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = dict(attrs)
        self.tags.append(tag)
        self._silent = tag in ("script", "style")
        self.addresses += [told[key] or "" for key in ("src", "href") if key in told]
        if tag == "section":
            self.sections.append((told["id"] or "").partition("-")[2])
        if tag == "data":
            self._open = (told["data-key"] or "", told["value"] or "")

    def handle_endtag(self, tag: str) -> None:
        self._silent = False
        self._open = None

    def handle_data(self, data: str) -> None:
        if self._open is not None:
            self.marked.append((*self._open, data))
        if not self._silent:
            self.seen += data


@pytest.fixture(scope="module")
def text() -> str:
    return page.render([with_everything()], [provenance()])


def at(found: object, key: str) -> object:
    """The value at a path like ``causes.0.probability``."""
    for part in key.split("."):
        keys = range(len(found)) if isinstance(found, list) else found
        place = int(part) if isinstance(found, list) else part
        assert place in keys, f"the page shows {key}, and the JSON (to_json_dict) has no {part} there"
        found = found[place]  # type: ignore[index]
    return found


def test_sections_stand_in_the_order_in_which_people_ask(text: str) -> None:
    assert Reader(text).sections == SECTIONS


def test_an_identification_has_a_page_too() -> None:
    read = Reader(page.render([identified()]))
    assert read.sections == ["verdict", "fit", "standard_form", "parameters", "data"]
    assert "natural frequency" in read.seen


def test_an_experiment_that_is_not_worth_playing_has_no_force_to_push_with() -> None:
    found = with_everything()
    assert found.next_experiment is not None
    vain = replace(found, next_experiment={**found.next_experiment, "probability_of_decision": 0.004})
    assert [any(plot.slug == "profile" for plot in page.article(one).plots) for one in (found, vain)] == [True, False]
    shown = Reader(page.render([vain])).seen
    assert "probability that it decides" in shown and "travel" not in shown.split("probability that it decides")[1]


def test_the_page_is_one_small_file_that_asks_for_nothing(text: str) -> None:
    assert len(text.encode()) < page.LARGEST
    assert [address for address in Reader(text).addresses if not address.startswith(("#", "data:"))] == []
    assert "@import" not in text and "url(" not in page.shipped("templates", "page.css")


@pytest.mark.parametrize("make", [with_everything, identified], ids=["diagnosis", "identification"])
def test_every_number_is_the_one_in_the_json(make: type) -> None:
    found: Diagnosis | Identification = make()
    marked = Reader(page.render([found], [provenance()])).marked
    told = json.loads(json.dumps(jsonable(found.to_json_dict())))
    assert len(marked) > 15
    for key, value, shown in marked:
        there = at(told, key)
        assert there == (float(value) if value else None), key
        number = re.search(r"-?\d[\d.]*(e[-+]\d+)?", shown)
        if not shown.startswith(("<", ">")) and number is not None:
            factor = 0.01 if "static_gain" in key else FACTORS.get(shown.split()[-1], 1.0)
            percent = 0.01 if shown.endswith(" %") and not key.endswith("percent") else 1.0
            assert float(number[0]) * factor * percent == pytest.approx(there, rel=6e-3, abs=1e-9), (key, shown)


def test_verdict_and_sentences_are_those_of_the_json(text: str) -> None:
    found, seen = with_everything(), " ".join(Reader(text).seen.split())
    assert found.verdict in seen and found.summary in seen
    for sentence in (*found.warnings, *(one.reason for one in found.tried if not one.held)):
        assert " ".join(sentence.split()) in seen
    assert "This data cannot tell these apart." in seen and "Push with 4 N and with 8 N" in seen


def test_diagnoses_of_copies_are_a_table_and_a_sentence_each(text: str) -> None:
    seen = " ".join(Reader(text).seen.split())
    told = [
        "Of the copies with Coulomb friction, 88 % were diagnosed correctly, 12 % as the base model.",
        "with Stribeck friction of any strength, 75 % were diagnosed correctly, 25 % as Coulomb friction.",
        "Of the copies with the base model, 100 % were diagnosed correctly.",
        "probability > 99.9 % by the evidence, 77.0 % after correction by 44 copies of this record.",
    ]
    shown = markdown.render([with_everything()], [provenance()])
    for sentence in told:
        assert sentence in seen and sentence.replace(">", "\\>") in shown
    assert "Stribeck friction, any strength" in seen
    assert "| Stribeck friction, any strength | 25 % | 75 % | – | 16 |" in shown
    assert "calibration" not in Reader(page.render([diagnosed()])).sections


def test_every_cause_of_the_library_is_named_with_its_reason() -> None:
    tried = diagnosed().tried
    assert len(tried) == len(LIBRARY) and [one.name for one in tried if one.held] == ["coulomb_friction"]
    assert tried[0].reason.startswith("without it ") and "noise floors remain" in tried[0].reason
    for one in tried[1:]:
        known = "alone it |not fitted (completely|alone)|another law of |may be mistaken for |cannot (act|be seen) here"
        assert re.match(known, one.reason), one


@pytest.mark.parametrize("make", [diagnosed, identified], ids=["diagnosis", "identification"])
def test_names_out_of_bags_are_text_and_nothing_else(make: type) -> None:
    found: Diagnosis | Identification = make()
    record = replace(found.records[0], name=EVIL, notes=(f"topic {EVIL} lost samples",), position_unit=f"m{EVIL}")
    spoilt = replace(found, records=(record,), warnings=(EVIL,))
    origin = replace(provenance().origins[0], path=EVIL, position=EVIL)
    told = replace(provenance(), command=EVIL, origins=(origin,))
    clean, dirty = Reader(page.render([found], [provenance()])), Reader(page.render([spoilt], [told]))
    assert dirty.tags.count("script") == clean.tags.count("script") and "img" not in dirty.tags
    assert EVIL in dirty.seen
    assert "<script" not in re.sub(r"`[^`]*`", "", markdown.render([spoilt], [told])).replace(r"\<script", "")


def test_plotly_takes_every_figure() -> None:
    from plotly.graph_objects import Figure

    plots = (*page.article(with_everything()).plots, *page.article(identified()).plots)
    assert {plot.slug for plot in plots} >= {"fit", "missing_time", "missing_velocity", "missing_position", "bode"}
    for plot in plots:
        assert len(Figure(plotly_figure.figure(plot)).data) > 0


def test_many_records_share_the_room_of_one_page() -> None:
    text = page.render([diagnosed()] * 12)
    assert Reader(text).sections.count("fit") == 12 and 'href="#r12"' in text
    # As many points as a long record has at most, in every curve of every record.
    few = [Detail.shared_by(count) for count in (1, 12, 60)]
    assert few[0].curve > few[1].curve > few[2].curve >= 150
    assert all(count * detail.curve * 9 * 11 < 4e6 for count, detail in zip((1, 12, 60), few, strict=True))


def test_the_markdown_has_the_verdict_the_tables_and_the_command() -> None:
    told = markdown.render([with_everything()], [provenance()])
    assert told.startswith("# rubbing: ambiguous\n")
    assert "| Coulomb friction |" in told and "Stribeck friction, hysteresis" in told
    assert "command: `msd diagnose rubbing.csv" in told and "ab" * 32 in told
    assert markdown.render([identified()]).startswith("# rubbing: identified\n")

"""The figures of a blind study."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from bench.blind import plan, score, told, truth
from bench.blind.__main__ import chosen, main
from bench.blind.cases import Case, Outcome, run, sealed
from bench.blind.truth import FAMILIES, UNNAMED
from bench.mujoco_rigs import simulate
from bench.mujoco_rigs.rig import EXPERIMENTS, FAULTS
from msd_ident.errors import DataError
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.law import OUTSIDE
from msd_sim import foreign, lottery

Stated = tuple[tuple[str, float], ...]


def outcome(named: Stated, beside: Stated = (), truth: Sequence[str] = ("backlash",), **others: object) -> Outcome:
    """A diagnosis of a rig, one with backlash unless said otherwise, that stated these probabilities."""
    made = Outcome(
        case=Case(1, next(iter(truth), None), len(truth) > 1), truth=tuple(truth), odd=False, strength={},
        verdict="explained", named=tuple((name, p, (), p) for name, p in named), base_floors=9.0, extended_floors=1.0,
        without_floors=9.0, heldout_floors=1.0, removed=1.0, seconds=1.0, beside=beside,
    )  # fmt: skip
    return replace(made, **others)  # type: ignore[arg-type]


def figure(what: str, outcomes: Sequence[Outcome]) -> tuple[int, int]:
    (found,) = [one for one in score.figures(outcomes) if one.what == what]
    return found.good, found.total


def test_stated_probabilities_are_compared_with_what_acts() -> None:
    """Of ten stated with 0.7 six act; a thin bin is shown with its range, and counts for nothing."""
    right, wrong = outcome((("backlash", 0.7),)), outcome((("cogging", 0.7),))
    thin = outcome((("backlash", 0.99),), beside=(("cogging", 0.3), ("hysteresis", 0.001)))
    bins = score.reliability([*[right] * 6, *[wrong] * 4, thin])
    assert [(b.low, b.count, b.right) for b in bins] == [(0.2, 1, 0), (0.6, 10, 6), (0.95, 1, 1)]
    assert bins[1].observed == 0.6 and bins[1].range == pytest.approx((0.313, 0.832), abs=0.001)
    assert score.miscalibration([*[right] * 6, *[wrong] * 4, thin]) == pytest.approx(0.1)
    assert math.isnan(score.miscalibration([thin]))


def test_right_probabilities_are_off_by_chance_too() -> None:
    """Of ten causes stated with 0.7, 6 to 8 act in 70 of 100 studies, 5 to 9 in 92, 4 to 10 in 99."""
    ten = [outcome((("backlash", 0.7),))] * 10
    assert score.by_chance(ten) == pytest.approx((0.1, 0.3))
    assert max(score.by_chance(ten * 40)) < 0.05 < score.by_chance(ten)[0], "many causes leave little to chance"
    assert score.by_chance([outcome((("backlash", 1.0),))] * 10) == (0.0, 0.0)
    assert math.isnan(score.by_chance(ten[1:])[0])
    assert "if every stated probability were right: median (95 % below) | 0.100 (0.300)" in "\n".join(told.report(ten))


def test_named_causes_of_several_studies_are_calibrated_together(tmp_path: Path) -> None:
    """On rigs of other laws a cause of the law's family is right; what a rival set holds does not count."""
    own = outcome((("backlash", 0.7),), beside=(("cogging", 0.3),))
    law = Case(2, "soft_play", False, author="foreign")
    family = outcome((("end_stop", 0.7),), truth=("soft_play",), case=law)
    false = outcome((("cogging", 0.7),), truth=("soft_play",), case=law)
    pooled = [*[own] * 5, *[family] * 3, *[false] * 2]
    assert [(b.count, b.right) for b in score.named_reliability(pooled)] == [(10, 8)]
    assert score.largest_gap(score.named_reliability(pooled)) == pytest.approx(0.1)
    assert score.named_by_chance(pooled) == pytest.approx((0.1, 0.3))
    tied = replace(false, named=(("cogging", 0.4, ("end_stop",), 0.9),))
    assert [(b.low, b.right) for b in score.named_reliability([tied])] == [(0.4, 0)]
    assert [(b.low, b.right) for b in score.named_reliability([tied], "cause or tied")] == [(0.8, 1)]
    files = [tmp_path / "own.json", tmp_path / "foreign.json"]
    for path, part in zip(files, (pooled[:5], pooled[5:]), strict=True):
        path.write_text("".join(json.dumps(o.to_json_dict()) + "\n" for o in part))
    assert main(["--score", *map(str, files), "--docs", str(tmp_path)]) == 0
    page = (tmp_path / "calibration.md").read_text()
    assert "All rigs, 10 cases: largest difference 0.100 in bins with at least 10 causes; by chance 0.100" in page
    assert "Simulated rigs with other laws, 5 cases: largest difference nan" in page
    assert "| 0.60 to 0.80 | 10 | 0.700 | 0.800 |" in page and "MuJoCo's rigs, " not in page


def test_stops_off_the_middle_are_stops_beside_an_offset_but_not_the_other_way_round() -> None:
    """docs/identities.md: one end stop may stand for both, an offset that does not act is false."""
    both, one = ("end_stop", "force_offset"), ("end_stop",)
    assert outcome((("end_stop", 1.0),), truth=both).exact
    added = outcome((("end_stop", 1.0), ("force_offset", 0.95)), truth=one)
    assert not added.exact and added.false == (("force_offset", 0.95),)


def test_no_verdict_keeps_a_probability_out_of_the_calibration() -> None:
    wrong = outcome((("cogging", 0.99),), verdict="unexplained")
    assert score.miscalibration([wrong] * 10) == pytest.approx(0.99)


def test_what_no_experiment_decides_is_not_calibrated() -> None:
    """With a linear spring a force offset is a shift of the zero, whether it acts or not."""
    unsaid = outcome((("coulomb_friction", 1.0),), beside=(("force_offset", 0.1),), truth=("coulomb_friction",))
    hidden = outcome((("force_offset", 0.1),), truth=("force_offset",))
    seen = outcome((("force_offset", 0.1),), truth=("backlash", "force_offset"))
    assert [(b.count, b.right) for b in score.reliability([unsaid, hidden])] == [(1, 1)]
    assert [(b.count, b.right) for b in score.reliability([seen])] == [(1, 1)]


@pytest.mark.parametrize("verdict", ["explained", "ambiguous", "unexplained", "mostly_explained"])
@pytest.mark.parametrize("floors", [1.0, 9.0])
def test_a_false_cause_counts_whatever_the_verdict_and_seen_or_not(verdict: str, floors: float) -> None:
    sure = outcome((("backlash", 1.0), ("cogging", 0.91)), verdict=verdict, without_floors=floors)
    doubtful = outcome((("backlash", 1.0), ("cogging", 0.9)), verdict=verdict, without_floors=floors)
    tied = replace(sure, named=(("cogging", 0.95, ("backlash",), 0.95),))
    clean = outcome((("cogging", 0.99),), truth=(), verdict=verdict)
    assert figure("a false cause with p > 0.9: all experiments", [sure, doubtful, tied, clean]) == (3, 4)
    assert figure("a false cause with p > 0.9: steps", [sure, doubtful]) == (1, 2)
    assert "cogging 0.910" in "\n".join(told.report([sure]))


def test_false_causes_are_counted_for_each_kind_of_experiment() -> None:
    def one(experiment: str, p: float, rate: float = 1000.0) -> Outcome:
        return outcome((("cogging", p),), case=Case(1, "backlash", False, experiment, rate))

    outcomes = [one("release", 0.95), one("release", 0.5), one("ramp", 0.5, 250.0), one("steps", 0.95, 200.0)]
    assert figure("a false cause with p > 0.9: release", outcomes) == (1, 2)
    assert figure("a false cause with p > 0.9: ramp", outcomes) == (0, 1)
    assert figure("a false cause with p > 0.9: steps", outcomes) == (1, 1)


@pytest.mark.parametrize(
    ("truth", "named", "right"),
    [
        (("coulomb_friction",), ("coulomb_friction", "force_offset"), True),
        (("coulomb_friction", "force_offset"), ("coulomb_friction",), True),
        (("force_offset",), (), True),
        (("backlash",), ("backlash", "force_offset"), False),
        (("backlash", "force_offset"), ("backlash",), False),
        (("cubic_spring", "force_offset"), ("cubic_spring", "asymmetric_spring"), True),
        (("cubic_spring",), ("cubic_spring", "asymmetric_spring"), False),
        (("coulomb_friction",), ("stribeck_friction",), False),
        ((), ("coulomb_friction",), False),
    ],
)
def test_what_is_the_same_thing_is_right(truth: tuple[str, ...], named: tuple[str, ...], right: bool) -> None:
    found = outcome(tuple((name, 0.99) for name in named), truth=truth)
    assert found.exact is right


def test_a_clean_rig_is_to_be_called_adequate_whatever_its_noise() -> None:
    case = Case(1, None, False, noise="coloured")
    doubted = outcome((), truth=(), case=case, verdict="unexplained")
    invented = outcome((("cogging", 0.4),), truth=(), case=case, verdict="ambiguous")
    right = outcome((), truth=(), case=case, verdict="adequate")
    assert figure("no hidden effect, coloured noise: a false cause named", [doubted, invented, right]) == (1, 3)
    assert figure("no hidden effect, coloured noise: verdict not `adequate`", [doubted, invented, right]) == (2, 3)


def test_an_oddity_may_be_called_by_its_family_alone() -> None:
    case = Case(1, "fading_friction", False)
    related = outcome((("coulomb_friction", 0.99),), truth=("fading_friction",), odd=True, case=case)
    other = outcome((("quadratic_drag", 0.99),), truth=("fading_friction",), odd=True, case=case)
    assert figure("visible unknown law: false cause with p > 0.9", [related, other]) == (1, 2)
    assert set(FAMILIES) == {*lottery.ODDITIES, *lottery.VARIANTS, *foreign.LAWS}


def test_a_variant_wants_its_family_nothing_false_and_the_plant() -> None:
    def one(name: str, p: float, hidden: str = "one_sided_stop", **others: object) -> Outcome:
        return outcome(
            ((name, p),),
            truth=(hidden,),
            odd=True,
            case=Case(1, hidden, False),
            **{"plant_error": 0.01, "plant_stated": 0.0, **others},
        )

    right, faint = one("end_stop", 0.99), one("end_stop", 0.99, base_floors=2.0)
    wrong, far = one("cogging", 0.95), one("asymmetric_spring", 0.95, plant_error=0.03)
    tied = replace(one("cogging", 0.6), named=(("cogging", 0.6, ("end_stop",), 0.6),))
    assert score.variants([right, faint, wrong, far, tied]) == {"one_sided_stop": (4, 2, 2, 3, 4, 5)}
    unnamed = one("end_stop", 0.5, hidden="band_limited_force")
    assert score.variants([unnamed]) == {"band_limited_force": (1, 1, 0, 1, 1, 1)}
    said = told.variants([right, replace(unnamed, verdict="ambiguous")])
    assert said[-3:] == ["| all | 2 | 2 | 2 | 0 | 0 | 2 | 2 |", "", "No case has an error."]
    assert told.variants([outcome((("backlash", 1.0),))]) == []
    row = told.failures([right, wrong])[-1]
    assert row.startswith("| 1 | steps | one_sided_stop | cogging 0.950 | explained [1.00, 9.0] | family not named; ")
    assert score.failed(wrong) == ["family not named", "false cause with p > 0.9", "`explained` with a false cause"]
    assert score.failed(far) == [
        "family not named",
        "false cause with p > 0.9",
        "`explained` with a false cause",
        "m or k off by 3.0 %, covered",
    ]


def test_a_record_that_is_refused_counts_as_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    """A study that leaves it out shows better figures than a user sees."""

    def refuse(records: object) -> None:
        raise DataError("all causes of the library explain 44 % of the position's variance")

    monkeypatch.setattr("bench.blind.cases.pipeline.diagnose", refuse)
    found = run(Case(7, "uneven_stops", False, "release", author="foreign"))
    assert Outcome.from_json_dict(json.loads(json.dumps(found.to_json_dict()))).plant_error == math.inf
    assert score.failed(found) == ["family not named", "m or k not found"]
    assert "| all | 1 | 1 | 0 | 0 | 0 | 0 | 0 |" in told.variants([found])
    assert any("refused" in line and "m or k not found" in line for line in told.variants([found]))


@pytest.mark.parametrize("hidden", ["uneven_stops", "random_force", None])
def test_a_program_that_fails_counts_as_wrong(
    hidden: str | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(records: object) -> None:
        raise ZeroDivisionError("in a fit")

    monkeypatch.setattr("bench.blind.cases.pipeline.diagnose", fail)
    case = Case(7, hidden, False, "release", author="foreign") if hidden else Case(7, None, False)
    found = run(case)
    assert found.verdict == "crashed" and not found.exact and score.failed(found)
    assert hidden is None or not score.family_named(found)
    assert "ZeroDivisionError: in a fit" in capsys.readouterr().err


def test_all_variants_are_planned_where_they_can_be_seen() -> None:
    cases = plan.variants(2, 100)
    assert {case.hidden for case in cases} == set(foreign.LAWS) and {case.kind for case in cases} == {"variant"}
    assert len({case.seed for case in cases}) == len(cases) == 2 * len(foreign.LAWS)
    for case in cases:
        assert sealed(case).truth == {case.hidden}


def test_pairs_of_variants_are_of_two_kinds_and_counted_law_by_law(tmp_path: Path) -> None:
    cases = plan.variant_pairs(2, 100)
    assert len({case.seed for case in cases}) == len(cases) == 20 and {case.kind for case in cases} == {"variant_pair"}
    assert [case.experiment for case in cases] == ["steps", "release"] * 10
    for case in cases:
        one, two = str(case.hidden), str(case.other)
        assert FAMILIES[one].isdisjoint(FAMILIES[two]) and not {one, two} & UNNAMED
        assert sealed(case).truth == {one, two}
    case = Case(7, "lugre", False, "release", other="uneven_stops", author="foreign")
    fields = {"case": case, "truth": ("lugre", "uneven_stops"), "odd": True, "base_floors": 9.0, "plant_error": 0.01}
    both = outcome((("hysteresis", 0.9), ("end_stop", 0.8)), **fields)
    half = outcome((("coulomb_friction", 0.99), ("cogging", 0.95)), **{**fields, "plant_error": 0.5})
    unseen = outcome((), **{**fields, "base_floors": 1.0})
    found = {one.what: (one.good, one.total) for one in score.variant_pairs([both, half, unseen])}
    assert found["both families named"] == (1, 2) and found["hidden laws whose family is named"] == (3, 4)
    assert found["a false cause named"] == found["a false cause with p > 0.9"] == (1, 3)
    assert found["m and k within 2 %"] == (2, 3)
    assert not score.failed(both) and "family not named" in score.failed(half) and not score.failed(unseen)
    path = tmp_path / "pairs.json"
    path.write_text("".join(json.dumps(one.to_json_dict()) + "\n" for one in (both, half, unseen)))
    assert main(["--score", str(path), "--docs", str(tmp_path)]) == 0
    page = (tmp_path / "blind-variant-pairs.md").read_text()
    assert "| hidden laws whose family is named | 75.0 % | 3 of 4 |" in page and "lugre + uneven_stops" in page


def test_all_forms_are_planned_where_they_can_be_seen() -> None:
    cases = plan.forms(2, 100)
    assert {case.hidden for case in cases} == set(lottery.VARIANTS) and {case.kind for case in cases} == {"variant"}
    assert len({case.seed for case in cases}) == len(cases) == 2 * len(lottery.VARIANTS)
    for case in cases:
        assert sealed(case).truth == {case.hidden}


def test_rigs_with_several_faults_are_counted_fault_by_fault(tmp_path: Path) -> None:
    cases = plan.several(2, 100)
    assert len(cases) == 20 and {case.experiment for case in cases} == {"steps", "sweep", "random"}
    assert {case.kind for case in cases} == {"several"} and len({case.seed for case in cases}) == 20
    truth, strength = (
        ("backlash", "cogging", "quadratic_drag"),
        {"backlash": 99.0, "cogging": 31.0, "quadratic_drag": 2.0},
    )
    fields = {"truth": truth, "strength": strength, "case": cases[0], "plant_error": 0.01}
    part = outcome((("backlash", 0.99), ("cogging", 0.5)), **fields)
    false = outcome((("backlash", 0.95), ("hysteresis", 0.93)), extended_floors=7.0, **fields)
    found = {one.what: (one.good, one.total) for one in score.several_faults([part, false])}
    assert found["nothing but noise is left"] == (1, 2) and found["all faults named"] == (0, 2)
    assert found["fault named"] == (3, 6) and found["plain fault named"] == (3, 4)
    assert found["named cause is stated with p > 0.9"] == (3, 4) and found["of these right"] == (2, 3)
    assert found["rig with a false cause with p > 0.9"] == found["verdict `explained` with a false cause"] == (1, 2)
    path = tmp_path / "several.json"
    path.write_text("".join(json.dumps(one.to_json_dict()) + "\n" for one in (part, false)))
    assert main(["--score", str(path), "--docs", str(tmp_path)]) == 0
    page = (tmp_path / "blind-several.md").read_text()
    assert "| cogging | 2 | 2 | 1 | 1 |" in page and "hysteresis 0.930" in page


def test_the_second_author_has_every_fault_alone_and_beside_friction() -> None:
    cases = plan.mujoco(4, 100)
    assert len({case.seed for case in cases}) == len(cases) == 40
    assert {case.kind for case in cases} == {"clean", "single", "beside"}
    assert {case.experiment for case in cases} == set(EXPERIMENTS)
    assert {(c.hidden, c.beside) for c in cases} >= {(name, False) for name in FAULTS}
    for case in cases:
        rig = sealed(case)
        assert set(rig.laws) == rig.truth and len(rig.truth) == (case.hidden is not None) + (case.kind == "beside")


def test_a_rig_of_the_second_author_is_run_and_told(
    asking_about: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that two causes move, of which the record shows both; its intervals stand beside the truth."""
    asking_about("coulomb_friction", "force_gain_nonlinearity", "force_dead_zone", "backlash", "stribeck_friction")
    monkeypatch.setattr(simulate, "STEPS", 5)  # to begin with: steps are halved until that changes nothing
    found = run(Case(511, "dead_zone", True, "steps", 500.0, author="mujoco"))
    assert set(found.truth) == {"coulomb_friction", "force_gain_nonlinearity"} and found.case.kind == "beside"
    assert found.exact and found.without_floors > 2.0
    assert Outcome.from_json_dict(json.loads(json.dumps(found.to_json_dict()))) == found
    for name, value, std, right in found.plant:
        assert value == pytest.approx(right, rel=0.05), name
        assert 0.0 < std < 0.05 * right
    text = "\n".join(told.second_author([found, replace(found, case=replace(found.case, hidden=None), truth=())]))
    assert "| dead_zone and frictionloss | 1 | 1 | 1 | 0 | 1 |" in text
    assert "| interval of mass contains the truth |" in text and "false cause with p > 0.9" in text


def test_exact_sets_are_told_by_kind_and_noise() -> None:
    def one(case: Case, truth: tuple[str, ...], floors: float = 9.0) -> Outcome:
        return outcome((("backlash", 1.0),), truth=truth, case=case, without_floors=floors)

    single = one(Case(1, "backlash", False), ("backlash",))
    beside = one(Case(1, "backlash", True), ("backlash", "coulomb_friction"))
    pair = one(Case(1, "backlash", False, other="cogging"), ("backlash", "cogging"))
    unseen = one(Case(1, "backlash", False, other="cogging"), ("backlash", "cogging"), floors=2.0)
    coloured = one(Case(1, "backlash", False, noise="coloured"), ("backlash",))
    outcomes = [single, beside, pair, unseen, coloured]
    assert figure("exact set, one hidden effect", outcomes) == (1, 1)
    assert figure("exact set, one hidden effect and Coulomb friction", outcomes) == (0, 1)
    assert figure("exact set, two hidden effects, no Coulomb friction", outcomes) == (0, 1)
    assert figure("exact set, coloured noise", outcomes) == (1, 1)
    assert figure("hidden effect not visible: a false cause named", outcomes) == (0, 1)


def test_a_round_has_all_that_the_figures_need() -> None:
    cases = plan.study(2, 5000)
    assert len({case.seed for case in cases}) == len(cases)
    assert {case.kind for case in cases} == {"clean", "single", "beside", "pair", "odd"}
    assert all(case.ranges == "wide" for case in cases)
    pairs = chosen(cases, "pair")
    assert len(pairs) == 24 and all("coulomb_friction" not in (case.hidden, case.other) for case in pairs)
    for noise in ("coloured", "speed"):
        experiments = {case.experiment for case in chosen(cases, f"clean,{noise}")}
        assert experiments == set(lottery.EXPERIMENTS)
        assert any(case.hidden for case in chosen(cases, noise))
    assert chosen(cases, "clean, coloured, ramp") and not chosen(cases, "clean,pair")


def test_a_pair_under_noise_is_run_and_told() -> None:
    """The readings' noise is what the rig made, and the least seen of both effects decides what is visible."""
    case = Case(6001, "quadratic_drag", False, "steps", 200.0, "force_offset", "wide", "speed")
    found = run(case)
    assert set(found.truth) == {"quadratic_drag", "force_offset"} and found.case.kind == "pair"
    assert found.without_floors == pytest.approx(1.0, abs=0.1), "of a force offset a linear spring shows nothing"
    assert Outcome.from_json_dict(json.loads(json.dumps(found.to_json_dict()))) == found
    assert "speed noise" in "\n".join(told.report([replace(found, without_floors=9.0)]))


def test_a_part_of_the_study_leaves_the_documentation_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    outcomes = tmp_path / "outcomes.jsonl"
    outcomes.write_text(json.dumps(outcome((("backlash", 1.0),)).to_json_dict()) + "\n", encoding="utf-8")
    assert main(["--score", str(outcomes), "--only", "steps", "--docs", str(tmp_path)]) == 0
    assert "left as it is" in capsys.readouterr().out and not (tmp_path / "blind-study.md").exists()
    assert main(["--score", str(outcomes), "--docs", str(tmp_path)]) == 0
    assert "exact set, one hidden effect" in (tmp_path / "blind-study.md").read_text(encoding="utf-8")


def test_a_force_that_acts_early_may_be_called_an_offset_or_nothing() -> None:
    lead, other = truth.EARLY_FORCE, "quadratic_drag"
    assert set(truth.same(frozenset({lead, other}))) >= {frozenset({other}), frozenset({other, "time_offset"})}
    assert truth.allowed(frozenset({lead})) >= {"time_offset"} and other not in truth.allowed(frozenset({lead}))


def test_the_stiffness_beyond_a_gap_is_read_from_any_law_of_a_pair_of_stops() -> None:
    """With a form of the stop that has another name for it, right results counted as 70 to 90 % off."""
    pairs = [law for law in LIBRARY if law.cause() == "end_stop" and law.knee and law.knee[2] != OUTSIDE]
    assert {law.knee[1] for law in pairs if law.knee} == set(truth.STIFFNESS_BEYOND["soft_play"])

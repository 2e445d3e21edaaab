"""The loop: it ends with the truth, keeps to limits and budget, and asks before it moves anything."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from designrigs import BENT, LIMITS, STEP, Rig, checked, share

from bench.blind_design import cases
from msd_ident.cli.main import main
from msd_ident.cli.simulated_rig import SimulatedRig
from msd_ident.design import Limits, Profile, Segment
from msd_ident.errors import DataError, UsageError
from msd_ident.report import investigation_page
from msd_ident.workflow import investigation
from msd_ident.workflow.investigation import Budget, Loop, Ran

#: Causes of these tests, and what is likest to be taken for them; asking about the rest costs most of the time.
LIKEST = ("coulomb_friction", "force_gain_nonlinearity", "quadratic_drag", "cubic_spring", "hysteresis", "backlash")


@pytest.mark.xdist_group("bent gain")
def test_the_truth_stands_after_one_more_experiment(
    asking_about: Callable[..., None], looking_for: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    share(monkeypatch)
    checked()  # with all causes, as the other tests have it
    asking_about(*LIKEST)
    looking_for(*LIKEST, "force_offset")
    found = Loop(Rig(**BENT), LIMITS, Budget(2, 60.0)).run(STEP)
    assert found.stands and found.diagnosis.verdict == "explained"
    assert [cause.name for cause in found.diagnosis.causes] == ["force_gain_nonlinearity"]
    assert [step.diagnosis.verdict for step in found.steps] == ["adequate", "explained"]
    assert found.steps[1].purpose.startswith("to see what could hide: ")


def test_a_look_at_what_hides_excites_enough_to_be_certain(
    asking_about: Callable[..., None], looking_for: Callable[..., None], without_copies: None
) -> None:
    """One step leaves friction and a delay uncertain where no copies are made, and so did a second step beside it."""
    asking_about("coulomb_friction", "time_offset", "actuator_lag", "force_gain_nonlinearity")
    looking_for("coulomb_friction", "time_offset", "actuator_lag", "force_gain_nonlinearity")
    found = cases.run(cases.Case(45011, "time_offset", True), False)
    assert found is not None and found.first == ("ambiguous", found.truth)
    assert found.right and found.runs == 1


def test_the_first_push_of_an_unknown_rig_is_gentle() -> None:
    pushes: list[float] = []

    class Watched(Rig):
        def play(self, profile: Profile, limits: Limits) -> object:  # type: ignore[override]
            pushes.append(max(map(abs, profile.extremes)))
            return super().play(profile, limits)

    found = Loop(Watched(), LIMITS, Budget(0, 60.0)).run()  # type: ignore[arg-type]
    assert pushes[0] == pytest.approx(0.05 * 10.0)
    record = found.steps[0].ran.record
    moved = abs(record.position - record.position[0]).max()
    assert 0.3 * 0.03 < moved < 0.03


def test_a_rig_that_sticks_is_pushed_harder_step_by_step(asking_about: Callable[..., None]) -> None:
    """What a stuck cart says about its spring is nothing: its full force might throw it against a stop."""
    asking_about("coulomb_friction")
    pushes: list[float] = []

    class Watched(Rig):
        def play(self, profile: Profile, limits: Limits) -> Ran:
            pushes.append(max(map(abs, profile.extremes)))
            return super().play(profile, limits)

    asked: list[str] = []

    def ask(purpose: str, profile: Profile) -> bool:
        asked.append(purpose)
        return True

    Loop(Watched(coulomb_friction={"coulomb_force": 1.0}), LIMITS, Budget(0, 60.0), ask=ask).run()
    assert pushes[:2] == pytest.approx([0.5, 2.5]) and len(pushes) == len(asked) == 3
    assert asked[:2] == ["a gentle step that sizes the first experiment"] * 2


def test_the_gentle_step_stands_in_the_journal_and_is_told(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    asking_about: Callable[..., None],
) -> None:
    asking_about("coulomb_friction")
    monkeypatch.chdir(tmp_path)
    Path("l.yaml").write_text("force: 10\ntravel: 0.03\nduration: 20\n")
    words = ("--limits", "l.yaml", "--rig", "ecp", "--runs", 0, "--yes", "--out", "story")
    assert run("investigate", *words) == 0
    first, second = capsys.readouterr().out.splitlines()[:2]
    assert first == "trial, a gentle step that sizes the first experiment: 6.3 s -> story/run_1"
    assert second.startswith("1. a first look: ") and second.endswith("-> story/run_2")
    (trial,) = json.loads(Path("story/journal.json").read_text())["trials"]
    assert (trial["bag"], trial["peak_force"], trial["duration_s"]) == ("story/run_1", 0.5, 6.3)
    assert trial["purpose"].startswith("a gentle step") and 0.0 < trial["travel_m"] < 0.002


def test_nothing_runs_unasked_or_beyond_the_limits() -> None:
    rig = Rig()
    with pytest.raises(UsageError, match="the limits allow -10 to 10"):
        Loop(rig, LIMITS).run(STEP.scaled(2.0))
    with pytest.raises(UsageError, match="declined; expected a yes"):
        Loop(rig, LIMITS, ask=lambda purpose, profile: False).run(STEP)
    with pytest.raises(UsageError, match="the gentle step was declined; expected a yes to begin"):
        Loop(rig, LIMITS, ask=lambda purpose, profile: False).run()
    assert rig.runs == 0


def test_each_run_was_asked_for() -> None:
    """The gentle step too: its question shows the very profile that is played next."""
    seen: list[tuple[str, Profile]] = []

    class Watched(Rig):
        def play(self, profile: Profile, limits: Limits) -> Ran:
            seen.append(("played", profile))
            return super().play(profile, limits)

    def ask(purpose: str, profile: Profile) -> bool:
        seen.append((purpose, profile))
        return len(seen) < 3

    with pytest.raises(UsageError, match="the first experiment was declined"):
        Loop(Watched(), LIMITS, ask=ask).run()
    assert [what for what, _ in seen] == ["a gentle step that sizes the first experiment", "played", "a first look"]
    assert seen[0][1] == seen[1][1] and max(seen[0][1].extremes) < 0.1 * max(seen[2][1].extremes)


@pytest.mark.xdist_group("bent gain")
def test_the_budget_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    share(monkeypatch)
    found = Loop(Rig(**BENT), LIMITS, Budget(2, 2.4)).run(STEP)
    assert len(found.steps) == 1 and not found.stands
    assert found.sentence.startswith("the next experiment would take longer than the budget allows")


def test_the_gentle_step_counts_in_the_budget() -> None:
    """After the first experiment there is time for another one only if the gentle step before it took none."""
    limits = Limits((-10.0, 10.0), (-0.03, 0.03), 4.0)
    asked: list[Profile] = []

    def ask(purpose: str, profile: Profile) -> bool:
        asked.append(profile)
        return True

    seconds = 2.0 * (0.3 + 2.0 * 1.3) + 0.1  # for the gentle step and the first experiment, and hardly more
    found = Loop(Rig(force_gain_nonlinearity={"gain_slope": 0.006}), limits, Budget(1, seconds), ask=ask).run()
    assert sum(profile.duration for profile in asked) <= seconds and len(found.steps) == 1
    assert found.sentence.startswith("the next experiment would take longer than the budget allows")


def test_a_gentle_step_that_was_stopped_ends_it() -> None:
    class Stopping(Rig):
        def play(self, profile: Profile, limits: Limits) -> Ran:
            return replace(super().play(profile, limits), stopped="the encoder fell silent: no reading for 0.5 s")

    rig = Stopping()
    with pytest.raises(DataError, match=r"the gentle step of 0\.5 N was stopped: the encoder fell silent.*; expected "):
        Loop(rig, LIMITS).run()
    assert rig.runs == 1


def test_it_ends_where_a_force_may_push_the_mass_away(
    asking_about: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    asking_about("coulomb_friction", "force_offset")
    monkeypatch.setattr(investigation, "signs_doubt", lambda diagnosis: "A regression gives opposite signs")
    rig = Rig(coulomb_friction={"coulomb_force": 1.0})
    found = Loop(rig, LIMITS, Budget(2, 60.0)).run(STEP)
    assert rig.runs == len(found.steps) == 1 and not found.stands
    assert found.sentence.startswith("no further experiment was designed. A regression gives opposite signs: ")


def pushed(force: float) -> tuple[Profile, Limits]:
    """One step of 2.7 s, and limits around it."""
    first = Profile((Segment("hold", 0.3), Segment("step", 2.7, force=force)), "one step")
    return first, Limits((-force, force), (-0.04, 0.04), 20.0)


def designed(probability: float, *names: str) -> Any:
    return SimpleNamespace(probability=probability, names=names)


@pytest.mark.parametrize(
    ("tied", "hidden", "checked", "taken", "purpose"),
    [
        (designed(0.9, "play", "lag"), None, False, "tied", "to tell play from lag"),
        (
            designed(0.05, "play", "lag"),
            designed(0.95, "play", "drag"),
            False,
            "hidden",
            "to see what could hide: drag",
        ),
        (designed(0.05, "play", "lag"), None, False, "tied", "to tell play from lag"),
        (None, designed(0.95, "play", "force_offset"), False, "hidden", "to see what could hide: force_offset"),
        (None, designed(0.95, "play", "force_offset"), True, "tied", ""),
    ],
)
def test_what_hides_is_looked_for_where_no_profile_parts_what_is_tied(
    tied: Any, hidden: Any, checked: bool, taken: str, purpose: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a look that was likely to show it, an offset alone is not worth another."""
    monkeypatch.setattr(investigation, "design", lambda diagnosis, limits: tied)
    monkeypatch.setattr(investigation, "check", lambda diagnosis, limits: hidden)
    loop = Loop(Rig(), LIMITS, Budget(2, 60.0), checked=checked)
    loop.steps.append(SimpleNamespace(diagnosis=None))  # type: ignore[arg-type]
    assert loop._next() == ({"tied": tied, "hidden": hidden}[taken], purpose)
    assert loop.checked == (checked or taken == "hidden")


@pytest.mark.long
def test_where_no_profile_parts_what_is_tied_what_hides_is_looked_for(asking_about: Callable[..., None]) -> None:
    """A short lag looks like a play at first; no experiment within reach tells it from a wrong time of the force."""
    asking_about("backlash", "actuator_lag", "time_offset", "coulomb_friction")
    plant = {"mass": 1.6478, "damping": 2.6452, "stiffness": 1955.2, "friction_coefficient": 0.0, "rate": 1000.0}
    encoder = {"counts_per_metre": 49361.486, "noise": 2.1359e-5}
    rig = Rig(encoder, plant, actuator_lag={"lag_time": 2e-4})
    rig.runs = 5
    first, limits = pushed(26.2325)
    found = Loop(rig, limits, Budget(2, 60.0)).run(first)
    (play,), (lag,), (after,) = (step.diagnosis.causes for step in found.steps)
    assert {play.name, *play.tied_with} == {"backlash", "actuator_lag", "time_offset"}
    assert found.steps[1].purpose.startswith("to tell backlash from ")
    assert {lag.name, *lag.tied_with} == {"actuator_lag", "time_offset"}
    assert found.steps[2].purpose.startswith("to see what could hide: ")
    assert not found.stands and {after.name, *after.tied_with} == {"actuator_lag", "time_offset"}


@pytest.mark.parametrize("asked", [LIKEST, pytest.param((), marks=pytest.mark.long)], ids=["likest", "whole library"])
def test_what_stands_does_so_without_a_further_look(
    asked: tuple[str, ...], asking_about: Callable[..., None], looking_for: Callable[..., None]
) -> None:
    """After a look that was likely to show what hides, another would be a gain; who declines it has an explanation."""
    if asked:
        asking_about(*asked)
        looking_for(*asked, "force_offset", "gravity")
    plant = {"mass": 0.98697, "damping": 1.00719, "stiffness": 235.586, "friction_coefficient": 0.0, "rate": 1000.0}
    encoder = {"counts_per_metre": 1839120.0, "noise": 6.3745e-7}
    effects = {"coulomb_friction": {"coulomb_force": 0.046393}, "force_gain_nonlinearity": {"gain_slope": -0.015}}
    rig = Rig(encoder, plant, **effects)
    rig.runs = 663344472
    force = 1.46568
    parts = (Segment("step", 0.9, force=share * force) for share in (0.2, -0.2, 0.2, 0.0))
    first = Profile((Segment("hold", 0.3), *parts), "small steps")
    asked: list[str] = []

    def twice(purpose: str, profile: Profile) -> bool:
        asked.append(purpose)
        return len(asked) <= 2

    found = Loop(rig, Limits((-force, force), (-0.04, 0.04), 20.0), Budget(2, 60.0), ask=twice).run(first)
    assert len(asked) == 3 and all(purpose.startswith("to see what could hide: ") for purpose in asked[1:])
    assert found.stands and found.sentence.startswith("one explanation stands: ")
    assert [cause.name for cause in found.diagnosis.causes] == ["coulomb_friction", "force_gain_nonlinearity"]


def test_the_story_shows_names_and_runs_none(tmp_path: Path) -> None:
    found = Loop(Rig(), LIMITS, Budget(0, 60.0)).run(STEP)
    attack = "<script>alert(1)</script>"
    step = found.steps[0]
    named = replace(
        step, purpose=attack, profile=replace(step.profile, name=attack),
        ran=replace(step.ran, path=attack, stopped=attack), diagnosis=replace(step.diagnosis, summary=attack),
    )  # fmt: skip
    investigation_page.save(
        replace(found, steps=(named,), sentence=attack, measurements=(attack,)), tmp_path / "story.html"
    )
    page = (tmp_path / "story.html").read_text()
    assert page.count("&lt;script&gt;") >= 7 and "<script" not in page


def run(*words: object) -> int:
    import sys

    kept, sys.argv = sys.argv, ["msd", *map(str, words)]
    try:
        return main()
    finally:
        sys.argv = kept


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("design", "a.csv"), "msd: no limits; expected --limits FILE"),
        (("design", "a.csv", "--limits", "none.yaml"), "msd: cannot read none.yaml: No such file or directory"),
        (("run", "p.yaml"), "msd: cannot read p.yaml: No such file or directory; expected a profile file"),
        (("run", "p.txt"), "msd: p.txt is no profile; expected a file that ends in .yaml or .csv"),
        (("investigate", "--rig", "ecp"), "msd: no limits; expected --limits FILE"),
        (("investigate", "--limits", "l.yaml", "--effect", "backlash"), "msd: --effect without --rig"),
        (("investigate", "--limits", "l.yaml", "--rig", "nowhere", "--yes"), "msd: no rig"),
        (("run", "big.yaml", "--limits", "l.yaml"), "msd: profile 'big' pushes from 0 to 99 N, the limits allow -10"),
    ],
)
def test_bad_input(
    words: tuple[str, ...],
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("l.yaml").write_text("force: 10\ntravel: 0.03\nduration: 20\n")
    Path("big.yaml").write_text("name: big\nsegments: [{kind: step, duration: 1, force: 99}]\n")
    assert run(*words) == 2
    said = capsys.readouterr().err.strip()
    assert said.startswith(line) and "\n" not in said


@pytest.mark.parametrize("asked", [LIKEST, pytest.param((), marks=pytest.mark.long)], ids=["likest", "whole library"])
def test_investigate_and_design_by_command(
    asked: tuple[str, ...],
    asking_about: Callable[..., None],
    looking_for: Callable[..., None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if asked:
        asking_about(*asked)
        looking_for(*asked, "force_offset")
    monkeypatch.chdir(tmp_path)
    Path("l.yaml").write_text("force: 10\ntravel: 0.03\nduration: 20\n")
    pushes = "".join(f"  - {{kind: step, duration: 0.8, force: {force}}}\n" for force in (8, -8, 3, -3, 0))
    Path("p.yaml").write_text(f"name: pushes\nsegments:\n{pushes}")
    words = ("--limits", "l.yaml", "--rig", "ecp", "--first", "p.yaml", "--runs", 1, "--yes", "--out", "story")
    assert run("investigate", *words) == 0
    journal = json.loads(Path("story/journal.json").read_text())
    assert journal["stands"] and 1 <= len(journal["steps"]) <= 2
    assert [c["name"] for c in journal["diagnosis"]["causes"]] == ["coulomb_friction"]
    assert all(Path(step["bag"]).is_dir() for step in journal["steps"])
    assert "<h1>Investigation</h1>" in Path("story/report.html").read_text()
    capsys.readouterr()
    bag = journal["steps"][0]["bag"]
    assert run("design", bag, "--limits", "l.yaml", "--json", "-") == 0
    told = json.loads(capsys.readouterr().out)
    assert told["verdict"] == "explained" and told["next_experiment"] is None
    words = ("design", bag, "--limits", "l.yaml", "--check", "--out", "n.yaml", "--figure", "n.png", "--quiet")
    assert run(*words) == 0
    assert Path("n.yaml").read_text().startswith("# Play ") and Path("n.png").stat().st_size > 10_000


def _raising(error: BaseException) -> Callable[..., Any]:
    def fail(*given: object, **named: object) -> Any:
        raise error

    return fail


@pytest.mark.parametrize(
    ("where", "error", "code", "said"),
    [
        (
            "_next",
            KeyboardInterrupt(),
            130,
            "interrupted; 1 experiment in the journal: story/journal.json, report: story/report.html",
        ),
        ("_next", DataError("the rig is gone"), 2, "the rig is gone"),
        (
            "diagnose",
            KeyboardInterrupt(),
            130,
            "interrupted; no experiment was diagnosed; the bags are kept: msd diagnose story/run_1",
        ),
        ("play", KeyboardInterrupt(), 130, "interrupted; no experiment was finished, and story is empty"),
    ],
)
def test_what_ends_early_leaves_what_is_done(
    where: str,
    error: BaseException,
    code: int,
    said: str,
    asking_about: Callable[..., None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    asking_about("coulomb_friction")
    place = {"_next": Loop, "diagnose": investigation.pipeline, "play": SimulatedRig}[where]
    monkeypatch.setattr(place, where, _raising(error))
    monkeypatch.chdir(tmp_path)
    Path("l.yaml").write_text("force: 10\ntravel: 0.03\nduration: 20\n")
    Path("p.yaml").write_text("name: push\nsegments:\n  - {kind: step, duration: 0.8, force: 8}\n")
    words = ("--limits", "l.yaml", "--rig", "ecp", "--first", "p.yaml", "--yes", "--out", "story", "--quiet")
    assert run("investigate", *words) == code
    assert capsys.readouterr().err == f"msd: {said}\n"
    assert Path("story/report.html").exists() is Path("story/journal.json").exists() is (where == "_next")
    if where == "_next":
        journal = json.loads(Path("story/journal.json").read_text())
        assert len(journal["steps"]) == 1 and not journal["stands"]
        assert journal["sentence"].startswith(f"{str(error) or 'interrupted'}: ")


def test_without_yes_the_command_asks_before_anything_moves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.stdin", io.StringIO("n\n"))
    Path("l.yaml").write_text("force: 10\ntravel: 0.03\nduration: 20\n")
    assert run("investigate", "--limits", "l.yaml", "--rig", "ecp", "--out", "story") == 2
    told = capsys.readouterr()
    question = "Run 'step and release' (a gentle step that sizes the first experiment): 6.3 s, 0 to 0.5 N?"
    assert question in told.out and "msd: the gentle step was declined; expected a yes to begin" in told.err
    assert not list(Path("story").iterdir())


def test_a_run_that_was_stopped_too_soon_says_so() -> None:
    class Stopping(Rig):
        def play(self, profile: Profile, limits: Limits) -> Ran:
            ran = super().play(profile, limits)
            return Ran(ran.record.window(0.0, 0.25), "", "the encoder fell silent: no reading for 0.5 s")

    with pytest.raises(DataError, match=r"'one step' was stopped: the encoder fell silent.*; what was recorded: "):
        Loop(Stopping(), LIMITS).run(STEP)

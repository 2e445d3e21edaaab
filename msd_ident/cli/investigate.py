"""``msd investigate``: experiments, one after the other, until one explanation stands."""

from __future__ import annotations

import json as text
import shlex
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from msd_ident.cli import groups, options, results
from msd_ident.errors import Interrupted, MsdError, UsageError
from msd_ident.quantity import counted
from msd_ident.writing import write_text

if TYPE_CHECKING:
    from msd_ident.design import Profile
    from msd_ident.workflow.investigation import Investigation, Loop, Rig, Step, Trial

EffectOption = Annotated[
    list[str] | None,
    options.rig_option(
        "--effect", metavar="NAME[:PARAMETER=NUMBER,…]", help="effect that the simulated rig has; repeatable"
    ),
]


OutOption = Annotated[
    Path, options.output_option("--out", metavar="FOLDER", help="new folder for bags, journal and report")
]
RigOption = Annotated[
    str, options.rig_option("--rig", metavar="NAME|FILE", help="simulated rig; default: the rig of the ROS graph")
]
FirstOption = Annotated[
    Path | None,
    options.model_option(
        "--first", metavar="PROFILE", help="first experiment; default: a force step, sized by a gentle trial"
    ),
]
RunsOption = Annotated[int, options.model_option(min=0, max=20, help="greatest number of experiments after the first")]
SecondsOption = Annotated[
    float, options.model_option(min=1.0, help="greatest total duration of all experiments, in seconds")
]


@groups.grouped("json", "quiet")
def investigate(
    limits: options.LimitsOption = None,
    out: OutOption = Path("investigation"),
    rig: RigOption = "",
    effect: EffectOption = None,
    seed: Annotated[int, options.rig_option(help="seed of the simulated encoder noise")] = 0,
    first: FirstOption = None,
    runs: RunsOption = 2,
    seconds: SecondsOption = 120.0,
    yes: Annotated[bool, options.rig_option("--yes", help="do not ask before each run")] = False,
    namespace: options.NamespaceOption = "msd",
    silence: options.SilenceOption = 0.5,
    lead: options.LeadOption = 0.05,
    *,
    output: results.Output,
) -> int:
    """Run, diagnose and design experiments in a loop until one explanation remains."""
    from msd_ident.design import read_profile
    from msd_ident.workflow import investigation

    output.check()
    allowed = options.limits_of(limits)
    begin = read_profile(first) if first else None
    if begin is not None:
        allowed.check(begin)
    if out.exists():
        raise UsageError(f"{out} exists; expected a new folder: give another --out")
    results.make_folder(out)
    ask = investigation.always if yes else asking()
    tell = _telling(out, output.tables)
    budget = investigation.Budget(runs, seconds)
    with _rig(rig, effect or [], seed, out, (namespace, silence, lead)) as found_rig:
        loop = investigation.Loop(found_rig, allowed, budget, ask=ask, tell=tell)
        with _keeping(loop, out):
            found = loop.run(begin)
    _write(found, out)
    results.write([{"path": str(out), **found.to_json_dict()}], output)
    if output.tables:
        _print(found, out)
    return 0


@contextmanager
def _keeping(loop: Loop, out: Path) -> Iterator[None]:
    """Journal and report of the experiments that are done, where an investigation is interrupted or refused.

    Raises:
        Interrupted: by Ctrl-C, with what is kept.
    """
    try:
        yield
    except MsdError as error:
        _write_early(loop, out, str(error))
        raise
    except (KeyboardInterrupt, typer.Abort):
        _write_early(loop, out, "interrupted")
        raise Interrupted(_kept(len(loop.steps), out)) from None


def _write_early(loop: Loop, out: Path, why: str) -> None:
    if loop.steps:
        _write(loop.ended(False, why), out)


def _kept(done: int, out: Path) -> str:
    """What an interrupted investigation leaves."""
    if done:
        return f"{counted(done, 'experiment')} in the journal: {out / 'journal.json'}, report: {out / 'report.html'}"
    bags = [str(bag) for bag in sorted(out.glob("run_*"))]
    if not bags:
        return f"no experiment was finished, and {out} is empty"
    return f"no experiment was diagnosed; the bags are kept: msd diagnose {shlex.join(bags)}"


@contextmanager
def _rig(name: str, effects: list[str], seed: int, out: Path, graph: tuple[str, float, float]) -> Iterator[Rig]:
    if name:
        from msd_ident.cli.simulate import _rig, effects_of
        from msd_ident.cli.simulated_rig import SimulatedRig

        spec: dict[str, Any] = {"rig": name, "effects": effects_of(effects)}
        yield SimulatedRig(_rig(), spec, out, seed)
        return
    if effects:
        raise UsageError("--effect without --rig; expected a simulated rig for it: the graph's rig has its own")
    from msd_ident.cli.needs_ros import require_ros
    from msd_ident.cli.run import stopped_by_signals

    require_ros("msd investigate")
    from msd_ident.ros.experimenter.session import GraphRig, conductor

    with conductor(*graph) as made, stopped_by_signals() as stop:
        yield GraphRig(made, out, stop, lambda part, force, at: None)


def asking() -> Callable[[str, Profile], bool]:
    """Ask on the terminal before each run."""

    def ask(purpose: str, profile: Profile) -> bool:
        low, high = profile.extremes
        return typer.confirm(
            f"Run {profile.name!r} ({purpose}): {profile.duration:.1f} s, {low:.3g} to {high:.3g} {profile.unit}?"
        )

    return ask


def _telling(out: Path, tables: bool) -> Callable[[Step | Trial], None]:
    """Tell each step on the terminal; its profile goes into the folder."""
    from msd_ident.design import write_profile
    from msd_ident.workflow.investigation import Trial

    count = 0

    def tell(step: Step | Trial) -> None:
        """Keep a step's profile and say what it showed."""
        nonlocal count
        if isinstance(step, Trial):
            if tables:
                print(f"trial, {step.purpose}: {step.profile.duration:.1f} s -> {step.ran.path}")
            return
        count += 1
        write_profile(step.profile, out / f"profile_{count}.yaml", (step.purpose,))
        if tables:
            print(f"{count}. {step.purpose}: {step.profile.name}, {step.profile.duration:.1f} s -> {step.ran.path}")
            print(f"   {step.ran.stopped or step.diagnosis.summary}")

    return tell


def _write(found: Investigation, out: Path) -> None:
    """Journal and report."""
    from msd_ident.report import investigation_page

    journal = results.jsonable(found.to_json_dict())
    write_text(text.dumps(journal, ensure_ascii=False, indent=1) + "\n", out / "journal.json")
    investigation_page.save(found, out / "report.html")


def _print(found: Investigation, out: Path) -> None:
    print(found.sentence)
    for sentence in found.measurements:
        print(f"measure: {sentence}")
    print(f"journal: {out / 'journal.json'}, report: {out / 'report.html'}")

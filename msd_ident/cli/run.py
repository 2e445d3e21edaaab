"""``msd run``: play a profile on the rig of the graph, watched and recorded."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Annotated

from msd_ident.cli import groups, options, progress, results
from msd_ident.errors import Interrupted, UsageError

OutOption = Annotated[Path | None, options.output_option("--out", metavar="FOLDER", help="bag to record")]
ResetOption = Annotated[bool, options.rig_option("--reset", help="first call rig/reset, if it exists")]


@groups.grouped("json", "quiet")
def run(
    profile: Annotated[Path, options.path_argument(metavar="PROFILE", help=".yaml or .csv file of msd design")],
    limits: options.LimitsOption = None,
    out: OutOption = None,
    namespace: options.NamespaceOption = "msd",
    silence: options.SilenceOption = 0.5,
    lead: options.LeadOption = 0.05,
    reset: ResetOption = False,
    *,
    output: results.Output,
) -> int:
    """Play a profile on the rig and record it; force 0 at a limit, without encoder samples, or on Ctrl-C."""
    from msd_ident.cli.needs_ros import require_ros
    from msd_ident.design import read_profile

    output.check()
    wanted = read_profile(profile)
    allowed = options.limits_of(limits)
    allowed.check(wanted)
    bag = out or Path(f"{profile.stem}_bag")
    if bag.exists():
        raise UsageError(f"{bag} exists; expected a new folder for the bag: give another --out")
    results.check_targets(False, bag)
    require_ros("msd run")
    from msd_ident.ros.experimenter.profile_player import CANCELLED, Experiment
    from msd_ident.ros.experimenter.session import conductor

    with (
        conductor(namespace, silence, lead) as played_by,
        stopped_by_signals() as stop,
        progress.stages(output.quiet) as report,
    ):
        done = played_by.play(
            Experiment(wanted, allowed, bag, reset),
            stop,
            lambda part, force, at: report(f"{force:.3g} {wanted.unit}, {at:.4g} m", part),
        )
    line = {
        "schema": "msd.run/1", "path": str(done.bag), "stopped": done.stopped, "commands": done.commands,
        "worst_delay_s": done.worst, "mean_delay_s": done.mean,
        "late_at_rig": done.late.count, "worst_late_at_rig_s": done.late.worst,
    }  # fmt: skip
    results.write([line], output)
    if output.tables:
        print(done.sentence)
    kept = f"the force is 0 and {done.bag} holds what was recorded until then"
    if done.stopped == CANCELLED:
        raise Interrupted(kept)
    if done.stopped:
        raise UsageError(f"{done.stopped}; {kept}")
    return 0


@contextmanager
def stopped_by_signals() -> Iterator[threading.Event]:
    """An event that Ctrl-C, SIGTERM and SIGHUP set, so that the force goes to 0 before anything ends."""
    from msd_ident.ros.common.signals import ENDING, handled

    stop = threading.Event()

    def ask(number: int, frame: FrameType | None) -> None:
        stop.set()

    with handled(ask, *ENDING):
        yield stop

"""``msd demo``: rig, recorder and identifier over real ROS 2, the paper's experiment, its tables and figures."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.ros.demo.demo import Shown


def demo(
    fast: Annotated[bool, typer.Option("--fast/--real-time", help="run simulated time faster than real time")] = False,
    out: Annotated[Path, typer.Option(help="folder for the folder of the demo")] = Path("out"),
) -> int:
    """Run the whole pipeline over ROS 2: a simulated rig, a recorded bag, and the identified model."""
    from rich.console import Console

    from msd_ident.cli.needs_ros import require_ros
    from msd_ident.io.new_folder import dated_folder

    require_ros("msd demo")
    console = Console()
    with _ended_by_signals():
        folder = dated_folder(out, "demo")
        with _progress(console) as say:
            from msd_ident.ros.demo.demo import run

            shown = run(folder, fast, say)
        _show(shown, folder, console)
    return 0


def _show(shown: Shown, folder: Path, console: Console) -> None:
    from msd_ident.report import figures, tables

    found = shown.found
    tables.print_identification(found, console)
    console.print(f"SEE {found.paper_see_reduction_percent:.1f} % less by the paper's path (friction raised),")
    console.print(f"SEE {found.see_reduction_percent:.1f} % less by the joint refit.")
    console.print(f"Service and bag agree to the last digit, live buffer and bag to {shown.live_difference:.1e}.")
    console.print(shown.recorded, soft_wrap=True, highlight=False)
    for path in figures.save(found, folder):
        if path.suffix == ".png":  # the SVG lies beside it
            console.print(f"figure: {path}", soft_wrap=True, highlight=False)
    console.print(f"bag:    {shown.bag}", soft_wrap=True, highlight=False)


@contextmanager
def _progress(console: Console) -> Iterator[Callable[[str, float], None]]:
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (BarColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda stage, done: bar.update(task, description=stage, completed=done)


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Make SIGTERM and SIGHUP unwind the stack as Ctrl-C does, so that everything started is ended."""

    from msd_ident.ros.common.signals import handled

    def unwind(number: int, frame: FrameType | None) -> None:
        sys.exit(128 + number)

    with handled(unwind, signal.SIGTERM, signal.SIGHUP):
        yield

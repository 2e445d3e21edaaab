"""``python -m bench.live``: processor time and memory of the live view, a rig running and a page open.

python -m bench.live [--seconds 600] [--rate 1000] [--json FILE]
python -m bench.live --picture FILE.png       # a picture instead

Processor time is that of the live view's process alone (user and system), so other work on the machine does not count;
the frames that the page got are counted, since a page that gets none costs nothing.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident.ros.demo.demo import arguments
from msd_ident.ros.demo.live_demo import demo_graph

CHROMIUM = "/usr/bin/chromium"
#: A step or its end comes this often [s].
STEP_PERIOD = 5.0
#: The beginning that does not count: libraries are loaded, the minute that is kept is filled for the first time [s].
WARM_UP = 180.0
TICK, PAGE = os.sysconf("SC_CLK_TCK"), os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True)
class Sample:
    """An instant: wall [s], processor time [s] of view and browser, memory of the view [MiB], frames so far."""

    wall: float
    view: float
    browser: float
    memory: float
    frames: int


def processor(pid: int) -> float:
    """User and system time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def memory(pid: int) -> float:
    """Resident memory [MiB]."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE / 2**20


def family(pid: int) -> list[int]:
    """A process and all below it."""
    found, children = [], [pid]
    while children:
        found.append(children.pop())
        for task in Path(f"/proc/{found[-1]}/task").glob("*/children"):
            children += map(int, task.read_text().split())
    return found


def summary(samples: list[Sample], warm_up: float) -> dict[str, float]:
    """The figures, of what comes after the warm-up."""
    counted = [sample for sample in samples if sample.wall >= warm_up]
    wall = np.array([sample.wall for sample in counted])
    used = np.array([sample.memory for sample in counted])
    first, last = counted[0], counted[-1]
    seconds = last.wall - first.wall
    return {
        "seconds": seconds,
        "view_percent_of_a_core": 100.0 * (last.view - first.view) / seconds,
        "browser_percent_of_a_core": 100.0 * (last.browser - first.browser) / seconds,
        "frames_a_second": (last.frames - first.frames) / seconds,
        "memory_first_mib": first.memory,
        "memory_last_mib": last.memory,
        "memory_most_mib": float(used.max()),
        "memory_slope_mib_an_hour": 3600.0 * float(np.polyfit(wall, used, 1)[0]),
    }


@contextmanager
def page(url: str) -> Iterator[Any]:
    """The live view in a headless browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        options = ["--no-sandbox", "--disable-gpu"]
        browser = player.chromium.launch(executable_path=CHROMIUM, args=options)
        try:
            opened = browser.new_page(viewport={"width": 1400, "height": 900})
            opened.set_default_timeout(300_000)  # of a busy machine [ms]
            opened.goto(url)
            opened.get_by_text("samples per second").wait_for(timeout=120_000)
            yield opened
        finally:
            browser.close()


def watch(opened: Any, view: int, seconds: float, say: Callable[[str], None]) -> list[Sample]:
    """Push and release the rig, and look at the processes once a second."""
    samples: list[Sample] = []
    start, before, frames = time.monotonic(), 0, 0
    browser = _chromium()
    pushed = 0.0
    while (now := time.monotonic() - start) < seconds:
        if now - pushed >= STEP_PERIOD:
            pushed = now
            opened.locator("main").get_by_role("button", name="Step").or_(
                opened.locator("main").get_by_role("button", name="Release")
            ).click()
        opened.wait_for_load_state()  # a page that had no answer for long loads itself anew, and counts anew
        shown = int(opened.evaluate("document.body.dataset.frames ?? 0"))
        before, frames = shown, frames + (shown - before if shown >= before else shown)
        used = sum(processor(pid) for pid in family(browser))
        samples.append(Sample(now, processor(view), used, memory(view), frames))
        if len(samples) % 30 == 0:
            say(f"{now:.0f} s: {memory(view):.1f} MiB, {frames} frames")
        time.sleep(1.0)
    return samples


def picture(opened: Any, place: Path) -> None:
    """Push the rig both ways, let it be diagnosed, and take a picture in the midst of another swing."""

    def press(name: str) -> None:
        opened.locator("main").get_by_role("button", name=name, exact=True).click()

    def push(force: float, seconds: float) -> None:
        opened.get_by_label("Force of the step").fill(f"{force:g}")
        opened.keyboard.press("Tab")
        press("Step")
        opened.get_by_role("button", name="Release", exact=True).wait_for()
        opened.wait_for_timeout(1000.0 * seconds)
        press("Release")
        opened.get_by_role("button", name="Step", exact=True).wait_for()

    for force in (10.0, -4.0):
        push(force, 2.0)
        opened.wait_for_timeout(2000)
    opened.get_by_text("viscous damping").wait_for(timeout=120_000)
    press("Diagnose")
    opened.get_by_role("button", name="Cancel", exact=True).wait_for()
    opened.get_by_role("button", name="Diagnose", exact=True).wait_for()
    push(10.0, 2.0)
    opened.wait_for_timeout(1500)
    opened.screenshot(path=place, full_page=True)


def _chromium() -> int:
    """The browser's first process, below this one."""
    for pid in family(os.getpid()):
        if "chromium" in Path(f"/proc/{pid}/cmdline").read_text().split("\0")[0]:
            return pid
    raise RuntimeError("no chromium below this process")


def _url(log: Path) -> str:
    """Where the page is, from what the node says."""
    deadline = time.monotonic() + 120.0
    while time.monotonic() < deadline:
        _, found, rest = log.read_text().partition("live view at ")
        if found and "\n" in rest:
            return rest.split()[0]
        time.sleep(0.1)
    raise RuntimeError(f"the live view did not start: {log.read_text()}")


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--rate", type=float, default=1000.0)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--picture", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as place, demo_graph(Path(place), given.rate) as processes:
        processes.start("live", "msd_ident.ros.live", arguments({"port": 0}))
        log = Path(place) / "live.log"
        with page(_url(log)) as opened:
            if given.picture:
                picture(opened, given.picture)
                return 0
            samples = watch(opened, processes.pid("live"), given.seconds, lambda line: print(line, file=sys.stderr))
    found = summary(samples, min(WARM_UP, given.seconds / 3.0))
    for name, value in found.items():
        print(f"{name:<28} {value:10.2f}")
    if given.json:
        given.json.write_text(json.dumps({**found, "samples": [asdict(s) for s in samples]}))
    return 0


if __name__ == "__main__":
    sys.exit(main())

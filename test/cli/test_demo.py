"""``msd demo``: the whole way over real ROS 2, and that nothing of it stays behind."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="no ROS 2 here")

from graph import until  # noqa: E402

from msd_ident.io import open_bag, read  # noqa: E402
from msd_ident.workflow import pipeline  # noqa: E402


class Demo:
    """A running demo; everything that it starts inherits a mark in the environment."""

    def __init__(self, out: Path, *options: str) -> None:
        self.mark = uuid.uuid4().hex
        command = [sys.executable, "-m", "msd_ident.cli.main", "demo", "--out", str(out), *options]
        environment = {**os.environ, "MSD_DEMO_TEST": self.mark, "COLUMNS": "120"}
        self.process = subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    def others(self) -> dict[str, int]:
        """Processes that it has started and that still run, by their module."""
        found = {}
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit() and int(entry.name) != self.process.pid:
                try:
                    if f"MSD_DEMO_TEST={self.mark}".encode() in (entry / "environ").read_bytes():
                        words = (entry / "cmdline").read_bytes().decode().split("\0")
                        found[words[2] if len(words) > 2 else words[0]] = int(entry.name)
                except OSError:
                    continue  # it has just ended
        return found

    @property
    def ended(self) -> bool:
        """Whether the demo itself has ended."""
        return self.process.poll() is not None

    def end(self) -> tuple[int, str, str]:
        """Exit code, output and errors, once it has ended and nothing of it runs any more."""
        output, errors = self.process.communicate(timeout=280.0)
        until(lambda: not self.others(), "the end of what the demo started", 10.0)
        return self.process.returncode, output, errors


@contextmanager
def demo(out: Path, *options: str) -> Iterator[Demo]:
    made = Demo(out, *options)
    try:
        yield made
    finally:
        made.process.kill()
        for number in made.others().values():
            os.kill(number, signal.SIGKILL)


def all_up(running: Demo) -> bool:
    """Whether rig, recorder and identifier run."""
    modules = {"msd_sim.node", "msd_ident.ros.recorder", "msd_ident.ros.identifier"}
    return modules <= set(running.others()) or running.ended


@pytest.mark.timeout(300)  # it compiles on a machine that never ran it
def test_a_demo_finds_the_rig_while_another_records_and_is_interrupted_and_both_leave_nothing(tmp_path: Path) -> None:
    with demo(tmp_path, "--fast") as one, demo(tmp_path, "--fast") as two:
        until(lambda: len(list(tmp_path.glob("*/paper"))) == 2 or one.ended or two.ended, "both record", 240.0)
        os.kill(two.process.pid, signal.SIGINT)
        code, _, errors = two.end()
        assert (code, errors) == (130, "msd: interrupted\n")
        code, output, errors = one.end()
    assert code == 0 and not errors, errors
    for words in ("Features (Table 1)", "Standard form (Table 2)", "Physical parameters (Table 3)", "SEE reduction"):
        assert words in output
    assert "Service and bag agree to the last digit" in output and "none lost" in output
    figures = re.findall(r"^figure: (.+)$", output, re.M)
    assert len(figures) == 3 and all(Path(figure).stat().st_size > 10_000 for figure in figures)
    (bag,) = re.findall(r"^bag: +(.+)$", output, re.M)
    assert set(open_bag(bag).topics) == {"/msd/force", "/msd/encoder_batch", "/msd/identifier/estimate"}
    found = pipeline.identify([read(bag)])
    recovered = {name: quantity.value for name, quantity in found.refined.parameters.items()}
    assert recovered["mass"] == pytest.approx(0.9407, rel=1e-3)
    assert recovered["stiffness"] == pytest.approx(694.1, rel=1e-3)
    assert recovered["damping"] == pytest.approx(3.927, rel=1e-2)
    assert recovered["friction_coefficient"] == pytest.approx(0.0133, rel=1e-2)
    assert found.refined.see < 1.5 * found.noise_floor


def test_a_killed_demo_leaves_nothing_either(tmp_path: Path) -> None:
    with demo(tmp_path) as running:
        until(lambda: all_up(running), "rig, recorder and identifier")
        running.process.kill()
        assert running.end()[0] == -signal.SIGKILL


def test_a_demo_whose_rig_dies_says_so_and_ends_the_others(tmp_path: Path) -> None:
    with demo(tmp_path) as running:
        until(lambda: all_up(running), "rig, recorder and identifier")
        os.kill(running.others()["msd_sim.node"], signal.SIGKILL)
        code, _, errors = running.end()
    assert code == 2
    assert re.fullmatch(r"msd: rig ended with code -9: .*; expected it to run: see .*rig\.log\n", errors), errors


def test_a_place_that_takes_no_folder_is_refused_in_words(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with demo(tmp_path / "file") as running:
        code, _, errors = running.end()
    assert code == 2 and errors.startswith(f"msd: cannot make {tmp_path / 'file'}") and errors.count("\n") == 1

"""An effect is one file: a new one in a copy of the package goes through all of it with nothing else touched."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

# The solver is compiled for it: seconds on a free core, minutes on a busy machine.
pytestmark = [pytest.mark.xdist_group("new effect"), pytest.mark.timeout(600)]

#: Damping that no law of the library has: it grows with the way out.
EFFECT = '''"""Damping that grows with the way out."""

from __future__ import annotations

import math
from dataclasses import dataclass

from msd_ident.model.effects import typical
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import DRAGS
from msd_ident.model.declarations import Parameter


def _outward(v, x):
    """x²·v [m³/s]."""
    return x * x * v


@dataclass(frozen=True)
class OutwardDamping(Effect):
    """c·x²·v: an eddy-current brake on either side of the middle."""

    outward_coefficient: float

    name = "outward_damping"
    parameters = (
        Parameter(
            "outward_coefficient", "c", "N·s/m³", 0.0, math.inf, "damping beyond the middle",
            advice="let it ring down from far out", most=1e3, regressor=_outward,
        ),
    )
    acts_on = "force"
    law = "c·x²·v"
    source = "B. van der Pol 1926, with the sign of a brake"
    neutral = (("outward_coefficient", 0.0),)
    dissipative = True
    ring_down = {DRAGS: (1,)}
    measured_by = "hold a magnet beside the cart"

    @staticmethod
    def force(x: float, v: float, outward_coefficient: float) -> float:
        """Drag [N]."""
        return outward_coefficient * x * x * v

    @classmethod
    def guess(cls, record, plant):
        """As strong at top speed and full way as a twentieth of the largest force."""
        reach = typical.amplitude(record) ** 2 * typical.speed(record)
        return (cls(0.05 * typical.force(record, plant) / reach),)

    def same_as(self, model):
        """Of small motions."""
        return "Close to the middle a brake on either side is no brake."
'''
#: The rig's [N·s/m³], beside a mass of 1 kg on 400 N/m.
STRENGTH = 2e4

#: A measurement of such a rig: steps both ways, read by an encoder with noise.
RIG = f"""
import numpy as np
from msd_ident.data.record import Record
from msd_ident.io.csv_file import write_csv
from msd_ident.model import Plant, simulate
from msd_ident.model.effects import by_name

time = np.arange(2400) / 400.0
force = np.select([time < 0.2, time < 1.7, time < 3.2, time < 4.7], [0.0, 10.0, 0.0, -6.0], 0.0)
plant = Plant(1.0, 2.0, 400.0) + by_name("outward_damping")({STRENGTH!r})
given = Record(time=time, position=0.0 * time, force_time=time, force=force)
read = simulate(plant, given).position + np.random.default_rng(1).normal(0.0, 5e-6, time.size)
write_csv(Record(time=time, position=read, force_time=time, force=force), "rig.csv")
"""

#: All that is done with it, in one process: it loads the copy and compiles its solver once.
WORK = """
import sys
from contextlib import redirect_stdout

import effect_pages
import export_tables

from msd_ident.cli.main import main

def msd(*words, to="said.txt"):
    sys.argv = ["msd", *words]
    with open(to, "w") as file, redirect_stdout(file):
        assert main() == 0, words

msd("identify", "rig.csv", "--json", "-", to="identified.json")
msd("diagnose", "rig.csv", "--json", "rig.json", "--report", "rig.html", "--markdown", "rig.md")
options = ("--limits", "limits.yaml", "--for", "outward_coefficient")
msd("design", "rig.csv", *options, "--json", "-", to="designed.json")
msd("export", "rig.json", "--to", "python", "--out", "exported.py")
with open("effect.md", "w") as file:
    file.write(effect_pages.pages()["effects/outward_damping.md"])
with open("exports.md", "w") as file:
    file.write(export_tables.written("all"))
"""


@pytest.fixture(scope="module")
def workshop(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a copy of the package that has the new effect's file, and all that was done with it there."""
    folder = tmp_path_factory.mktemp("workshop")
    unfinished = shutil.ignore_patterns("*.tmp.*", "*.pyc.*")  # what others compile just now; what they have is taken
    shutil.copytree(repository / "msd_ident", folder / "msd_ident", ignore=unfinished)
    (folder / "msd_ident" / "model" / "effects" / "outward_damping.py").write_text(EFFECT, encoding="utf-8")
    (folder / "limits.yaml").write_text("force: 10\ntravel: 0.05\nduration: 10\n", encoding="utf-8")
    paths = (folder, repository, repository / "docs" / "generate")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths))}
    done = subprocess.run(
        [sys.executable, "-c", RIG + WORK], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_identification_finds_something_missing(workshop: Path) -> None:
    plain = json.loads((workshop / "identified.json").read_text(encoding="utf-8"))
    assert any("the model lacks something" in sentence for sentence in plain["warnings"])


def test_diagnosis_names_it_on_every_page(workshop: Path) -> None:
    diagnosis = json.loads((workshop / "rig.json").read_text(encoding="utf-8"))
    (cause,) = diagnosis["causes"]
    assert cause["name"] == "outward_damping" and diagnosis["verdict"] == "explained"
    assert cause["parameters"]["outward_coefficient"]["value"] == pytest.approx(STRENGTH, rel=0.02)
    assert "Close to the middle a brake on either side is no brake." in diagnosis["warnings"]
    for page in ("rig.html", "rig.md"):
        assert "outward damping" in (workshop / page).read_text(encoding="utf-8")


def test_a_design_sharpens_it(workshop: Path) -> None:
    designed = json.loads((workshop / "designed.json").read_text(encoding="utf-8"))
    expected = designed["next_experiment"]["expected"]["outward_coefficient"]
    assert 0.0 < expected["half_interval_after"] < expected["half_interval_now"]


def test_an_export_carries_it(workshop: Path) -> None:
    assert "force_of_outward_damping" in (workshop / "exported.py").read_text(encoding="utf-8")


def test_the_documentation_has_its_page(workshop: Path) -> None:
    said = (workshop / "effect.md").read_text(encoding="utf-8")
    assert "# outward_damping" in said and "let it ring down from far out" in said
    assert "[outward_damping](effects/outward_damping.md)" in (workshop / "exports.md").read_text(encoding="utf-8")

"""Tables and pictures of an identification hold its numbers and fit 80 columns."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from reportrigs import identified
from rich.console import Console

from msd_ident.io import SourceOptions, read
from msd_ident.report import figures, tables
from msd_ident.report.thinning import spread, thinned
from msd_ident.workflow.identification import Identification
from msd_ident.workflow.pipeline import identify

pytestmark = pytest.mark.xdist_group("report")

BAGS = Path(__file__).resolve().parents[2] / "bags"
KINDS = ("png", "svg")


@pytest.fixture(scope="module", params=["paper_step", "release"])
def found(request: pytest.FixtureRequest) -> Identification:
    return identify([read(BAGS / request.param, SourceOptions())])


def printed(found: Identification) -> str:
    console = Console(width=80, record=True, file=open("/dev/null", "w"))  # noqa: SIM115 - rich closes nothing
    tables.print_identification(found, console)
    return console.export_text()


def test_tables_fit_80_columns_and_nothing_is_cut(found: Identification) -> None:
    text = printed(found)
    assert max(map(len, text.splitlines())) <= 80
    assert "…" not in text.replace(" … ", "")


LONG = [
    ("mass", "1.30000000 ± 0.00000015", "1.30000000 ± 0.00000015", "kg"),
    ("drag position of the first", "0.020000175 ± 0.000000123", "0.005527 to 0.006012", "N·s²/m²"),
    ("SEE on left-out data", "6.156e-08", "6.156e-08", "noise floors"),
]


@pytest.mark.parametrize("width", [80, 60])
def test_what_is_too_wide_for_a_cell_goes_on_below(width: int) -> None:
    table = tables.new_table("Models, ± 95 %", "", "base", "extended", "unit")
    for row in LONG:
        table.add_row(*row)
    console = Console(width=width, record=True, file=open("/dev/null", "w"))  # noqa: SIM115 - rich closes nothing
    console.print(table)
    text = console.export_text()
    assert "…" not in text and max(map(len, text.splitlines())) <= width
    assert Counter(text.split()) >= Counter(word for row in LONG for cell in row for word in cell.split())


def test_every_parameter_and_sentence_is_printed(found: Identification) -> None:
    text = " ".join(printed(found).split())
    for name in found.refined.parameters:
        assert tables.WORDS[name][1] in text
    for sentence in (*found.warnings, *found.open, found.route):
        assert sentence in text


def test_peaks_survive_thinning() -> None:
    time = np.linspace(0.0, 1.0, 50_000)
    signal = np.zeros(time.size)
    signal[31_234] = 5.0
    thin_time, thin = thinned(time, signal, 1000)
    assert thin.size <= 1000 and thin.max() == 5.0 and np.all(np.diff(thin_time) > 0)


def test_a_cloud_shows_the_motion_and_not_the_rest_alone() -> None:
    velocity = np.concatenate((np.zeros(50_000), np.linspace(-1.0, 1.0, 500)))
    keep = spread(velocity, 1000)
    assert keep.size <= 1000 and np.all(np.diff(keep) > 0)
    assert np.count_nonzero(velocity[keep]) > 0.9 * 480


def test_every_record_has_figures_7_and_8(found: Identification, tmp_path: Path) -> None:
    names = ["figure_7_model", "figure_8_residual", "bode"]
    assert [plot.slug for plot in figures.plots(found)] == names
    assert [path.name for path in figures.paths(found, tmp_path)] == [f"{n}.{kind}" for n in names for kind in KINDS]


def test_figures_are_written_as_agreed(tmp_path: Path) -> None:
    written = figures.save(identified(), tmp_path / "new")
    assert written == figures.paths(identified(), tmp_path / "new")
    assert all("<svg" in path.read_text(encoding="utf-8") for path in written if path.suffix == ".svg")
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written if path.suffix == ".png")
    again = figures.save(identified(), tmp_path / "again")
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in written]

"""The pages: built without a warning, one for each effect and command, numbers and tables as the code has them."""

from __future__ import annotations

import html
import os
import re
from functools import cache
from pathlib import Path

import architecture
import command_page
import docs_values
import effect_pages
import numpy as np
import pytest
import ros_tables
import signature

from msd_ident.cli import main
from msd_ident.model.effects import LIBRARY, Effect
from msd_ident.paper.tables import Table1, derive
from msd_ident.selection.ranking import DECISIVE

REPOSITORY = Path(__file__).resolve().parents[2]
PAGES = REPOSITORY / "docs"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The strict build, in which every warning (a dead link, an anchor that is gone) is an error."""
    pytest.importorskip("material", reason="no mkdocs-material here; it comes with the extra `docs`")
    pytest.importorskip("rclpy", reason="no ROS 2 here, whose nodes say what their parameters are")
    from mkdocs.commands.build import build
    from mkdocs.config import load_config

    folder = tmp_path_factory.mktemp("site")
    os.environ.setdefault("NO_MKDOCS_2_WARNING", "1")
    config = load_config(str(REPOSITORY / "mkdocs.yml"), strict=True, site_dir=str(folder))
    config.plugins.on_startup(command="build", dirty=False)
    build(config)
    return folder


@pytest.mark.xdist_group("site")
def test_pages_need_no_network(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r'<(?:script|link|img|iframe)\b[^>]*?(?:src|href)="(https?://[^"]+)"', text)
        assert not loaded, f"{page.name} loads {loaded}"


@pytest.mark.xdist_group("site")
def test_each_effect_has_its_page_with_law_and_parameters(site: Path) -> None:
    for effect in LIBRARY:
        text = html.unescape((site / "effects" / f"{effect.name}.html").read_text(encoding="utf-8"))
        for said in (effect.law, *(p.name for p in effect.parameters), *(p.meaning for p in effect.parameters)):
            assert said in text, f"{effect.name}: {said}"


@pytest.mark.xdist_group("site")
def test_equations_and_numbers_are_set(site: Path) -> None:
    for name in ("diagnosis", "intervals", "solver", "identities"):
        text = (site / f"{name}.html").read_text(encoding="utf-8")
        assert "<math" in text and "[[" not in text and "\\frac" not in text and "<!-- parameters" not in text
    assert f"Less than {DECISIVE} nats" in (site / "diagnosis.html").read_text(encoding="utf-8")


def test_the_readme_counts_the_effects() -> None:
    said = f"{len(LIBRARY)} are in its library"
    assert said in (REPOSITORY / "README.md").read_text(encoding="utf-8"), f"expected in README.md: … {said}"


def test_each_command_and_option_is_on_its_page() -> None:
    page = command_page.page()
    for name in main.COMMANDS:
        assert f"\n## msd {name}\n" in page
    assert "--position-scale NUMBER" in page and "--json FILE" in page and "| `PATH…` |" in page


def test_the_map_shows_every_room_above_all_that_it_imports() -> None:
    drawn = re.findall(r'href="#(\w+)"><rect x="\S+" y="(\S+)"', architecture.picture())
    height = {room: float(y) for room, y in drawn}
    assert set(height) == set(architecture.imports())
    assert all(height[room] < height[one] for room, found in architecture.imports().items() for one in found)
    assert all(f"### {room}\n" in architecture.rooms() for room in height)


def test_effects_say_what_they_are() -> None:
    page = effect_pages.page(next(effect for effect in LIBRARY if effect.name == "stribeck_friction"))
    assert "Family *dry friction*" in page and "[coulomb_friction](coulomb_friction.md)" in page
    assert "general path" in page and "msd simulate --effect stribeck_friction" in page
    assert "| `stribeck_velocity` | vs | m/s |" in page


@cache
def plain() -> np.ndarray:
    """What is drawn as missing where nothing is: the error of the drawing's differences."""
    return signature.lacking(signature.PLANT)[2]


@pytest.mark.parametrize("effect", LIBRARY, ids=lambda effect: effect.name)
def test_pictures_show_the_effect(effect: type[Effect]) -> None:
    """What is drawn as missing is the effect's force: nothing without it, and as its law says where that is simple."""
    x, v, force = signature.lacking(signature.PLANT + signature.example(effect))
    seen = np.isfinite(force)
    assert np.nanmax(np.abs(plain())) < 0.05 * np.nanmax(np.abs(force))
    law = {"quadratic_drag": v * np.abs(v), "cubic_spring": x**3, "asymmetric_spring": x**2}.get(effect.name)
    if law is not None:
        strength = signature.example(effect).values[0]
        assert force[seen] == pytest.approx(strength * law[seen], abs=0.02 * np.nanmax(np.abs(force)))


@pytest.mark.parametrize(
    ("value", "text"), [(3.5, "3.5"), (1e-5, "10⁻⁵"), (2e-7, "2·10⁻⁷"), (200_000, "200 000"), ((16, 64), "16, 64")]
)
def test_numbers_are_written_for_people(value: object, text: str) -> None:
    assert docs_values.written(value) == text


def test_a_constant_that_is_gone_is_an_error() -> None:
    with pytest.raises(AttributeError, match="NO_SUCH"):
        docs_values.filled("at most [[selection.evidence.NO_SUCH]] nats")


def test_messages_are_read_whole() -> None:
    for path in (REPOSITORY / "msd_interfaces").rglob("*.*"):
        if path.suffix in (".msg", ".srv", ".action"):
            lines = path.read_text(encoding="utf-8").splitlines()
            wanted = [line for line in lines if line and not line.startswith(("#", " ", "---"))]
            found = list(ros_tables.fields("\n".join(line for line in lines if line != "---")))
            assert len(found) == len(wanted), path.name


def test_the_paper_page_has_the_numbers_of_today() -> None:
    page, derived = (PAGES / "paper.md").read_text(encoding="utf-8"), derive(Table1())
    rows = {line.split("  ")[0].strip(): line.split() for line in page.splitlines() if line.startswith(" ")}
    wanted = {"mass m": derived.mass, "stiffness k": derived.stiffness, "damping ratio ζ": derived.damping_ratio}
    for name, value in wanted.items():
        computed = float(rows[name][len(name.split())])
        assert computed == pytest.approx(value, rel=1e-4), name

"""The pages of many records in a real browser: 10 000 rows sort and filter, nothing is asked of a network."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

pytest.importorskip("pyarrow", reason="the extra batch is not installed")

import chromium  # noqa: E402
from batchrigs import row, steps  # noqa: E402

from msd_ident.batching import table  # noqa: E402
from msd_ident.comparison.comparing import compare  # noqa: E402
from msd_ident.comparison.estimates import Measured  # noqa: E402
from msd_ident.monitoring.rows import by_robot  # noqa: E402
from msd_ident.monitoring.watching import watch  # noqa: E402
from msd_ident.report import batch_page, compare_page, watch_page  # noqa: E402

if TYPE_CHECKING:
    from playwright.sync_api import Browser

MANY = 10_000

pytestmark = pytest.mark.xdist_group("many_pages")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    yield from chromium.browser()


def test_ten_thousand_rows_sort_and_filter(browser: Browser, tmp_path: Path) -> None:
    rows = [row(n, f"arm_{n % 30}") for n in range(MANY)]
    rows[17] |= {"verdict": None, "error": "<b>broken</b> & gone"}
    batch_page.save(table.made(rows), tmp_path / "batch.html", "lab.parquet")
    visit = chromium.Visit(browser, (tmp_path / "batch.html").as_uri())
    page = visit.page
    page.wait_for_selector("tr[data-row]")
    assert "10000 of 10000" in page.inner_text("#count")
    assert page.locator("tr[data-row]").count() < 200  # only what is seen is in the page
    assert page.evaluate("document.getElementsByTagName('*').length") < MANY  # so it opens as fast as a page of few
    page.click("th[data-name=stiffness]")
    values = [float(text.split()[0]) for text in page.locator("tr[data-row] td:nth-child(8)").all_inner_texts() if text]
    assert values == sorted(values) and len(values) > 10
    page.fill("#filter", "robot=arm_7 stiffness>694")
    page.wait_for_function("!document.querySelector('#count').textContent.startsWith('10000')")
    expected = sum(one["robot"] == "arm_7" and one["stiffness"] > 694.0 for one in rows)
    assert page.inner_text("#count").startswith(f"{expected} of 10000")
    assert page.locator("#multiples figure").count() == 1
    page.fill("#filter", "broken")
    page.wait_for_function("document.querySelector('#count').textContent.startsWith('1 of')")
    page.click("tr[data-row]")
    assert "<b>broken</b> & gone" in page.inner_text("dialog")
    assert page.url.endswith("#r17")
    visit.shoot("batch", full_page=False)
    assert visit.errors == [] and all(url.startswith(("file:", "data:")) for url in visit.asked)
    assert visit.overflow() == 0


def test_a_row_with_a_page_of_its_own_opens_it(browser: Browser, tmp_path: Path) -> None:
    (tmp_path / "pages").mkdir()
    (tmp_path / "pages" / "one.html").write_text("<title>its own</title>")
    batch_page.save(table.made([row(1, page=str(tmp_path / "pages" / "one.html"))]), tmp_path / "b.html", "t.parquet")
    visit = chromium.Visit(browser, (tmp_path / "b.html").as_uri())
    with visit.context.expect_page() as opened:
        visit.page.click("tr[data-row]")
    assert opened.value.title() == "its own"


def test_comparison_and_watch_are_drawn(browser: Browser, tmp_path: Path) -> None:
    values = {"mass": 0.94, "damping": 3.9, "stiffness": 694.0}
    made = [
        Measured(f"record {n}", "AB"[n % 2], steps(n, stiffness=694.0 - 20.0 * (n % 2)), (), values) for n in range(4)
    ]
    compare_page.save_comparison(compare(made, "robot"), tmp_path / "compare.html", "lab")
    rows = [row(n, stiffness=(694.0 if n < 20 else 673.0) + 0.1 * (n % 5)) for n in range(40)]
    found = [watch(name, samples) for name, samples in by_robot(table.made(rows)).items()]
    watch_page.save_watches(found, tmp_path / "watch.html", "lab")
    for name, says in (("compare", "lower on robot B"), ("watch", "1 of 1 robots changed")):
        visit = chromium.Visit(browser, (tmp_path / f"{name}.html").as_uri())
        assert says in visit.page.inner_text("h1")
        visit.page.locator("figure.plot").first.scroll_into_view_if_needed()
        visit.page.wait_for_selector("figure.plot .main-svg")
        visit.shoot(name)
        assert visit.errors == [] and all(url.startswith(("file:", "data:", "blob:")) for url in visit.asked)

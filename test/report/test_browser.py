"""The page in a real Chromium: no errors, no requests, every plot drawn; screenshots for the eye lie in out/report."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import chromium
import pytest
from bagmaker import encoder_messages, force_messages, make_bag, stamps
from reportrigs import provenance, with_everything

from msd_ident.cli import main as command
from msd_ident.report import page

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.xdist_group("report")

#: Longest that a person waits for the page [ms].
PATIENCE = 2000.0
DRAWN = "[...document.querySelectorAll('figure.plot')].every(f => f.querySelector('.main-svg'))"
OPENED = "performance.timing.loadEventEnd - performance.timing.navigationStart"
INK = "getComputedStyle(document.querySelector('.xtitle')).fill"

browser = pytest.fixture(scope="module")(chromium.browser)


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "report.html"
    page.save([with_everything()], path, [provenance()])
    return path


class Visit(chromium.Visit):
    """A report that is open, every plot of it drawn; ``waited``: for the page to be there [ms]."""

    def __init__(self, browser: Browser, path: Path, **options: Any) -> None:
        super().__init__(browser, path.as_uri(), **options)
        self.waited = self.opened()
        for figure in self.page.query_selector_all("figure.plot"):  # they are drawn when they are looked at
            figure.evaluate("one => one.scrollIntoView()")
            self.page.wait_for_function("one => one.querySelector('.main-svg')", arg=figure)
        self.page.wait_for_function(DRAWN)
        self.page.evaluate("window.scrollTo(0, 0)")

    def opened(self) -> float:
        self.page.wait_for_function(f"{OPENED} > 0")
        return float(self.page.evaluate(OPENED))


@pytest.fixture(scope="module")
def desk(browser: Browser, saved: Path) -> Iterator[Visit]:
    """One for all tests of a wide screen, which leave it light."""
    visit = Visit(browser, saved, viewport={"width": 1280, "height": 900})
    yield visit
    visit.context.close()


def test_desktop(desk: Visit) -> None:
    assert desk.shoot("report/desktop").stat().st_size > 100_000
    sections = desk.page.locator("section").evaluate_all("all => all.map(one => one.className)")
    beside = ["causes", "calibration", "parameters", "data", "next_experiment"]
    assert sections == ["verdict", "fit", "missing_force", *beside]
    assert desk.page.locator("section").evaluate_all("all => all.every(one => one.clientHeight > 50)")
    assert desk.errors == [] and {url.partition(":")[0] for url in desk.asked} <= {"file", "data", "blob"}
    assert desk.overflow() == 0


def test_dark_and_print(desk: Visit) -> None:
    light = desk.page.evaluate(INK)
    desk.page.emulate_media(color_scheme="dark")
    desk.page.wait_for_function(f"{INK} !== '{light}'")
    dark = desk.page.evaluate(INK)
    pdf = desk.page.pdf(path=chromium.SHOTS / "report" / "print.pdf", prefer_css_page_size=True)
    assert desk.page.evaluate(INK) == dark, "after printing, the screen is dark again"
    desk.page.emulate_media(color_scheme="light")
    desk.page.wait_for_function(f"{INK} === '{light}'")
    assert b"/MediaBox [0 0 594.9" in pdf or b"/MediaBox [0 0 595" in pdf, "A4 is 595 points wide"
    assert 3 <= pdf.count(b"/Type /Page\n") <= 8 and desk.errors == []


def test_a_person_does_not_wait(desk: Visit) -> None:
    waited = desk.waited
    if waited > PATIENCE:  # another process had the processor: once more
        desk.page.reload()
        waited = desk.opened()
    assert waited < PATIENCE


def test_phone_in_the_dark(browser: Browser, saved: Path) -> None:
    small = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
    visit = Visit(browser, saved, color_scheme="dark", **small)
    visit.shoot("report/phone")
    assert visit.overflow() == 0 and visit.errors == []
    wide = "all => Math.max(...all.map(one => one.getBoundingClientRect().right))"
    assert visit.page.locator(".main-svg").evaluate_all(wide) <= 390
    assert visit.page.evaluate(INK) == visit.page.evaluate("getComputedStyle(document.body).color"), "as light as text"
    visit.context.close()


def test_a_bag_whose_names_are_scripts_is_harmless(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    evil = "/</script><script>window.pwned=1</script>"
    count = 300
    ns = stamps(count, period_ns=5_000_000)
    messages = [*force_messages(topic=f"{evil}/force"), *encoder_messages(ns, topic=f"{evil}/encoder")]
    bag = make_bag(tmp_path / "<img src=x onerror=window.pwned=1>", sorted(messages, key=lambda one: one[3]))
    target = tmp_path / "page.html"
    monkeypatch.setattr("sys.argv", ["msd", "identify", str(bag), "--report", str(target), "--quiet"])
    assert command.main() == 0
    visit = Visit(browser, target)
    assert visit.page.evaluate("window.pwned") is None and visit.errors == []
    assert evil in visit.page.locator("section.data").inner_text()
    assert "<img src=x" in visit.page.locator("section.verdict").inner_text()
    visit.context.close()

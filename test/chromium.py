"""A real headless Chromium for the tests of pages, and visits to pages in it."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

#: Where screenshots for the eye go, a folder for each page.
SHOTS = Path(__file__).resolve().parents[1] / "out"
#: Longest wait for anything on a busy machine [s].
PATIENCE = 150.0
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def browser() -> Iterator[Browser]:
    """To be made a fixture: one browser for all tests of a module, which are skipped with a reason where none is."""
    sync = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    found = next((path for name in (os.environ.get("CHROMIUM", ""), *NAMES) if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("no Chromium on this machine; install chromium, or name it in CHROMIUM, to see the page tested")
    with sync.sync_playwright() as driver:
        one = driver.chromium.launch(executable_path=found, args=["--no-sandbox", "--disable-gpu"])
        yield one
        one.close()


class Visit:
    """A page that is open, with what went wrong on it and whom it asked for anything."""

    def __init__(self, browser: Browser, url: str, **options: Any) -> None:
        self.errors: list[str] = []
        self.asked: list[str] = []
        self.context = browser.new_context(**options)
        self.page: Page = self.context.new_page()
        self.page.set_default_timeout(1000.0 * PATIENCE)
        self.page.on("console", lambda said: self.errors.append(said.text) if said.type == "error" else None)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(url)

    def shoot(self, name: str, *, full_page: bool = True) -> Path:
        """A picture of the page, ``out/NAME.png``. A browser that gets no processor time for it is asked again."""
        from playwright.sync_api import TimeoutError as TookTooLong

        path = SHOTS / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        for last in (False, False, True):
            try:
                self.page.screenshot(path=path, full_page=full_page)
                break
            except TookTooLong:
                if last:
                    raise
        return path

    def overflow(self) -> int:
        """Pixels by which the page is wider than the screen."""
        return int(self.page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth"))

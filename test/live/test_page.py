"""The live view in a real Chromium beside real nodes: press a button, see the result. Screenshots lie in out/live."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")
pytest.importorskip("bokeh", reason="the live view's library is not installed: msd_ident[live]")

import chromium  # noqa: E402
from geometry_msgs.msg import WrenchStamped  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402

from msd_ident import io  # noqa: E402
from msd_ident.ros.common import names  # noqa: E402
from msd_ident.ros.demo.live_demo import demo_graph  # noqa: E402
from msd_ident.ros.live.node import LiveView  # noqa: E402
from msd_interfaces.msg import Cause, Diagnosis  # noqa: E402
from msd_interfaces.msg import Parameter as ParameterMessage  # noqa: E402

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.xdist_group("live")

#: Longest wait for anything on a busy machine [s].
PATIENCE = chromium.PATIENCE
#: Of the view: as slow as can be followed, since each costs the browser much.
FRAME_RATE = 4.0
#: Of the rig [s]: longer than this process keeps a force from it while it serves the page on a busy machine.
LATENCY = 1.0

browser = pytest.fixture(scope="module")(chromium.browser)


class Visit(chromium.Visit):
    """A live page that gets its frames."""

    def __init__(self, browser: Browser, url: str, **options: Any) -> None:
        super().__init__(browser, url, **options)
        self.page.wait_for_function("Number(document.body.dataset.frames) > 1")

    def press(self, name: str) -> None:
        self.page.get_by_role("button", name=name, exact=True).click()

    def hears(self, text: str) -> None:
        """Wait for a sentence among what came of the requests; tell the others where it does not come."""
        from playwright.sync_api import TimeoutError as TookTooLong

        try:
            self.page.get_by_text(text).first.wait_for()
        except TookTooLong:
            pytest.fail(f"waited {PATIENCE:g} s for '{text}'; the page says {self.page.locator('body').inner_text()}")

    def reads(self, what: str) -> float:
        """A number beside the curves."""
        text = self.page.locator(f"#{what}").text_content() or ""
        word = text.split()[0].replace("−", "-") if text.split() else "–"
        return float("nan") if word == "–" else float(word)

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait, letting the page go on."""
        for _ in range(round(PATIENCE / 0.05)):
            if condition():
                return
            self.page.wait_for_timeout(50)
        pytest.fail(f"waited {PATIENCE:g} s for {what}")


class Bench:
    """The view in this process, beside rig, recorder and identifier in theirs; what the rig was commanded."""

    def __init__(self, ros: Graph, folder: Path) -> None:
        self.folder = folder
        self.ros = ros
        self.forces: list[float] = []
        ros.node.create_subscription(WrenchStamped, "/msd/force", self._heard, names.force_qos())
        urls: list[str] = []
        options = given({"port": 0, "frame_rate": FRAME_RATE})
        self.view: LiveView = ros.add(LiveView(options, urls.append, namespace="msd", context=ros.context))
        (self.url,) = urls

    def _heard(self, message: WrenchStamped) -> None:
        self.forces.append(message.wrench.force.x)

    @property
    def bags(self) -> list[Path]:
        return [path for path in self.folder.iterdir() if path.is_dir()]


def given(values: dict[str, Any]) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in values.items()]


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    """One for all: they take a while to start."""
    folder = tmp_path_factory.mktemp("bags")
    with demo_graph(folder, rate=100.0, latency=LATENCY), graph(int(os.environ["ROS_DOMAIN_ID"])) as ros:
        yield Bench(ros, folder)


def told(nasty: str) -> Diagnosis:
    """A diagnosis as the identifier publishes it, with words that a page must not run."""
    parameters = [
        ParameterMessage(name=name, symbol=symbol, value=value, std=0.01, unit=unit)
        for name, symbol, value, unit in (
            ("mass", "m", 0.9407, "kg"),
            ("damping", "b", 3.927, "N·s/m"),
            ("stiffness", "k", 694.1, "N/m"),
            ("drag_coefficient", "c", 4.0, "N·s²/m²"),
        )
    ]
    cause = Cause(name="quadratic_drag", probability=0.97, parameters=parameters[3:], tied_with=["stribeck_friction"])
    message = Diagnosis(path="live", position_unit="m", verdict="explained", summary=f"Drag is missing. {nasty}")
    message.causes, message.extended = [cause], parameters
    message.base_see, message.extended_see, message.noise_floor = 4e-4, 1.1e-5, 1e-5
    message.heldout_reduction_percent, message.heldout_reduction_lower = 96.0, 95.0
    message.heldout_reduction_upper = 97.0
    message.header.stamp.sec = 2_000_000_000
    return message


def test_buttons_do_what_they_say(browser: Browser, bench: Bench) -> None:
    visit = Visit(browser, bench.url, viewport={"width": 1400, "height": 1100})
    page = visit.page
    page.get_by_text("samples per second").wait_for()
    visit.press("Record")
    page.get_by_role("button", name="Stop", exact=True).wait_for()
    page.get_by_label("Force of the step").fill("8")
    page.keyboard.press("Tab")
    visit.press("Step")
    visit.until(lambda: visit.reads("position-now") > 1.0, "the cart to move")
    assert bench.forces == [0.0, 8.0] and visit.reads("force-now") == 8.0
    page.get_by_text("viscous damping").wait_for()  # the identifier fits by itself once the response has settled
    visit.until(lambda: abs(visit.reads("model-now") - visit.reads("position-now")) < 0.05, "the model beside the rig")
    visit.press("Release")
    visit.until(lambda: abs(visit.reads("position-now")) < 0.1, "the cart to come back")
    assert bench.forces == [0.0, 8.0, 0.0]
    visit.press("Stop")
    visit.hears("none lost")
    (made,) = bench.bags
    assert set(io.read(made).force.tolist()) == {8.0, 0.0}
    visit.press("Identify")
    visit.hears("identify: m = 0.")
    visit.press("Diagnose")
    visit.hears("diagnose: ")
    visit.press("Cancel")
    visit.hears("diagnose: cancelled")
    visit.press("Reset")
    visit.hears("reset: encoder at zero, cart at rest")
    visit.press("5 s")
    visit.until(lambda: visit.reads("residual-rms") < 200.0, "the model to begin anew with the rig")
    visit.press("Pause")  # a browser that draws a frame after the other may find no time for a picture
    visit.shoot("live/buttons", full_page=False)
    assert visit.errors == []
    assert {url.split("/")[2] for url in visit.asked} == {bench.url.split("/")[2]}, "somebody else was asked"
    visit.context.close()


def test_verdict_phone_dark_and_pause(browser: Browser, bench: Bench) -> None:
    phone = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "color_scheme": "dark"}
    visit = Visit(browser, bench.url, **phone)
    page = visit.page
    publisher = bench.ros.node.create_publisher(Diagnosis, f"/msd/{names.DIAGNOSIS}", names.latest_qos())
    publisher.publish(told("<img src=x onerror=document.title='owned'><b>"))
    page.get_by_text("cause named").wait_for()
    page.get_by_text("or stribeck friction").wait_for()
    page.get_by_text("<img src=x").wait_for()
    page.get_by_text("with quadratic drag, of the diagnosis").wait_for()
    visit.until(lambda: visit.reads("residual-rms") < 30.0, "a residual as small as the noise (10 µm)")
    assert page.title() == "msd live"
    assert visit.overflow() == 0
    visit.press("Pause")
    page.get_by_role("button", name="Go on").wait_for()
    frames = page.evaluate("document.body.dataset.frames")
    page.wait_for_timeout(300)
    paused = page.evaluate("document.body.dataset.frames")
    page.wait_for_timeout(300)
    assert page.evaluate("document.body.dataset.frames") == paused and int(paused) <= int(frames) + 2
    visit.press("Go on")
    page.wait_for_function(f"Number(document.body.dataset.frames) > {paused} + 1")
    visit.press("Pause")
    visit.shoot("live/phone", full_page=False)
    assert visit.errors == [] or visit.errors == [e for e in visit.errors if "/x" in e]
    visit.context.close()


def test_a_force_that_was_left_on_goes_with_the_view(ros_domain: int) -> None:
    with graph(ros_domain) as ros:
        heard: list[float] = []
        ros.node.create_subscription(
            WrenchStamped, "force", lambda message: heard.append(message.wrench.force.x), names.force_qos()
        )
        view = LiveView(given({"port": 0, "step_limit": 5.0}), lambda url: None, context=ros.context)
        spinner = ros.spin(view.node)
        view._controls.step(9.0)
        assert "a force of 9 is refused; expected at most ± 5" in view.board.known.lines[0].text
        view._controls.step(4.0)
        until(lambda: heard == [0.0, 4.0], "the force")
        spinner.stop()
        view.close()
        until(lambda: heard == [0.0, 4.0, 0.0], "its end")
        view.node.destroy_node()

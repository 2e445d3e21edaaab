"""Who may see the page: this machine, or whoever has the token; what is said when it cannot be served."""

from __future__ import annotations

import asyncio
import importlib.util
import re
import socket
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

pytest.importorskip("bokeh", reason="the live view's library is not installed: msd_ident[live]")

from tornado.httpclient import HTTPClientError, HTTPRequest  # noqa: E402
from tornado.websocket import websocket_connect  # noqa: E402

from msd_ident.errors import SetupError, UsageError  # noqa: E402
from msd_ident.live import Board, Scope  # noqa: E402
from msd_ident.live.needs import require_page  # noqa: E402
from msd_ident.live.page import Shown  # noqa: E402
from msd_ident.live.server import LiveServer, new_token  # noqa: E402


class Nobody:
    """Controls that nothing here presses."""

    def step(self, force: float) -> None: ...
    def record(self, on: bool) -> None: ...
    def identify(self) -> None: ...
    def diagnose(self) -> None: ...
    def cancel(self) -> None: ...
    def reset(self) -> None: ...


def server(**options: Any) -> LiveServer:
    return LiveServer(Shown(Scope(), Board(), Nobody(), 25.0), **options)


@contextmanager
def serving(**options: Any) -> Iterator[LiveServer]:
    made = server(**options)
    made.start()
    try:
        yield made
    finally:
        assert made.stop()


def answer(url: str, cookie: str = "") -> tuple[int, str, str]:
    """Status, text and cookie of an answer."""
    request = urllib.request.Request(url, headers={"Cookie": cookie} if cookie else {})
    try:
        with urllib.request.urlopen(request, timeout=20.0) as found:
            return found.status, found.read().decode(), found.headers.get("Set-Cookie", "")
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode(), ""


def joins(port: int, origin: str, page: str, cookie: str = "") -> bool:
    """Whether somebody who has read the page, on a page of some origin, gets its data."""
    found = re.search(r'"token":"([^"]+)"', page)
    assert found

    async def connect(token: str) -> bool:
        headers = {"Origin": origin, **({"Cookie": cookie} if cookie else {})}
        request = HTTPRequest(f"ws://127.0.0.1:{port}/ws", headers=headers)
        try:
            connection = await websocket_connect(request, subprotocols=["bokeh", token])
        except HTTPClientError as error:
            assert error.code == 403
            return False
        first = await connection.read_message()
        connection.close()
        return first is not None

    return asyncio.run(connect(found[1]))


def test_serves_this_machine_with_scripts_of_its_own() -> None:
    with serving() as made:
        assert made.url == f"http://127.0.0.1:{made.port}/"
        status, page, _ = answer(made.url)
        assert status == 200 and "msd live" in page
        assert "cdn" not in page and "https://" not in page
        assert answer(f"{made.url}static/js/bokeh.min.js")[0] == 200


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


@pytest.mark.parametrize("chosen", [False, True])
def test_a_page_of_somebody_else_gets_no_data(chosen: bool) -> None:
    with serving(port=free_port() if chosen else 0) as made:
        page = answer(made.url)[1]
        assert joins(made.port, f"http://127.0.0.1:{made.port}", page)
        assert joins(made.port, f"http://localhost:{made.port}", page)
        assert not joins(made.port, "http://evil.example", page)
        assert not joins(made.port, "http://127.0.0.1:1", page)


def test_others_need_the_token() -> None:
    with pytest.raises(UsageError, match="open to everyone who reaches 0.0.0.0; expected a token"):
        server(host="0.0.0.0")
    token = new_token()
    with serving(host="0.0.0.0", token=token) as made:
        here = f"http://127.0.0.1:{made.port}/"
        assert made.url.endswith(f":{made.port}/?token={token}")
        status, said, _ = answer(here)
        assert status == 403 and "This page needs its token" in said
        assert answer(f"{here}?token=wrong")[0] == 403
        status, page, cookie = answer(f"{here}?token={token}")
        assert status == 200 and "msd live" in page
        assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
        assert answer(here, cookie.split(";")[0])[0] == 200
        assert joins(made.port, here.rstrip("/"), page, cookie.split(";")[0])
        assert not joins(made.port, here.rstrip("/"), page), "data without a token"


def test_a_port_that_is_taken_is_said() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(SetupError, match=rf"on 127.0.0.1:{port}: .* in use; expected a free port: say --port"):
            server(port=port).start()


def test_without_the_library_one_line_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(SetupError, match=r"bokeh is not installed.*make setup.*msd_ident\[live\]"):
        require_page()

"""Serves the page: on this machine only, or to others who have the token."""

from __future__ import annotations

import asyncio
import hmac
import logging
import secrets
import socket
import threading
from collections.abc import Callable
from typing import Any

from bokeh.application import Application
from bokeh.application.handlers import FunctionHandler
from bokeh.document import Document
from bokeh.server.auth_provider import AuthProvider
from bokeh.server.server import Server
from tornado.ioloop import IOLoop
from tornado.web import RequestHandler

from msd_ident.errors import SetupError, UsageError
from msd_ident.live.page import Page, Shown

#: Address that only this machine reaches.
HERE = "127.0.0.1"
#: Addresses that mean this machine alone, as Bokeh knows them in an origin: none with a colon in it.
LOCAL = (HERE, "localhost")
#: What the browser keeps the token in.
COOKIE = "msd_live_token"
#: A tab that was closed is forgotten after this time [ms].
LINGER = 5_000


def new_token() -> str:
    """A token that nobody guesses."""
    return secrets.token_urlsafe(24)


class LiveServer:
    """The server, in a thread of its own from ``start`` to ``stop``.

    Args:
        shown: what every page shows.
        host: address to listen on.
        port: to listen on; 0 for any that is free.
        token: that a browser must bring (``?token=…``, once); empty for none.

    Raises:
        UsageError: another address than this machine's own, and no token.
        SetupError: the port cannot be had.
    """

    def __init__(self, shown: Shown, host: str = HERE, port: int = 0, token: str = "") -> None:
        if host not in LOCAL and not token:
            raise UsageError(
                f"the page would be open to everyone who reaches {host}; expected a token with it, or {HERE}"
            )
        self._token = token
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._serve, name="page", daemon=True)
        self._make: Callable[[], Server] = lambda: _server(shown, host, port, token)
        self._started = threading.Event()
        self._failure: BaseException | None = None
        self._server: Server | None = None
        self._host, self._port = host, port

    def start(self) -> None:
        """Begin to serve; returns once the page can be opened.

        Raises:
            SetupError: the port cannot be had.
        """
        self._thread.start()
        self._started.wait()
        if self._failure is not None:
            raise SetupError(
                f"the page cannot be served on {self._host}:{self._port}: {_reason(self._failure)}; "
                "expected a free port: say --port"
            )

    def stop(self) -> bool:
        """End it; whether its thread has ended."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(timeout=5.0)
        return not self._thread.is_alive()

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self._server.port or 0) if self._server else 0

    @property
    def url(self) -> str:
        """What to open in a browser."""
        host = self._host if self._host not in ("0.0.0.0", "::", "") else socket.gethostname()
        key = f"?token={self._token}" if self._token else ""
        return f"http://{f'[{host}]' if ':' in host else host}:{self.port}/{key}"

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._server = self._make()
            self._server.start()
        except (OSError, OverflowError, ValueError) as error:
            self._failure = error
            return
        finally:
            self._started.set()
        self._loop.run_forever()
        self._server.stop(wait=False)
        self._loop.run_until_complete(self._loop.shutdown_asyncgens())
        self._loop.close()


def _server(shown: Shown, host: str, port: int, token: str) -> Server:
    logging.getLogger("bokeh").setLevel(logging.ERROR)
    logging.getLogger("tornado").setLevel(logging.ERROR)

    def make(document: Document) -> None:
        Page(document, shown)

    options: dict[str, Any] = {}
    if token:
        # Whoever has the token may come by any name of this machine: the cookie is never sent from another site.
        options = {"auth_provider": TokenAuth(token), "sign_sessions": True, "secret_key": secrets.token_bytes(32)}
    return Server(
        {"/": Application(FunctionHandler(make))},
        io_loop=IOLoop.current(),
        address=host,
        port=port,
        allow_websocket_origin=["*"] if token else [f"{name}:{port}" for name in LOCAL] if port else None,
        unused_session_lifetime_milliseconds=LINGER,
        check_unused_sessions_milliseconds=LINGER,
        exclude_headers=["Cookie"],
        exclude_cookies=[COOKIE],
        **options,
    )


class TokenAuth(AuthProvider):
    """Lets in who brings the token, in the address or in the cookie that it gets for it."""

    def __init__(self, token: str) -> None:
        self._token = token
        super().__init__()

    @property
    def get_user(self) -> Callable[[RequestHandler], str | None]:
        """Who asks: anybody with the token."""

        def user(handler: RequestHandler) -> str | None:
            """The holder of the token, by cookie or by address; the address leaves a cookie."""
            if self._right(handler.get_cookie(COOKIE) or ""):
                return "holder"
            if self._right(handler.get_query_argument("token", "")):
                handler.set_cookie(COOKIE, self._token, httponly=True, samesite="Strict")
                return "holder"
            return None

        return user

    @property
    def login_url(self) -> str:
        """Where those go who have no token."""
        return "/token"

    @property
    def login_handler(self) -> type[RequestHandler]:
        """Says what is missing."""
        return _NoToken

    def _right(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(), self._token.encode())


class _NoToken(RequestHandler):
    def get(self) -> None:
        """Refuse in words."""
        self.set_status(403)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish("This page needs its token: open the whole address that msd live has printed.\n")


def _reason(error: BaseException) -> str:
    return str(getattr(error, "strerror", None) or error)

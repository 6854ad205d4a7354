"""Serves the page of one live scene on this machine only, and each page's session.

What is asked for must come from this machine (loopback), to the address with the token, by the name
under which the page was opened (Host), and a connection must come from the page itself (Origin).
"""

from __future__ import annotations

import asyncio
import hmac
import logging
import secrets
import socket
import time as clock
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from pathlib import Path

from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from ...errors import CurveboundError
from .messages import text
from .model import describe
from .page import live_page
from .plan import Plan
from .protocol import LONGEST
from .recording import recording
from .session import TICK, Session

__all__ = ["MOST_PAGES", "Live"]

MOST_PAGES = 16
_MOST_REFUSED = 20  # malformed messages that are answered within a second
_HOST = "127.0.0.1"
_quiet = logging.getLogger("curvebound.live")
_quiet.addHandler(logging.NullHandler())
_quiet.propagate = False


class Live:
    """A server; `address` is what the browser opens.

    folder: where what is recorded goes. Raises CurveboundError where the scene cannot be run.
    """

    def __init__(self, plan: Plan, folder: Path) -> None:
        self.plan = plan
        self.sessions: set[Session] = set()
        self._folder = folder
        self._model = text("scene", **describe(plan))
        self._socket = socket.create_server((_HOST, 0))
        self._port = self._socket.getsockname()[1]
        self._token = secrets.token_urlsafe(24)
        self._saving = asyncio.Lock()
        path = f"/{self._token}/"
        self._paths = {"page": path, "socket": f"{path}socket"}
        self._hosts = {f"{name}:{self._port}": name for name in (_HOST, "localhost")}
        self.address = f"http://{_HOST}:{self._port}{path}"
        self._page = live_page(plan.scene.name, self._port).encode()

    async def serve(self, ready: Callable[[], None]) -> None:
        """Serve until cancelled; `ready` is called once pages can be opened."""
        async with serve(
            self._talk,
            sock=self._socket,
            process_request=self._answer,
            max_size=LONGEST,
            max_queue=64,
            compression=None,
            ping_interval=5.0,
            ping_timeout=10.0,
            # browsers open connections that they may never use: the end would wait for them
            open_timeout=2.0,
            close_timeout=2.0,
            server_header=None,
            logger=_quiet,
        ):
            ready()
            await asyncio.get_running_loop().create_future()

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """The page, a refusal, or nothing where a session begins."""
        host = request.headers.get_all("Host")
        if len(host) != 1 or host[0] not in self._hosts:
            return _response(HTTPStatus.FORBIDDEN, b"This is no name of this server.\n")
        if _same(request.path, self._paths["page"]):
            return _response(HTTPStatus.OK, self._page, "text/html; charset=utf-8")
        if not _same(request.path, self._paths["socket"]):
            return _response(HTTPStatus.NOT_FOUND, b"The address lacks its token: open it as the "
                             b"command printed it.\n")  # fmt: skip
        if request.headers.get_all("Origin") != [f"http://{host[0]}"]:
            return _response(HTTPStatus.FORBIDDEN, b"Another page may not connect.\n")
        if len(self.sessions) >= MOST_PAGES:
            return _response(HTTPStatus.SERVICE_UNAVAILABLE, b"Too many pages are open.\n")
        return None

    async def _talk(self, connection: ServerConnection) -> None:
        """One page, from its opening to its closing, whichever way it closes."""
        try:
            session = Session(self.plan)
        except CurveboundError as error:
            await connection.send(text("error", text=str(error)))
            return
        self.sessions.add(session)
        listening: asyncio.Task[None] | None = None
        saving: set[asyncio.Task[None]] = set()

        def save() -> None:
            task = asyncio.create_task(self._save(session))
            saving.add(task)
            task.add_done_callback(saving.discard)

        session.on_record = save
        try:
            await connection.send(self._model)
            listening = asyncio.create_task(_listen(connection, session))
            await _play(connection, session, listening)
        except ConnectionClosed:
            pass
        finally:
            if listening is not None:
                listening.cancel()
            session.on_record = None
            self.sessions.discard(session)
            session.close()

    async def _save(self, session: Session) -> None:
        try:
            save = recording(session.runs, self._folder)
            async with self._saving:
                made = await asyncio.to_thread(save)
        except (CurveboundError, OSError) as error:
            session.say("error", text=f"Nothing was recorded: {error}")
            return
        session.say("recorded", scene=str(made.scene), result=str(made.result), exact=made.exact)


async def _listen(connection: ServerConnection, session: Session) -> None:
    """Hand on what the page asks until it has gone."""
    second, refused = 0, 0
    with suppress(ConnectionClosed):
        async for message in connection:
            if int(clock.monotonic()) != second:
                second, refused = int(clock.monotonic()), 0
            refused += not session.receive(message, silent=refused >= _MOST_REFUSED)


async def _play(
    connection: ServerConnection, session: Session, listening: asyncio.Task[None]
) -> None:
    """Step and show, a picture a tick."""
    loop = asyncio.get_running_loop()
    due = loop.time()
    while not listening.done():
        for message in session.tick():
            await connection.send(message)
        due = max(due + TICK, loop.time())
        await asyncio.sleep(max(due - loop.time(), 0.001))


def _same(one: str, other: str) -> bool:
    """Whether two texts are the same, in a time that does not tell where they differ."""
    return hmac.compare_digest(one.encode(), other.encode())


def _response(status: HTTPStatus, body: bytes, kind: str = "text/plain; charset=utf-8") -> Response:
    headers = Headers(
        {
            "Content-Type": kind,
            "Content-Length": str(len(body)),
            "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "X-Frame-Options": "DENY",
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Connection": "close",
        }
    )
    return Response(status.value, status.phrase, headers, body)

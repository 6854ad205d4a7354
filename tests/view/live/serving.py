"""A live server in a thread of the tests."""

from __future__ import annotations

import asyncio
import http.client
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

from curvebound.view.live.plan import Plan
from curvebound.view.live.server import Live


class Serving:
    """live: the server; host: name and port, path: its address's."""

    def __init__(self, live: Live) -> None:
        self.live = live
        self.address = live.address
        parts = urlsplit(live.address)
        self.host, self.path = parts.netloc, parts.path

    def get(self, path: str, **headers: str) -> http.client.HTTPResponse:
        connection = http.client.HTTPConnection(self.host, timeout=10)
        connection.putrequest("GET", path, skip_host="Host" in headers)
        for name, value in headers.items():
            connection.putheader(name.replace("_", "-"), value)
        connection.endheaders()
        return connection.getresponse()

    def socket(self, origin: str | None = "", path: str | None = None):  # type: ignore[no-untyped-def]
        from websockets.sync.client import connect

        return connect(
            f"ws://{self.host}{self.path if path is None else path}socket",
            origin=f"http://{self.host}" if origin == "" else origin,  # type: ignore[arg-type]
            max_size=None,
        )

    def wait(self, condition: Callable[[], bool], patience: float = 20.0) -> None:
        end = time.monotonic() + patience
        while not condition():
            assert time.monotonic() < end, "it never held"
            time.sleep(0.02)


@contextmanager
def served(plan: Plan, folder: Path) -> Iterator[Serving]:
    live = Live(plan, folder)
    ready = threading.Event()
    loop = asyncio.new_event_loop()
    task: list[asyncio.Task[None]] = []

    def run() -> None:
        asyncio.set_event_loop(loop)
        task.append(loop.create_task(live.serve(ready.set)))
        try:
            loop.run_until_complete(task[0])
        except asyncio.CancelledError:
            pass
        finally:
            loop.run_until_complete(loop.shutdown_default_executor())
            loop.close()

    thread = threading.Thread(target=run)
    thread.start()
    assert ready.wait(20.0)
    try:
        yield Serving(live)
    finally:
        loop.call_soon_threadsafe(task[0].cancel)
        thread.join(20.0)
        assert not thread.is_alive()
        assert not live.sessions

"""Who is served, who is refused, and that FMUs are freed whichever way a page goes."""

from __future__ import annotations

import json
import random
import socket
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from serving import Serving, served

from curvebound.cosim.instance import Instance
from curvebound.view.live.plan import Plan
from curvebound.view.live.server import MOST_PAGES

pytest.importorskip("websockets")
from websockets.exceptions import ConnectionClosed, InvalidStatus

PlanOf = Callable[[str], Plan]


def refused(serving: Serving, *arguments: str | None) -> int:
    with pytest.raises(InvalidStatus) as error, serving.socket(*arguments):
        pass
    return int(error.value.response.status_code)


def test_only_the_page_itself_is_served(plan_of: PlanOf, tmp_path: Path) -> None:
    with served(plan_of("bead_on_wire"), tmp_path) as serving:
        port = urlsplit(serving.address).port
        assert serving.address.startswith("http://127.0.0.1:")
        assert len(serving.path) > 30
        page = serving.get(serving.path)
        assert page.status == 200
        text = page.read().decode()
        assert "default-src 'none'" in text
        assert f"connect-src ws://127.0.0.1:{port} ws://localhost:{port};" in text
        assert page.headers["Referrer-Policy"] == "no-referrer"
        assert page.headers["Cache-Control"] == "no-store"
        for path in ("/", "/socket", "//", f"/{'a' * 32}/", serving.path + "x", serving.path[:-2]):
            assert serving.get(path).status == 404, path
        for host in ("evil.example", f"evil.example:{port}", "127.0.0.1", f"127.0.0.1.evil:{port}"):
            assert serving.get(serving.path, Host=host).status == 403, host
        assert serving.get(serving.path, Host=f"localhost:{port}").status == 200
        assert not serving.live.sessions
        # loopback only
        with pytest.raises(OSError):  # noqa: PT011 (refused or timed out, as systems go)
            socket.create_connection((_other_address(), port or 0), timeout=2).close()


def _other_address() -> str:
    """An address of this machine that is not loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
        except OSError:
            pytest.skip("this machine has no other address")
        return str(probe.getsockname()[0])


def test_another_origin_or_no_token_is_refused(plan_of: PlanOf, tmp_path: Path) -> None:
    with served(plan_of("bead_on_wire"), tmp_path) as serving:
        for origin in (
            None,
            "http://evil.example",
            f"https://{serving.host}",
            "http://127.0.0.1:1",
            "null",
            f"http://localhost:{serving.host.split(':')[1]}",
        ):
            assert refused(serving, origin) == 403, origin
        for path in ("/", "/wrong/", serving.path[:-1] + "x/"):
            assert refused(serving, "", path) == 404, path
        assert not serving.live.sessions


def test_malformed_messages_and_a_browser_that_vanishes(
    plan_of: PlanOf, tmp_path: Path, instances: list[Instance]
) -> None:
    random.seed(2)
    with served(plan_of("bead_on_wire"), tmp_path) as serving:
        with serving.socket() as one, serving.socket() as other:
            assert json.loads(one.recv())["event"] == "scene"
            assert json.loads(other.recv())["event"] == "scene"
            for number in range(1000):
                if number % 3 == 0:
                    one.send(random.randbytes(random.randrange(200)))
                else:
                    one.send("".join(chr(random.randrange(32, 400)) for _ in range(60)))
            one.send(json.dumps({"do": "play"}))
            answers = [json.loads(text) for text in _texts(one, lambda event: event.get("playing"))]
            said = [event for event in answers if event["event"] == "refused"]
            assert 0 < len(said) < 200, "not an answer for each"
            assert len(serving.live.sessions) == 2
            # too long a message ends its page, not the other
            one.send("x" * 70_000)
            with pytest.raises(ConnectionClosed):
                _texts(one, lambda event: False)
            serving.wait(lambda: len(serving.live.sessions) == 1)
            other.send(json.dumps({"do": "play"}))
            _texts(other, lambda event: event.get("playing"))
        serving.wait(lambda: not serving.live.sessions)
        with serving.socket() as vanishing:
            serving.wait(lambda: len(serving.live.sessions) == 1)
            vanishing.socket.shutdown(socket.SHUT_RDWR)
            serving.wait(lambda: not serving.live.sessions)
        assert instances
        assert not any(one.alive for one in instances)
        with serving.socket() as last:  # and it serves on
            assert json.loads(last.recv())["event"] == "scene"


def _texts(page, until) -> list[str]:  # type: ignore[no-untyped-def]
    """The texts that come until one holds."""
    texts: list[str] = []
    while not texts or not until(json.loads(texts[-1])):
        message = page.recv(timeout=20)
        if isinstance(message, str):
            texts.append(message)
    return texts


def test_so_many_pages_and_no_more(
    plan_of: PlanOf, tmp_path: Path, instances: list[Instance]
) -> None:
    with ExitStack() as stack, served(plan_of("bead_on_wire"), tmp_path) as serving:
        stack.enter_context(serving.socket())
        with ExitStack() as others:
            for _ in range(MOST_PAGES - 1):
                others.enter_context(serving.socket())
            serving.wait(lambda: len(serving.live.sessions) == MOST_PAGES)
            assert refused(serving) == 503
        serving.wait(lambda: len(serving.live.sessions) == 1)
        stack.enter_context(serving.socket())
    # the server has ended with pages open: their FMUs are freed (instances)


def test_pages_have_scenes_of_their_own(plan_of: PlanOf, tmp_path: Path) -> None:
    with (
        served(plan_of("bead_on_wire"), tmp_path) as serving,
        serving.socket() as one,
        serving.socket() as other,
    ):
        one.send(json.dumps({"do": "set", "path": "bead.bead.fx", "value": 7}))
        told = json.loads(_texts(one, lambda e: e.get("values", {}).get("bead.bead.fx"))[-1])
        assert told["values"]["bead.bead.fx"] == 7
        other.send(json.dumps({"do": "pause"}))
        told = json.loads(_texts(other, lambda event: "values" in event)[-1])
        assert told["values"]["bead.bead.fx"] == 0
        one.send(json.dumps({"do": "step"}))
        one.send(json.dumps({"do": "record"}))
        told = json.loads(_texts(one, lambda event: event["event"] == "recorded")[-1])
        assert told["exact"]
        assert Path(told["scene"]).parent == tmp_path
        assert Path(told["result"]).is_file()
        other.send(json.dumps({"do": "record"}))
        told = json.loads(_texts(other, lambda event: event["event"] == "error")[-1])
        assert "Nothing has moved" in told["text"]

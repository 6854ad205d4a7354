"""What a live page offers and says by itself, while its scene rests."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from browsing import Tab
from serving import served

from curvebound.view.live import pace
from curvebound.view.live.plan import Plan


@pytest.fixture
def page(tab: Tab, plan_of: Callable[[str], Plan], tmp_path: Path) -> Iterator[Tab]:
    with served(plan_of("pumped_swing"), tmp_path) as serving:
        tab.visit(f"{serving.address}#play=0")
        tab.wait("curvebound.samples[0]?.length")
        yield tab
        assert tab.errors == []
        tab.leave()


def test_speeds_are_those_that_the_server_takes(page: Tab) -> None:
    offered = page.run("[...document.getElementById('speed').options].map((one) => one.text)")
    assert offered == [f"{x}\u00d7" for x in ("0.1", "0.2", "0.5", "1", "2", "5", "10")]
    page.run("window.sent = []; curvebound.send = (command) => sent.push(command)")
    speeds = []
    for by in (*[1] * 4, *[-1] * 7):
        page.run(f"curvebound.faster({by})")
        speeds.append(page.run("sent.at(-1).value"))
    assert speeds == [2, 5, 10, 10, 5, 2, 1, 0.5, 0.2, 0.1, 0.1]
    assert (min(speeds), max(speeds)) == pace.SPEEDS


def test_the_last_notes_stay_and_none_is_said_twice(page: Tab) -> None:
    for text in ("a", "b", "b", "c", "d", "e", "c"):
        page.run(f"curvebound.note('{text}')")
    notes = "[...document.querySelectorAll('#notes span')].map((one) => one.textContent)"
    assert page.run(notes) == ["b", "c", "d", "e"]
    for _ in range(4):
        assert not page.run("document.getElementById('notes').hidden")
        page.run("document.querySelector('#notes button').click()")
    assert page.run("document.getElementById('notes').hidden")


def test_what_is_said_of_the_pace_goes_when_the_scene_rests(page: Tab) -> None:
    text = "document.getElementById('pace').textContent"
    page.run("curvebound.hear(JSON.stringify({ event: 'pace', late: true, speed: 0.504 }))")
    late = "the machine keeps up with 0.50\u00d7 only"
    assert page.run(text) == late
    state = "{ ...curvebound.state, playing: %s, catching_up: %s }"
    for playing, catching_up, said in (
        ("true", "false", late),
        ("false", "false", ""),
        ("true", "true", "catching up"),
        ("true", "false", "catching up"),  # until the next measurement
        ("false", "true", "catching up"),
        ("false", "false", ""),
    ):
        page.run(f"curvebound.stand({state % (playing, catching_up)})")
        assert page.run(text) == said, (playing, catching_up)
    page.run("curvebound.hear(JSON.stringify({ event: 'pace', late: false, speed: 1 }))")
    assert page.run(text) == ""


def test_a_run_beside_is_named_by_two_settings_at_most(page: Tab) -> None:
    change = (
        "(() => {{ const {{ settings }} = curvebound; settings.show({{}}); const one = settings"
        ".fields.filter(({{ input }}) => input.tagName === 'INPUT').slice(0, {count});"
        "one.forEach(({{ input }}, k) => {{ input.value = '{value}' + k; }});"
        "return [settings.label(), one.map((field) => field.one.path.split('.').at(-1))]; }})()"
    )
    assert page.run(change.format(count=0, value="")) == ["the same again", []]
    for count in (1, 2, 3):
        label, names = page.run(change.format(count=count, value="7"))
        assert label == ", ".join(f"{name} 7{k}" for k, name in enumerate(names[:2]))
    label, (name, *_) = page.run(change.format(count=1, value="7" * 80))
    assert label == f"{name} {'7' * 80}"[:60]


def test_the_view_stays_when_a_run_is_set_beside(page: Tab) -> None:
    look = {"zoom": 3, "panX": 7, "panY": -5, "trail": 0.5}
    page.run("curvebound.scene.follow(!curvebound.scene.following)")
    following = page.run("curvebound.scene.following")
    for name, value in look.items():
        page.run(f"curvebound.scene.{name} = {value}")
    page.key("v")
    page.wait("curvebound.scene.actors.length === 2")
    found = page.run("(({ zoom, panX, panY, trail }) => ({ zoom, panX, panY, trail }))"
                     "(curvebound.scene)")  # fmt: skip
    assert found == look
    assert page.run("curvebound.scene.following") is following
    assert page.run("document.getElementById('follow').ariaPressed") == str(following).lower()

"""The replay of every scene that comes with the package, from its own run."""

from __future__ import annotations

from pathlib import Path

import pytest
from browsing import Tab
from test_replay_page import away, middle, show

from curvebound.cosim import load_scene, scene_names
from curvebound.view import write_replay

# One of each FMU; the others, of the same kinds, take half a minute more.
_QUICK = ("inverted_balance", "two_wires")
_MOST = 1.0  # s simulated: enough to see that it moves


@pytest.mark.parametrize(
    "name",
    [
        name if name in _QUICK else pytest.param(name, marks=pytest.mark.slow)
        for name in scene_names()
    ],
)
def test_scene(tab: Tab, tmp_path: Path, name: str) -> None:
    scene = load_scene(name)
    scene.stop_time = min(scene.stop_time, scene.start_time + _MOST)
    data = scene.run().data
    page = write_replay([(name, data)], tmp_path / f"{name}.html")
    tab.open(page, "play=1")
    tab.wait("curvebound.player.time > curvebound.player.start")
    assert tab.errors == []
    assert [url.split("#")[0] for url in tab.requests] == [page.as_uri()]
    tab.run("curvebound.player.pause()")
    tab.run("curvebound.scene.trail = 0")
    actors = tab.run("curvebound.model.actors.map(({ kind }) => kind)")
    assert actors, "every scene has something to draw"
    # Of several bodies the last is drawn on top.
    number = len(actors) - 1
    prefixes = sorted(
        {column.rsplit(".", 2)[0] for column in data.dtype.names if column.endswith(".x")}
    )
    for i in (0, len(data) // 3, len(data) - 1):
        camera = show(tab, float(data["time"][i]))
        for colour, body in ((f"actors[{number}]", "slider"), (f"tints[{number}]", "pendulum")):
            if actors[number] == "BeadOnWire":
                colour, body = f"actors[{number}]", "bead"
            column = f"{prefixes[-1]}.{body}."
            found = middle(tab, colour)
            assert away(camera, found, data[f"{column}x"][i], data[f"{column}y"][i]) < 1.5

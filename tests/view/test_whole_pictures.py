"""Everything that is drawn: pictures, frames of films and what pages are given to draw."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fingerprints import as_text, assert_same
from motions import bead, pendulum, renamed, table

from curvebound.cosim.differences import Difference
from curvebound.view import Movie, animation, picture, write_picture
from curvebound.view.model import build_model
from curvebound.view.replay import About, write_replay
from curvebound.view.stage import Cast


def forced() -> Any:
    """A pendulum that is pushed, with forces recorded, and inputs as a run gives them."""
    data = pendulum(2.0, 0.02, push=3.0)
    extra = {
        "plant.parabola.force": np.sin(data["time"]), "plant.pendulum.tension": 9.0 + data["time"],
        "plant.slider.vx": data["plant.slider.u_rate"], "plant.slider.vy": 0.5 * data["time"],
        "plant.pendulum.vx": -data["time"], "plant.pendulum.vy": 0.1 + 0.0 * data["time"],
        "plant.energy.kinetic": 2.0 + np.cos(data["time"]),
        "plant.energy.potential": 1.0 - np.cos(data["time"]),
        "plant.solver.evaluations": 4.0 * np.arange(len(data)),
    }  # fmt: skip
    return table({**{name: data[name] for name in data.dtype.names}, **extra})


def gaps() -> Any:
    data = bead(3.0, 0.02)
    data["bead.bead.x"][40:60] = np.nan
    data["bead.energy.residual"] = 1e-9 * np.arange(len(data)) ** 2
    return data


CASES: dict[str, Any] = {
    "a bead": bead(3.0, 0.02, radius=2.0),
    "a drifting bead and one that does not": [
        ("held", bead(4.0, 0.05)), ("free", bead(4.0, 0.05, project=False)),
    ],
    "a pushed pendulum": forced(),
    "three pendulums": [
        (str(n), renamed(pendulum(2.0, 0.05, a=0.3 + 0.2 * n), lambda x: x.replace("plant", "p")))
        for n in range(3)
    ],
    "gaps": gaps(),
    "foreign": table({"time": [0.0, 1.0, 2.5], "engine.speed": [1.0, 5.0, 1e4],
                      "engine.mode": [1.0, 1.0, 1.0], "engine.load": [0.0, -1e-3, 2e-3]}),
    "one sample": bead(1.0, 0.01)[:1],
}  # fmt: skip


@pytest.mark.parametrize("stacked", [False, True])
@pytest.mark.parametrize("name", CASES)
def test_pictures(name: str, stacked: bool, tmp_path: Path, monkeypatch) -> None:
    drawn: list[Any] = []
    monkeypatch.setattr(picture, "save_small", lambda figure, path: (
        drawn.append(figure), path.write_text("x")))  # fmt: skip
    write_picture(CASES[name], tmp_path / "a.png", "A title" if stacked else None, stacked=stacked)
    assert_same(f"picture of {name}{' stacked' * stacked}", as_text(drawn[0]))


def test_frames_of_a_film() -> None:
    movie = Movie(seconds=1.0, rate=4, transparent=True)
    for name in ("a pushed pendulum", "a drifting bead and one that does not", "gaps"):
        told = [as_text(one) for one in animation._drawn(Cast(CASES[name], []), movie, clear=True)]
        assert_same(f"film of {name}", "\n".join(told))


@pytest.mark.parametrize("name", CASES)
def test_what_a_page_is_given(name: str) -> None:
    results = CASES[name] if isinstance(CASES[name], list) else [("it", CASES[name])]
    model, packer = build_model(results, "A title", ["a note"], [])
    assert_same(f"replay of {name}", as_text(model))
    assert_same(f"samples of {name}", as_text(packer.channels))


def test_a_page(tmp_path: Path) -> None:
    about = About("A text & more", [Difference("step", "s", (0.1, 0.2))], {"Study": "s/index.html"})
    page = write_replay([("it", CASES["one sample"])], tmp_path / "a.html", about=about)
    text = page.read_text()
    # scripts and styles are no text, nor are their digests
    assert_same("replay page", re.sub("(?s)<(style|script).*?</\\1>|'sha256-[^']*'", "", text))

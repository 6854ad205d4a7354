"""Still pictures and animations."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from motions import bead, pendulum, table
from PIL import Image

from curvebound.errors import CurveboundError
from curvebound.view import Movie, write_gif, write_picture
from curvebound.view.stage import palette


def colours(picture: Image.Image) -> set[str]:
    found = picture.convert("RGB").getcolors(1 << 24)
    assert found is not None
    return {"#{:02x}{:02x}{:02x}".format(*rgb) for _, rgb in found}


def test_a_picture_is_small_and_shows_the_motion(tmp_path: Path) -> None:
    out = write_picture(pendulum(10.0, 0.01), tmp_path / "new" / "pendulum.png", "Pendulum")
    picture = Image.open(out)
    assert picture.size == (900, 460)
    assert out.stat().st_size < 60_000
    assert {"#ffffff", palette()[0]} <= colours(picture)
    assert [path.name for path in out.parent.iterdir()] == ["pendulum.png"], "nothing left over"


def test_several_results_share_a_picture(tmp_path: Path) -> None:
    results = [("held", bead(20.0, 1 / 20)), ("free", bead(20.0, 1 / 20, project=False))]
    picture = Image.open(write_picture(results, tmp_path / "two.png"))
    assert set(palette()[:2]) <= colours(picture)


@pytest.mark.parametrize(
    "data",
    [
        bead(1.0, 0.01)[:1],
        pendulum(1.0, 0.01)[:2],
        table({"time": [0, 1, 2], "engine.speed": [1, 2, 1]}),
        table({"time": [0, 1, 2], "slider.u": [1, np.nan, 1], "energy.residual": [0, 0, 0]}),
    ],
    ids=["one sample", "two samples", "foreign", "half"],
)
def test_odd_results_give_a_sensible_picture(tmp_path: Path, data: np.ndarray) -> None:
    assert len(colours(Image.open(write_picture(data, tmp_path / "odd.png")))) > 5


@pytest.mark.filterwarnings("error")
def test_gaps_and_infinities_draw_without_a_warning(tmp_path: Path) -> None:
    data = bead(4.0, 0.01)
    data["bead.bead.x"][100:200] = np.nan
    data["bead.energy.residual"][50] = np.inf
    data["bead.energy.total"][:] = np.nan

    gaps = np.asarray(Image.open(write_picture(data, tmp_path / "gaps.png")).convert("RGB"))
    whole = write_picture(bead(4.0, 0.01), tmp_path / "whole.png")
    assert {palette()[0], palette()[1]} <= colours(Image.fromarray(gaps))
    # two of the ten pictures of the bead fall into the gap, and the third energy is not there
    apart = (gaps != np.asarray(Image.open(whole).convert("RGB"))).any(axis=2)
    left, right = np.split(apart, [apart.shape[1] // 2], axis=1)
    assert 150 < left.sum() < 500
    assert right.any()


def test_an_animation_runs_in_real_time(tmp_path: Path) -> None:
    out = write_gif(pendulum(5.0, 0.01), tmp_path / "pendulum.gif", movie=Movie(seconds=1.0))
    with Image.open(out) as gif:
        assert gif.n_frames == 26
        assert gif.info["duration"] == 40, "25 frames a second"
        assert gif.info["loop"] == 0
        first = np.asarray(gif.convert("RGB")).astype(int)
        gif.seek(20)
        later = np.asarray(gif.convert("RGB")).astype(int)
    moved = np.abs(later - first).max(axis=2) > 60
    assert 100 < moved.sum() < 0.1 * moved.size
    assert out.stat().st_size < 200_000


def test_nothing_to_draw_is_said(tmp_path: Path) -> None:
    still = table({"time": [0.0, 1.0], "engine.speed": [2.0, 2.0]})
    with pytest.raises(CurveboundError, match="nothing to draw"):
        write_picture(still, tmp_path / "none.png")
    with pytest.raises(CurveboundError, match=r"nothing to animate.*bead\.angle"):
        write_gif(still, tmp_path / "none.gif")
    with pytest.raises(CurveboundError, match="no sample"):
        write_picture(bead(1.0, 0.1)[:0], tmp_path / "none.png")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["matplotlib.figure", "PIL"])
def test_without_matplotlib_the_remedy_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(CurveboundError, match=r"pip install 'curvebound\[plots\]'"):
        write_picture(bead(1.0, 0.1), tmp_path / "none.png")

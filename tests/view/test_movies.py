"""GIF, MP4 and frames: size, rate, transparency; what is said where ffmpeg is missing or fails."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from motions import bead

from curvebound.cli import main
from curvebound.cosim import write_csv
from curvebound.errors import CurveboundError, OutsideError
from curvebound.view import Movie, write_frames, write_gif, write_mp4
from curvebound.view.animation import _drawn
from curvebound.view.stage import Cast

Image = pytest.importorskip("PIL.Image")
pytest.importorskip("matplotlib")
SHORT = Movie(seconds=0.4, rate=10, size=201)


def test_size_and_rate(tmp_path: Path) -> None:
    with Image.open(write_gif(bead(1.0, 0.01), tmp_path / "a.gif", movie=SHORT)) as gif:
        assert gif.size == (201, 201)
        assert gif.n_frames == 5
        assert gif.info["duration"] == 100
        assert "transparency" not in gif.info
    clear = SHORT._replace(transparent=True)
    with Image.open(write_gif(bead(1.0, 0.01), tmp_path / "b.gif", movie=clear)) as gif:
        for number in range(5):
            gif.seek(number)
            alpha = np.asarray(gif.convert("RGBA"))[..., 3]
            assert alpha[2, 2] == 0
            assert 0.02 < (alpha > 0).mean() < 0.5, "what was drawn before does not stay"


def test_frames_for_other_programs(tmp_path: Path) -> None:
    made = write_frames(bead(1.0, 0.01), tmp_path / "frames", movie=SHORT)
    assert [path.name for path in made] == [f"frame_{k:05d}.png" for k in range(5)]
    solid = np.asarray(Image.open(made[0]))
    assert solid.shape == (201, 201, 4)
    assert (solid[..., 3] == 255).all()
    last = np.asarray(Image.open(made[-1]))
    assert (last != solid).any()
    with pytest.raises(CurveboundError, match="holds frames already"):
        write_frames(bead(1.0, 0.01), tmp_path / "frames", movie=SHORT)
    clear = SHORT._replace(transparent=True)
    made = write_frames(bead(1.0, 0.01), tmp_path / "clear", movie=clear)
    picture = np.asarray(Image.open(made[0]))
    assert picture[2, 2, 3] == 0
    assert len(np.unique(picture[..., 3])) > 10, "edges are smooth"


def program(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """An ffmpeg of the test's own."""
    path = folder / "ffmpeg"
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
    path.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")


def test_ffmpeg_is_fed_with_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = 'for last; do :; done\necho "$@" > "$0.told"\nwc -c > "$last"'
    program(tmp_path, text, monkeypatch)
    out = write_mp4(bead(1.0, 0.01), tmp_path / "a.mp4", movie=SHORT)
    assert int(out.read_text()) == 5 * 200 * 200 * 4
    told = (tmp_path / "ffmpeg.told").read_text()
    assert "-s 200x200 -r 10 " in told


def test_what_ffmpeg_says_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program(tmp_path, "echo no such encoder. >&2; exit 1", monkeypatch)
    with pytest.raises(OutsideError, match=r"could not make .*a\.mp4: no such encoder\. Try --gif"):
        write_mp4(bead(1.0, 0.01), tmp_path / "a.mp4", movie=SHORT)
    assert not (tmp_path / "a.mp4").exists()
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    with pytest.raises(OutsideError, match="install it, or take --gif"):
        write_mp4(bead(1.0, 0.01), tmp_path / "a.mp4", movie=SHORT)
    with pytest.raises(CurveboundError, match="no transparency"):
        write_mp4(bead(1.0, 0.01), tmp_path / "a.mp4", movie=SHORT._replace(transparent=True))


def test_a_real_ffmpeg_makes_a_film(tmp_path: Path) -> None:
    ffmpeg = shutil.which("ffmpeg")
    if ffmpeg is None:
        return  # what would be asked of it is tested above
    out = write_mp4(bead(1.0, 0.01), tmp_path / "a.mp4", movie=SHORT)
    done = subprocess.run([ffmpeg, "-i", out], capture_output=True, text=True)
    assert "200x200" in done.stderr
    assert "10 fps" in done.stderr


def test_the_options(tmp_path: Path) -> None:
    csv = str(write_csv(bead(1.0, 0.01), tmp_path / "bead.csv"))
    gif, frames = tmp_path / "a.gif", tmp_path / "frames"
    options = ["--seconds", "0.2", "--fps", "20", "--size", "100", "--transparent"]
    assert main(["replay", csv, "--gif", str(gif), "--frames", str(frames), *options]) == 0
    with Image.open(gif) as made:
        assert (made.size, made.n_frames, made.info["duration"]) == ((100, 100), 5, 50)
    assert len(list(frames.iterdir())) == 5
    assert main(["replay", csv, "--mp4", str(tmp_path / "a.mp4"), "--transparent"]) == 1


def test_frames_show_the_moments_they_stand_for() -> None:
    """From the first result on, with the way of the last 0.8 s, until the film's or run's end."""
    results = bead(2.0, 0.01)
    results["time"] += 0.5
    for seconds, last in ((1.2, 1.7), (9.0, 2.5)):
        shown = []
        for figure in _drawn(Cast(results), Movie(seconds=seconds, rate=10, size=100)):
            (axes,) = figure.axes
            (trail,) = (line for line in axes.lines if line.get_alpha() == 0.45)
            caption = next(text.get_text() for text in axes.texts if " s" in text.get_text())
            shown.append((caption, len(trail.get_xdata()), trail.get_xdata()[-1]))
        assert [caption for caption, *_ in shown] == [
            f"{0.5 + k / 10:.1f} s" for k in range(round(10 * (last - 0.5)) + 1)
        ]
        assert [count for _, count, _ in shown[:10]] == [1, 11, 21, 31, 41, 51, 61, 71, 81, 81]
        assert shown[7][2] == results["bead.bead.x"][70]

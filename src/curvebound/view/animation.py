"""Results as moving pictures in real time: GIF, MP4, or a folder of frames for other programs."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import CurveboundError, OutsideError
from ..files import write_whole
from ..fmi.drawing import Drawing
from .actors import Actor
from .quivers import Quivers, strip_for
from .reading import Results
from .stage import INK, Cast, Stage, figure, pixels

__all__ = ["Movie", "write_frames", "write_gif", "write_mp4"]

_DPI = 100
_TRAIL = 0.8  # s


class Movie(NamedTuple):
    """How results are shown in motion.

    seconds: of the results, from their start. rate: frames a second. size: width and height in
    pixels. transparent: no paper behind what is drawn. arrows: of velocities and forces, by their
    names with commas between, or "all".
    """

    seconds: float = 10.0
    rate: int = 25
    size: int = 420
    transparent: bool = False
    arrows: str = ""


def write_gif(
    results: Results, out: Path, known: Sequence[Drawing] = (), movie: Movie | None = None
) -> Path:
    """Animate results in the GIF `out`, with the arguments of write_picture.

    GIF counts hundredths of a second: a rate should divide 100. Raises CurveboundError where
    matplotlib is missing or the columns hold nothing that can be drawn.
    """
    movie = movie or Movie()
    frames = [pixels(drawn) for drawn in _drawn(Cast(results, known), movie)]
    # white is the first colour of the table: nothing is drawn where it is taken out
    more = {"transparency": 0, "disposal": 2} if movie.transparent else {"disposal": 1}

    def save(path: Path) -> None:
        frames[0].save(
            path, format="GIF", save_all=True, append_images=frames[1:], loop=0,
            duration=max(1, round(100 / movie.rate)) * 10, **more,
        )  # fmt: skip

    return write_whole(out, save)


def write_frames(
    results: Results, folder: Path, known: Sequence[Drawing] = (), movie: Movie | None = None
) -> list[Path]:
    """Draw every frame to a PNG of its own, frame_00000.png and so on, in `folder`.

    Raises CurveboundError as write_gif does, and where the folder holds other frames already.
    """
    movie = movie or Movie()
    if any(folder.glob("frame_*.png")):
        raise CurveboundError(f"{folder} holds frames already: choose another folder.")
    cast = Cast(results, known)
    return [
        write_whole(folder / f"frame_{number:05d}.png", partial(_save, drawn))
        for number, drawn in enumerate(_drawn(cast, movie, clear=movie.transparent))
    ]


def write_mp4(
    results: Results, out: Path, known: Sequence[Drawing] = (), movie: Movie | None = None
) -> Path:
    """Animate results in the MP4 `out` (H.264), by the program ffmpeg.

    Raises CurveboundError as write_gif does, OutsideError where ffmpeg is missing or fails.
    """
    movie = movie or Movie()
    if movie.transparent:
        raise CurveboundError("MP4 knows no transparency: take --gif or --frames for that.")
    program = shutil.which("ffmpeg")
    if program is None:
        raise OutsideError(
            "An MP4 is made by the program ffmpeg, which is not here: install it, or take --gif or "
            "--frames."
        )
    cast = Cast(results, known)

    def save(path: Path) -> None:
        size = movie.size - movie.size % 2  # H.264 takes even sizes only
        command = [
            program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba",
            "-s", f"{size}x{size}", "-r", str(movie.rate), "-i", "-", "-an",
            "-vcodec", "libx264", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4",
            str(path),
        ]  # fmt: skip
        frames = (_rgba(one) for one in _drawn(cast, movie._replace(size=size)))
        said = _fed(command, frames)
        if said is not None:
            raise OutsideError(f"ffmpeg could not make {out}: {said}. Try --gif or --frames.")

    return write_whole(out, save)


def _fed(command: Sequence[str], data: Iterable[bytes]) -> str | None:
    """Run a program that reads `data`; None where it is content, else what it said last."""
    with tempfile.TemporaryFile() as said:  # a pipe that nobody reads would stop it
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said
        )
        assert process.stdin is not None
        try:
            with suppress(BrokenPipeError), process.stdin as pipe:  # it ended before: see below
                for part in data:
                    pipe.write(part)
        except BaseException:
            process.kill()
            raise
        finally:
            status = process.wait()
        said.seek(0)
        lines = said.read().decode(errors="replace").strip().splitlines()
    return None if status == 0 else (lines or ["it gave no reason"])[-1].rstrip(".")


def _drawn(cast: Cast, movie: Movie, *, clear: bool = False) -> Iterator[Any]:
    """The figure of each frame, the same one drawn anew; with `clear` without paper."""
    if not cast.actors:
        raise CurveboundError(f"There is nothing to animate: {cast.missing()}.")
    inches = movie.size / _DPI
    drawn = figure(inches, inches, _DPI)
    axes = drawn.add_axes((0.02, 0.02, 0.96, 0.96))
    stage = Stage(axes, [one.actor for one in cast.actors], strip_for(cast, movie.arrows))
    axes.tick_params(labelbottom=False, labelleft=False, length=0)
    stage.legend(cast)
    if clear:
        drawn.patch.set_alpha(0.0)
        axes.patch.set_alpha(0.0)
    movers = [stage.bodies(one.actor, 0, one.colour) for one in cast.actors]
    trails = [_trail(stage, one.actor, one.colour) for one in cast.actors]
    quivers = Quivers(stage, cast, movie.arrows)
    caption = axes.text(0.97, 0.97, "", transform=axes.transAxes, color=INK, fontsize=9,
                        va="top", ha="right")  # fmt: skip

    start = min(float(one.time[0]) for one in cast.actors)
    end = min(max(float(one.time[-1]) for one in cast.actors), start + movie.seconds)
    for moment in start + np.arange(round((end - start) * movie.rate) + 1) / movie.rate:
        for one, move, (line, x, y) in zip(cast.actors, movers, trails, strict=True):
            at, begin = one.sample(moment), one.sample(moment - _TRAIL)
            move(at)
            line.set_data(x[begin : at + 1], y[begin : at + 1])
        quivers.move(moment)
        caption.set_text(f"{moment:.1f} s")
        yield drawn


def _rgba(drawn: Any) -> bytes:
    drawn.canvas.draw()
    return bytes(drawn.canvas.buffer_rgba())


def _save(drawn: Any, path: Path) -> None:
    from PIL import Image

    data = _rgba(drawn)
    Image.frombytes("RGBA", drawn.canvas.get_width_height(), data).save(path, "PNG")


def _trail(stage: Stage, actor: Actor, colour: str) -> tuple[Any, Any, Any]:
    x, y = stage.path(actor, actor.drawing.points[-1].name)
    line = stage.axes.plot([], [], color=colour, linewidth=1.4, alpha=0.45, zorder=2)[0]
    return line, x, y

"""A result as an animated GIF, in real time, for slides and for places without scripts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import CurveboundError
from ..files import write_whole
from ..fmi.drawing import Drawing
from .actors import Actor
from .reading import Results
from .stage import INK, Cast, Stage, figure, pixels

__all__ = ["write_gif"]

_DPI = 100
_TRAIL = 0.8  # s


def write_gif(
    results: Results,
    out: Path,
    known: Sequence[Drawing] = (),
    *,
    seconds: float = 10.0,
    rate: int = 25,
    inches: float = 4.2,
) -> Path:
    """Draw the first `seconds` of results to the GIF `out`, with the arguments of write_picture.

    `rate` in frames per second should divide 100: GIF counts hundredths of a second. Raises
    CurveboundError where matplotlib is missing or the columns hold nothing that can be drawn.
    """
    cast = Cast(results, known)
    if not cast.actors:
        raise CurveboundError(f"There is nothing to animate: {cast.missing()}.")
    drawn = figure(inches, inches, _DPI)
    axes = drawn.add_axes((0.02, 0.02, 0.96, 0.96))
    stage = Stage(axes, [one.actor for one in cast.actors])
    axes.tick_params(labelbottom=False, labelleft=False, length=0)
    stage.legend(cast)
    movers = [stage.bodies(one.actor, 0, one.colour) for one in cast.actors]
    trails = [_trail(stage, one.actor, one.colour) for one in cast.actors]
    caption = axes.text(0.97, 0.97, "", transform=axes.transAxes, color=INK, fontsize=9,
                        va="top", ha="right")  # fmt: skip

    start = min(float(one.time[0]) for one in cast.actors)
    end = min(max(float(one.time[-1]) for one in cast.actors), start + seconds)
    frames = []
    for moment in start + np.arange(round((end - start) * rate) + 1) / rate:
        for one, move, (line, x, y) in zip(cast.actors, movers, trails, strict=True):
            at, begin = one.sample(moment), one.sample(moment - _TRAIL)
            move(at)
            line.set_data(x[begin : at + 1], y[begin : at + 1])
        caption.set_text(f"{moment:.1f} s")
        frames.append(pixels(drawn))

    def save(path: Path) -> None:
        frames[0].save(
            path, format="GIF", save_all=True, append_images=frames[1:], loop=0,
            duration=round(100 / rate) * 10, disposal=1,
        )  # fmt: skip

    return write_whole(out, save)


def _trail(stage: Stage, actor: Actor, colour: str) -> tuple[Any, Any, Any]:
    x, y = stage.path(actor, actor.drawing.points[-1].name)
    line = stage.axes.plot([], [], color=colour, linewidth=1.4, alpha=0.45, zorder=2)[0]
    return line, x, y

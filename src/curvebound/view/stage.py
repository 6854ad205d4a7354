"""Points, rods and curves on matplotlib axes, for still pictures and animations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import pages
from ..errors import CurveboundError
from ..fmi.drawing import FRAME, Circle, Curve, Drawing
from ..fmi.folder import shipped_drawings
from .actors import Actor, Floats, find_actors, missing
from .geometry import follows_frame, view_of
from .reading import Results, opened

__all__ = [
    "GREY",
    "INK",
    "Cast",
    "Role",
    "Stage",
    "as_floats",
    "colour_of",
    "figure",
    "palette",
    "pixels",
    "save_small",
]

INK = "#1b222c"
GREY = "#8793a3"
_PAPER = "white"
_ROUNDING = 1e-12
_LIGHTER = 0.32  # the share of paper in a light body
_TINTS = 14  # of each of 18 colours; with white 253, and a picture has 256


def figure(width: float, height: float, dpi: int) -> Any:
    """An empty matplotlib figure in inches, without touching the user's settings or display.

    Raises CurveboundError where matplotlib or Pillow are not installed.
    """
    try:
        import PIL  # noqa: F401
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise CurveboundError(
            f"Pictures need {error.name}, which is not installed. "
            "Install it with `pip install 'curvebound[plots]'`."
        ) from error
    made = Figure(figsize=(width, height), dpi=dpi, facecolor=_PAPER)
    FigureCanvasAgg(made)
    return made


def pixels(drawn: Any, *, dark: bool = False) -> Any:
    """A figure as a Pillow picture that knows only our colours and their tints.

    dark: each colour as the one of that name in the dark theme.

    A general quantiser gives rare colours to frequent ones, so that a thin line takes the hue of
    another; a fixed table keeps every hue, and the same one in all frames of an animation.
    """
    from PIL import Image

    drawn.canvas.draw()
    width, height = drawn.canvas.get_width_height()
    codes = np.frombuffer(drawn.canvas.buffer_rgba(), dtype="<u4")  # 0xAABBGGRR
    table = _tints()
    indices = np.zeros(codes.shape, dtype=np.uint8)  # of white, most of every picture
    inked = np.flatnonzero(codes != 0xFFFFFFFF)
    found, places = np.unique(codes[inked], return_inverse=True)
    colours = np.stack([found & 255, found >> 8 & 255, found >> 16 & 255], axis=1).astype(np.int32)
    # |a - b|^2 = a.a - 2 a.b + b.b, of which the first is the same for every b
    gaps = (table * table).sum(axis=1) - 2 * (colours @ table.T)
    indices[inked] = gaps.argmin(axis=1).astype(np.uint8)[places]
    picture = Image.frombytes("P", (width, height), indices.tobytes())
    picture.putpalette(_tints(dark=dark).astype(np.uint8).tobytes())
    return picture


@cache
def _tints(*, dark: bool = False) -> NDArray[np.int32]:
    """Paper, then every colour in use in steps down to it, shape (colours, 3)."""
    named = pages.palette(dark=dark)
    results = [colour for name, colour in named.items() if name.startswith("result-")]

    def numbers(colour: str) -> NDArray[np.float64]:
        return np.array([float(int(colour[i : i + 2], 16)) for i in (1, 3, 5)])

    paper = numbers(named["paper"])
    colours = [numbers(colour) for colour in (*results, named["ink"], named["curve"])]
    lighter = [one + _LIGHTER * (paper - one) for one in colours[: len(results)]]
    levels = np.linspace(1.0, 0.0, _TINTS, endpoint=False)[:, None, None]
    tints = paper - levels * (paper - np.array([*colours, *lighter]))
    every = np.concatenate(([paper], tints.reshape(-1, 3)))
    return np.asarray(np.rint(every), dtype=np.int32)


def save_small(drawn: Any, out: Any, *, dark: bool = False) -> None:
    """Write a figure as PNG with a palette: smaller, to the eye the same."""
    pixels(drawn, dark=dark).save(out, "PNG", optimize=True)


def palette() -> list[str]:
    """The colours of results on the pages, in the light theme."""
    return [colour for name, colour in pages.palette().items() if name.startswith("result-")]


def colour_of(number: int) -> str:
    """The colour of the n-th thing, counted from 0; after the last the first comes again."""
    colours = palette()
    return colours[number % len(colours)]


def as_floats(column: NDArray[Any]) -> Floats:
    """A column as floats, what is not finite as NaN."""
    values = np.asarray(column, dtype=np.float64)
    return np.where(np.isfinite(values), values, np.nan)


def _lighter(colour: str, share: float = _LIGHTER) -> tuple[float, float, float]:
    part = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    return (
        part[0] * (1.0 - share) + share,
        part[1] * (1.0 - share) + share,
        part[2] * (1.0 - share) + share,
    )


@dataclass(frozen=True)
class Role:
    """An actor with its name, its colour and the times of its samples."""

    label: str
    actor: Actor
    colour: str
    time: Floats
    data: NDArray[Any]

    @property
    def last(self) -> int:
        """The last sample."""
        return len(self.time) - 1

    def sample(self, t: float) -> int:
        """The first sample not before t, but for rounding."""
        return min(int(np.searchsorted(self.time, t - 1e-9)), self.last)


class Cast:
    """Everything to draw of one result, or of several with labels."""

    def __init__(self, results: Results, known: Sequence[Drawing] = ()) -> None:
        self.known = [*known, *shipped_drawings()]
        self.results = opened(results, self.known)
        if not self.results:
            raise CurveboundError("There is no result to draw. Give at least one.")
        self.actors: list[Role] = []
        for result in self.results:
            time = as_floats(result.data["time"])
            found = find_actors(result.data, result.drawings)
            for actor in found:
                component = actor.prefix.rstrip(".")
                name = result.label if len(found) == 1 else component
                if len(found) > 1 and len(self.results) > 1:
                    name = f"{result.label}: {component}"
                colour = colour_of(len(self.actors))
                self.actors.append(Role(name, actor, colour, time, result.data))

    def drawings(self) -> list[Drawing]:
        """The drawings of all components, each once."""
        every = [one for result in self.results for one in result.drawings.values()]
        return list({one.name: one for one in every}.values())

    def missing(self) -> str:
        """In words, what the first result lacks to be drawn."""
        return missing(self.results[0].data, self.known)

    def owners(self) -> list[tuple[str, dict[str, Drawing], NDArray[Any], str]]:
        """(label, drawings by prefix of its columns, data, colour) of what has plots."""
        if self.actors:
            return [
                (one.label, {one.actor.prefix: one.actor.drawing}, one.data, one.colour)
                for one in self.actors
            ]
        return [
            (result.label, result.drawings, result.data, colour_of(number))
            for number, result in enumerate(self.results)
        ]


class Stage:
    """Axes to scale that show actors, from their frame where that travels far."""

    def __init__(self, axes: Any, actors: list[Actor], strip: float = 0.0) -> None:
        self.axes = axes
        self.actors = actors
        # Room for a legend, in inches, between where the axes ended below and where they end now.
        left, bottom, width, height = axes.get_position().bounds
        raised = strip / axes.figure.get_figheight()
        axes.set_position((left, bottom + raised, width, height - raised))
        self.relative = follows_frame(actors)
        left, bottom, right, top = view_of(actors)["frame" if self.relative else "world"]
        # To scale, and the whole of the axes used: the limits give way, not the box.
        box = axes.get_window_extent()
        scale = max((right - left) / box.width, (top - bottom) / box.height)
        middle_x, middle_y = (left + right) / 2.0, (bottom + top) / 2.0
        axes.set_xlim(middle_x - scale * box.width / 2.0, middle_x + scale * box.width / 2.0)
        axes.set_ylim(middle_y - scale * box.height / 2.0, middle_y + scale * box.height / 2.0)
        for spine in axes.spines.values():
            spine.set_color("#d5dbe3")
        axes.tick_params(labelcolor=INK, labelsize=7, length=2, color="#d5dbe3")
        axes.locator_params(nbins=6)
        axes.grid(color="#eef1f5", linewidth=0.7)
        axes.set_axisbelow(True)

    def path(self, actor: Actor, point: str) -> tuple[Floats, Floats]:
        """Where a point of an actor goes, shape (samples,), in the coordinates of the axes."""
        x, y = actor.at(point)
        frame_x, frame_y = self._origin(actor)
        return x - frame_x, y - frame_y

    def _origin(self, actor: Actor) -> tuple[Floats, Floats]:
        """The origin of the axes in the world, shape (samples,)."""
        x, y = actor.at(FRAME)
        return (x, y) if self.relative else (np.zeros_like(x), np.zeros_like(y))

    def trace(self, actor: Actor, colour: str) -> None:
        """The whole path of the last point as a thin line."""
        x, y = self.path(actor, actor.drawing.points[-1].name)
        self.axes.plot(x, y, color=colour, linewidth=0.6, alpha=0.35, zorder=2)

    def bodies(
        self, actor: Actor, at: int, colour: str, alpha: float = 1.0
    ) -> Callable[[int], None]:
        """Draw an actor at sample `at`; returns what moves the drawing to another sample."""
        plot = self.axes.plot
        moving: list[tuple[Any, Callable[[int], tuple[Any, Any]]]] = []

        def add(where: Callable[[int], tuple[Any, Any]], *style: Any, **more: Any) -> None:
            moving.append((plot(*where(at), *style, **more)[0], where))

        def through(*points: str) -> Callable[[int], tuple[Any, Any]]:
            paths = [self.path(actor, point) for point in points]
            return lambda k: ([x[k] for x, _ in paths], [y[k] for _, y in paths])

        drawing = actor.drawing
        curves: list[Circle | Curve] = [*drawing.circles, *drawing.curves]
        for curve in curves:
            alone = 1.0 if self._rests(actor, curve) else alpha
            add(self._curve(actor, curve), color=GREY, linewidth=1.6, zorder=1, alpha=alone)
        for rod in drawing.rods:
            add(through(*rod), color=INK, linewidth=1.1, alpha=alpha, zorder=3)
        rim: dict[str, Any] = {"alpha": alpha, "markeredgecolor": _PAPER, "markeredgewidth": 0.8}
        for point in drawing.points:
            square = point.shape == "square"
            tint = _lighter(colour) if point.light else colour
            add(
                through(point.name),
                "s" if square else "o",
                color=tint,
                markersize=7 if square else 9.5,
                zorder=4,
                **rim,
            )

        def move(k: int) -> None:
            for line, where in moving:
                line.set_data(*where(k))

        return move

    def legend(self, cast: Cast) -> None:
        """Tell the colours, where there are several."""
        if len(cast.actors) < 2:
            return
        for one in cast.actors:
            self.axes.plot([], [], "o", color=one.colour, markersize=6, label=one.label)
        self.axes.legend(fontsize=7.5, frameon=False, loc="upper left", labelcolor=INK)

    def _rests(self, actor: Actor, curve: Circle | Curve) -> bool:
        """Whether a curve looks the same at all times."""
        left, low = self._origin(actor)
        shown = [actor.of(curve.x, 1.0) - left, actor.of(curve.y, 1.0) - low]
        if isinstance(curve, Circle):
            shown.append(actor.of(curve.radius))
        return all(np.ptp(x) <= _ROUNDING * np.max(np.abs(x)) for x in shown)

    def _curve(self, actor: Actor, curve: Circle | Curve) -> Callable[[int], tuple[Floats, Floats]]:
        """A curve at a sample."""
        left, low = self._origin(actor)
        if isinstance(curve, Circle):
            turn = np.linspace(0.0, 2.0 * np.pi, 181)
            x, y, radius = (actor.of(formula) for formula in curve[:3])
            return lambda k: (
                x[k] - left[k] + radius[k] * np.cos(turn),
                y[k] - low[k] + radius[k] * np.sin(turn),
            )
        s = np.linspace(*actor.span(curve), 97)
        return lambda k: (
            actor.of(curve.x, s, k) - left[k],
            actor.of(curve.y, s, k) - low[k],
        )

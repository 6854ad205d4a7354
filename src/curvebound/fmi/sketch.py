"""The sketch of a system in its documentation: its drawing with symbols and axes, as SVG.

SKETCH in fmus/NAME/drawing.py says which variable is which length, angle or mass of the drawing.
Colours are those of pages/report.css.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from typing import NamedTuple

from .drawing import FRAME, Curve, Drawing
from .formula import parse, value_of

__all__ = ["Angle", "Length", "Sketch", "sketch_of"]

_Place = tuple[float, float]

_SPAN, _MARGIN, _LABEL = 300.0, 34.0, 22.0  # longer side, around it, right of it, in pixels
_ALONG = 48  # pieces of a curve
_BEYOND = 1.4  # how much farther a curve goes than the point that it holds


class Length(NamedTuple):
    """A length between two points of the drawing, FRAME among them, that is a variable's value.

    horizontal: measured along the x axis only.
    """

    start: str
    end: str
    variable: str
    horizontal: bool = False


class Angle(NamedTuple):
    """The angle at a point that the line `towards` another has, counter-clockwise.

    since: direction from which it counts, in rad from the x axis; by default downwards.
    """

    at: str
    towards: str
    variable: str
    since: float = -0.5 * math.pi


class Sketch(NamedTuple):
    """What is written at a drawing.

    symbols: of variables, in the order in which they are explained below the sketch.
    masses: point -> variable. curve: what the first curve is called, such as "y = a x²".
    values: of variables, for a pose that shows them all; otherwise that of the start.
    """

    symbols: dict[str, str] = {}
    masses: dict[str, str] = {}
    lengths: tuple[Length, ...] = ()
    angles: tuple[Angle, ...] = ()
    curve: str = ""
    values: dict[str, float] = {}

    def variables(self) -> set[str]:
        """All variables that it names."""
        named = {one.variable for one in self.lengths} | {one.variable for one in self.angles}
        return named | {*self.symbols, *self.masses.values(), *self.values}


def sketch_of(drawing: Drawing, marks: Sketch, start: Mapping[str, float]) -> str:
    """An SVG element; empty where the drawing has nothing but plots.

    start: what outputs are at the start, where the marks give no other value.
    """
    pose = _Pose(drawing, marks, start)
    if not pose.outline:
        return ""
    shapes = [
        *_axes(pose),
        *(f'<polyline class="curve" points="{_points(pose, line)}"/>' for line in pose.lines),
        *(
            f'<circle class="curve" cx="{x:.1f}" cy="{y:.1f}" r="{radius * pose.scale:.1f}"/>'
            for x, y, radius in ((*pose.at(x, y), radius) for x, y, radius in pose.circles)
        ),
        *(_line("rod", pose.point(rod.start), pose.point(rod.end)) for rod in drawing.rods),
        *(shape for one in marks.lengths for shape in _length(pose, one)),
        *(shape for one in marks.angles for shape in _angle(pose, one)),
        *_bodies(pose),
        *_gravity(pose),
    ]
    if marks.curve and pose.lines:
        x, y = pose.at(*pose.lines[0][0])
        shapes.append(_word(x + 12.0, y - 6.0, marks.curve, "start"))
    return (
        f'<svg class="sketch" viewBox="0 0 {pose.width:.0f} {pose.height:.0f}" role="img" '
        f'aria-label="sketch of {escape(drawing.name)}">{"".join(shapes)}</svg>'
    )


class _Pose:
    """Where everything is: in metres, and in pixels."""

    def __init__(self, drawing: Drawing, marks: Sketch, start: Mapping[str, float]) -> None:
        self.drawing = drawing
        self.marks = marks
        self._start = start
        self._values = {**drawing.values, **marks.values}
        self._asked = 0  # variables that wait for others
        self.places = {FRAME: (self._value(drawing.frame[0]), self._value(drawing.frame[1]))}
        for one in drawing.points:
            self.places[one.name] = (self._value(one.x), self._value(one.y))
        self.circles = [
            (self._value(one.x), self._value(one.y), abs(self._value(one.radius)))
            for one in drawing.circles
        ]
        self.lines = [self._curve(one) for one in drawing.curves]
        outline = [self.places[one.name] for one in drawing.points]
        for x, y, radius in self.circles:
            outline += [(x - radius, y - radius), (x + radius, y + radius)]
        for line in self.lines:
            outline += line
        #: places that the sketch must hold, with the frame; none where there is nothing to draw
        self.outline = [place for place in outline if all(map(math.isfinite, place))]
        if self.outline:
            self._fit(self.outline, self.places[FRAME])

    def _fit(self, places: list[_Place], frame: _Place) -> None:
        places = [*places, frame]
        left, right = min(x for x, _ in places), max(x for x, _ in places)
        bottom, top = min(y for _, y in places), max(y for _, y in places)
        self.scale = _SPAN / (max(right - left, top - bottom) or 1.0)
        # the axes stand at the frame, whatever else is there
        right = max(right, frame[0] + 45.0 / self.scale)
        top = max(top, frame[1] + 45.0 / self.scale)
        bottom = min(bottom, frame[1] - 20.0 / self.scale)
        self.width = (right - left) * self.scale + 2.0 * _MARGIN + _LABEL
        self.height = (top - bottom) * self.scale + 2.0 * _MARGIN
        self._left, self._top = left, top

    def at(self, x: float, y: float) -> _Place:
        """A place in pixels."""
        return (
            (x - self._left) * self.scale + _MARGIN,
            (self._top - y) * self.scale + _MARGIN,
        )

    def point(self, name: str) -> _Place:
        """A point of the drawing, or its frame, in pixels."""
        return self.at(*self.places[name])

    def symbol(self, variable: str) -> str:
        """What a variable is called in the sketch."""
        return self.marks.symbols.get(variable, variable)

    def known(self, name: str) -> float:
        """The value of a variable: as marked, as declared, from others, or as at the start."""
        if name in self._values:
            return self._values[name]
        ways = self.drawing.otherwise.get(name, ()) if self.marks.values else ()
        self._values[name] = math.nan  # for formulas that lead back to it
        self._asked += 1
        found = (value_of(parse(text, samples=True), self.known) for text in ways)
        value = next(filter(math.isfinite, found), math.nan)
        self._asked -= 1
        if math.isnan(value) and not (ways and self._asked):
            value = self._start.get(name, 0.0)
        self._values[name] = value
        if math.isnan(value):
            del self._values[name]  # another way may lead to it
        return value

    def _value(self, text: str) -> float:
        return value_of(parse(text), self.known)

    def _curve(self, curve: Curve) -> list[_Place]:
        if curve.s is None:
            reach = _BEYOND * abs(self.places[curve.holds][0] - self.places[FRAME][0]) or 1.0
            low, high = -reach, reach
        else:
            low, high = curve.s
        x, y = parse(curve.x), parse(curve.y)

        def at(s: float) -> _Place:
            def known(name: str) -> float:
                return s if name == "s" else self.known(name)

            return value_of(x, known), value_of(y, known)

        return [at(low + (high - low) * i / _ALONG) for i in range(_ALONG + 1)]


def _points(pose: _Pose, line: list[_Place]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in (pose.at(*place) for place in line))


def _line(kind: str, start: _Place, end: _Place) -> str:
    return f'<path class="{kind}" d="M{start[0]:.1f} {start[1]:.1f}L{end[0]:.1f} {end[1]:.1f}"/>'


def _word(x: float, y: float, text: str, anchor: str = "middle") -> str:
    """Text whose middle, or whose start, is at (x, y)."""
    return f'<text x="{x:.1f}" y="{y + 5.0:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _arrow(kind: str, start: _Place, dx: float, dy: float) -> str:
    """An arrow of (dx, dy) pixels, with its head."""
    x, y = start[0] + dx, start[1] + dy
    long = math.hypot(dx, dy)
    ux, uy = 7.0 * dx / long, 7.0 * dy / long
    return (
        f'<path class="{kind}" d="M{start[0]:.1f} {start[1]:.1f}l{dx:.1f} {dy:.1f}'
        f"M{x - ux - 0.5 * uy:.1f} {y - uy + 0.5 * ux:.1f}L{x:.1f} {y:.1f}"
        f'L{x - ux + 0.5 * uy:.1f} {y - uy - 0.5 * ux:.1f}"/>'
    )


def _axes(pose: _Pose) -> list[str]:
    x, y = pose.point(FRAME)
    return [
        _arrow("axis", (x, y), 62.0, 0.0),
        _arrow("axis", (x, y), 0.0, -62.0),
        _word(x + 58.0, y + 13.0, "x"),
        _word(x - 12.0, y - 58.0, "y"),
    ]


def _length(pose: _Pose, one: Length) -> list[str]:
    start, end = pose.point(one.start), pose.point(one.end)
    shapes = []
    if one.horizontal:  # on a line of its own, below the axis
        level = start[1] + 28.0
        shapes += [_line("help", start, (start[0], level)), _line("help", end, (end[0], level))]
        start, end = (end[0], level), (start[0], level)
    dx, dy = end[0] - start[0], end[1] - start[1]
    long = math.hypot(dx, dy) or 1.0
    # beside the middle, to the left as seen along it: angles open on the right
    x = 0.5 * (start[0] + end[0]) + 13.0 * dy / long
    y = 0.5 * (start[1] + end[1]) - 13.0 * dx / long
    return [*shapes, _line("length", start, end), _word(x, y, pose.symbol(one.variable))]


def _angle(pose: _Pose, one: Angle) -> list[str]:
    (x, y), (to_x, to_y) = pose.point(one.at), pose.point(one.towards)
    end = math.atan2(y - to_y, to_x - x)
    end = one.since + (end - one.since) % (2.0 * math.pi)
    radius = 40.0
    begun = (x + radius * math.cos(one.since), y - radius * math.sin(one.since))
    done = (x + radius * math.cos(end), y - radius * math.sin(end))
    middle = 0.5 * (one.since + end)
    large = int(end - one.since > math.pi)
    foot = (x + 1.5 * radius * math.cos(one.since), y - 1.5 * radius * math.sin(one.since))
    return [
        _line("help", (x, y), foot),
        f'<path class="length" d="M{begun[0]:.1f} {begun[1]:.1f}'
        f'A{radius:.0f} {radius:.0f} 0 {large} 0 {done[0]:.1f} {done[1]:.1f}"/>',
        _word(
            x + 0.68 * radius * math.cos(middle),
            y - 0.68 * radius * math.sin(middle),
            pose.symbol(one.variable),
        ),
    ]


def _bodies(pose: _Pose) -> list[str]:
    shapes = []
    for one in pose.drawing.points:
        x, y = pose.point(one.name)
        kind = "body light" if one.light else "body"
        if one.shape == "square":
            shapes.append(
                f'<rect class="{kind}" x="{x - 9:.1f}" y="{y - 9:.1f}" width="18" height="18"/>'
            )
        else:
            shapes.append(f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="10"/>')
        words = pose.marks.masses.get(one.name)
        text = pose.symbol(words) if words else one.name
        shapes.append(_word(x + 15.0, y - 14.0, text, "start"))
    return shapes


def _gravity(pose: _Pose) -> list[str]:
    """An arrow in the direction of gravity, in the upper right corner."""
    gx, gy = (pose.known(f"gravity.{axis}") for axis in ("x", "y"))
    size = math.hypot(gx, gy)
    if size == 0.0:
        return []
    dx, dy = 40.0 * gx / size, -40.0 * gy / size
    x, y = pose.width - 22.0, 12.0 + max(0.0, -dy)
    return [_arrow("length", (x, y), dx, dy), _word(x - 12.0, y + 0.5 * dy, "g")]

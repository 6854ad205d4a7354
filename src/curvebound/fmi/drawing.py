"""How the picture of a system is written down: the vocabulary of fmus/NAME/drawing.py.

Everything is said in the names of the FMU's variables, in metres and in the world's frame; what it
looks like on a screen is the matter of whoever draws it. An FMU carries its drawing as
resources/drawing.json.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any, NamedTuple

from ..errors import CurveboundError, nearest
from .declaration import COUNT, OUTPUT, PARAMETER, Fmu
from .formula import parse, variables_of

__all__ = [
    "ENERGY_PLOTS",
    "FRAME",
    "Arrow",
    "Circle",
    "Curve",
    "Drawing",
    "Plot",
    "Point",
    "Rod",
    "carried",
    "complete",
    "known",
    "mass_arrows",
    "plane",
    "read",
]

#: the name by which a rod ends at the frame
FRAME = "frame"


class Point(NamedTuple):
    """A body at (x, y), formulas in the names of variables.

    shape: "square" or "round"; "" tells several results apart by a shape for each.
    light: in a lighter tint, as the second body of a system.
    """

    name: str
    x: str
    y: str
    shape: str = ""
    light: bool = False


class Rod(NamedTuple):
    """A straight line between two points, by their names; FRAME is the frame's origin."""

    start: str
    end: str


class Circle(NamedTuple):
    """A circle about (x, y), formulas; a point that it `holds` is seen leaving it."""

    x: str
    y: str
    radius: str
    holds: str = ""


class Curve(NamedTuple):
    """A curve (x(s), y(s)), formulas in the names of variables and in s.

    s runs over the given range; without one, as far to either side of the frame as the point that
    it `holds` goes horizontally.
    """

    x: str
    y: str
    s: tuple[float, float] | None = None
    holds: str = ""


class Arrow(NamedTuple):
    """A vector (x, y) at a point, or at FRAME, that is drawn for those who ask for it.

    name: what it is, for the legend; symbol: the letter beside its tip. x, y: formulas, in `unit`;
    arrows of one unit share a scale.
    """

    name: str
    symbol: str
    at: str
    x: str
    y: str
    unit: str = "N"

    def variables(self) -> set[str]:
        """The variables that it needs."""
        return variables_of(parse(self.x)) | variables_of(parse(self.y))


class Plot(NamedTuple):
    """Variables of one unit that share axes.

    moving: left out where every variable is constant. shown: at once, else offered only.
    error: they measure an error, for which a logarithmic axis is meant.
    """

    title: str
    names: tuple[str, ...]
    moving: bool = False
    shown: bool = True
    error: bool = False


ENERGY_PLOTS = (
    Plot("Energy", ("energy.kinetic", "energy.potential", "energy.total")),
    Plot("Energy residual", ("energy.residual",), error=True),
)
_SOLVER_PLOT = Plot("Work of the solver", ("solver.steps", "solver.evaluations"), shown=False)

_WORDS: dict[str, str | tuple[str, str]] = {
    "energy.kinetic": ("kinetic", "kinetic energy"),
    "energy.potential": ("potential", "potential energy"),
    "energy.total": ("total", "total energy"),
    "energy.residual": ("residual", "energy residual"),
    "solver.steps": ("steps", "solver steps"),
    "solver.evaluations": ("evaluations", "solver evaluations"),
}


class Drawing(NamedTuple):
    """What to draw of a system, and which of its variables to plot and to tell.

    frame: origin of the frame that moves, as formulas.
    otherwise: formulas for variables that a result may lack, such as parameters: from other
        variables, the best first. `first` and `median` of a formula run over all samples.
    words: what variables are called for the eye; a pair tells the name under a plot's title from
        that which needs no title. Without any a variable is called by its name.
    plots: in the order in which they are shown; outputs without a plot are offered.
    readouts: the variables that are told beside the picture.

    The rest is filled in from the FMU: its name, units and outputs, and the values of parameters,
    which are `known` where they are those of the run instead of the declared start values.
    """

    points: tuple[Point, ...] = ()
    rods: tuple[Rod, ...] = ()
    circles: tuple[Circle, ...] = ()
    curves: tuple[Curve, ...] = ()
    arrows: tuple[Arrow, ...] = ()
    frame: tuple[str, str] = ("0", "0")
    otherwise: dict[str, tuple[str, ...]] = {}
    words: dict[str, str | tuple[str, str]] = {}
    plots: tuple[Plot, ...] = ()
    readouts: tuple[str, ...] = ()
    name: str = ""
    units: dict[str, str] = {}
    outputs: tuple[str, ...] = ()
    values: dict[str, float] = {}
    known: bool = False

    def words_of(self, variable: str) -> tuple[str, str]:
        """What a variable is called under a plot's title, and where there is none."""
        words = self.words.get(variable, variable.replace(".", " ").replace("_", " "))
        return (words, words) if isinstance(words, str) else words

    def of_arrows(self) -> set[str]:
        """The variables that the arrows need."""
        return set().union(*(arrow.variables() for arrow in self.arrows))


def plane(name: str, words: str) -> dict[str, str]:
    """Words for the two components of a vector, `name` with {} in place of the axis."""
    return {name.format(axis): f"{words} {axis}" for axis in ("x", "y")}


def mass_arrows(name: str, at: str = "") -> tuple[Arrow, ...]:
    """Velocity, applied force and gravity of a point mass, by its variables; `at` its point."""
    return (
        Arrow("velocity", "v", at or name, f"{name}.vx", f"{name}.vy", "m/s"),
        Arrow("applied force", "F", at or name, f"{name}.fx", f"{name}.fy"),
        Arrow("gravity", "G", at or name, f"{name}.mass * gravity.x", f"{name}.mass * gravity.y"),
    )


def complete(drawing: Drawing, fmu: Fmu) -> Drawing:
    """The drawing with what the declaration of its FMU adds.

    Raises CurveboundError where it names a variable that the FMU lacks, or a formula is none.
    """
    outputs = tuple(v.name for v in fmu.ordered() if v.kind in (OUTPUT, COUNT))
    made = drawing._replace(
        words={**_WORDS, **drawing.words},
        name=fmu.name,
        units={v.name: v.unit for v in fmu.ordered() if v.type is None},
        outputs=outputs,
        values={v.name: v.start for v in fmu.ordered() if v.kind == PARAMETER},
    )
    plots = list(drawing.plots) or [Plot(made.words_of(name)[1], (name,)) for name in fmu.plotted]
    plotted = {name for plot in plots for name in plot.names}
    for plot in (*ENERGY_PLOTS, _SOLVER_PLOT):
        if set(plot.names) <= set(outputs) and not set(plot.names) & plotted:
            plots.append(plot)
            plotted.update(plot.names)
    plots += [
        Plot(made.words_of(name)[1], (name,), shown=False)
        for name in outputs
        if name not in plotted
    ]
    made = made._replace(plots=tuple(plots), readouts=drawing.readouts or fmu.plotted)
    _check(made)
    return made


def _check(drawing: Drawing) -> None:
    """Raise CurveboundError for names that are not there and for what is no formula."""
    names = {point.name for point in drawing.points}
    for rod in drawing.rods:
        for end in rod:
            known(drawing, end, names | {FRAME}, "a point of the drawing")
    for arrow in drawing.arrows:
        known(drawing, arrow.at, names | {FRAME}, "a point of the drawing")
    for held in [line.holds for line in drawing.circles] + [line.holds for line in drawing.curves]:
        if held:
            known(drawing, held, names, "a point of the drawing")
    for curve in drawing.curves:
        if curve.s is None and not curve.holds:
            raise CurveboundError(
                f"the drawing of {drawing.name}: the curve ({curve.x}, {curve.y}) needs a range of "
                "s, or the name of a point that it holds"
            )
    for text in (
        *drawing.frame,
        *(text for point in drawing.points for text in (point.x, point.y)),
        *(text for circle in drawing.circles for text in circle[:3]),
        *(text for arrow in drawing.arrows for text in (arrow.x, arrow.y)),
    ):
        _formula(drawing, text)
    for curve in drawing.curves:
        _formula(drawing, curve.x, ("s",))
        _formula(drawing, curve.y, ("s",))
    for name, ways in drawing.otherwise.items():
        known(drawing, name, drawing.units, "a variable")
        for text in ways:
            _formula(drawing, text, samples=True)
    for plot in drawing.plots:
        for name in plot.names:
            known(drawing, name, drawing.units, "a variable")
        if len({drawing.units[name] for name in plot.names}) > 1:
            raise CurveboundError(
                f"the drawing of {drawing.name}: the plot {plot.title!r} mixes units; "
                "give each unit a plot"
            )
    for name in (*drawing.words, *drawing.readouts):
        if name not in _WORDS:
            known(drawing, name, drawing.units, "a variable")


def _formula(
    drawing: Drawing, text: str, extra: tuple[str, ...] = (), *, samples: bool = False
) -> None:
    for name in sorted(variables_of(parse(text, samples=samples)) - set(extra)):
        known(drawing, name, drawing.units, "a variable")


def known(drawing: Drawing, name: str, among: Iterable[str], what: str) -> None:
    """Raise CurveboundError unless the drawing's `name` is `among` those; `what` they are."""
    if name not in among:
        raise CurveboundError(
            f"the drawing of {drawing.name} names {name!r}, which is not {what} of it; "
            + nearest(name, sorted(among))
        )


def carried(drawing: Drawing) -> bytes:
    """A completed drawing as the JSON that an FMU carries."""
    plain = drawing._asdict()
    for part in _PARTS:
        plain[part] = [one._asdict() for one in plain[part]]
    return (json.dumps(plain, indent=1, sort_keys=True) + "\n").encode()


def read(data: bytes) -> Drawing:
    """The drawing in an FMU's resources/drawing.json; CurveboundError where it is none."""
    try:
        plain: dict[str, Any] = json.loads(data)
        for part, kind in _PARTS.items():
            plain[part] = tuple(
                kind(**{k: tuple(v) if isinstance(v, list) else v for k, v in one.items()})
                for one in plain.get(part, [])  # FMUs of before may lack one
            )
        for part in ("frame", "readouts", "outputs"):
            plain[part] = tuple(plain[part])
        plain["otherwise"] = {name: tuple(ways) for name, ways in plain["otherwise"].items()}
        plain["words"] = {
            name: words if isinstance(words, str) else tuple(words)
            for name, words in plain["words"].items()
        }
        return Drawing(**plain)
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise CurveboundError(f"resources/drawing.json is no drawing: {error}") from error


_PARTS: dict[str, Any] = {
    "points": Point,
    "rods": Rod,
    "circles": Circle,
    "curves": Curve,
    "arrows": Arrow,
    "plots": Plot,
}

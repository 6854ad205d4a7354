"""What the page draws and offers of a scene, as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from ...cosim.system import System, path_of
from ...fmi.drawing import FRAME, Drawing
from ...fmi.formula import Tree, parse, variables_of
from ..actors import Actor, find_actors
from ..arrows import kinds_of
from ..geometry import view_of
from ..quantities import plots_of, quantity, readouts_of
from .controls import own_settings
from .plan import Plan

__all__ = ["actors_of", "describe"]


def describe(plan: Plan) -> dict[str, Any]:
    """What stays the same while the page is open, JSON-able."""
    scene = plan.scene
    seen = _seen(plan)
    made: dict[str, Any] = {
        "name": scene.name,
        "description": scene.description,
        "start": scene.start_time,
        "step": scene.step,
        "columns": _columns(plan),
        "arrows": [asdict(kind) for kind in kinds_of((*one, plan.seen) for one in seen)],
        "controls": [asdict(control) for control in plan.controls.values()],
        "settings": [
            *own_settings(plan.system),
            *(asdict(control) for control in plan.settings.values()),
        ],
        "variants": list(scene.variants),
        "grips": [
            {"component": grip.component, "point": grip.point, "force": grip.force}
            for grip in plan.grips
        ],
        "canGoBack": plan.can_go_back,
        "plots": _plots(plan),
        "readouts": _readouts(plan),
        "notes": plan.notes,
    }
    if seen:
        made["view"] = view_of([actor for _, actor in seen])
    return made


def actors_of(plan: Plan, system: System) -> list[dict[str, Any]]:
    """What to draw of a run of the scene, whose system has parameters of its own."""
    drawings, sources = system.drawings(), _sources(plan)
    return [_actor(name, seen, drawings[name], sources) for name, seen in _seen(plan)]


def _columns(plan: Plan) -> list[str]:
    """What a row holds after its time: the outputs, then the controls that are drawn."""
    return [*(".".join(port) for port in plan.system.recorded), *plan.shown]


def _sources(plan: Plan) -> dict[str, int]:
    """The column of each variable, those of inputs being of the outputs that drive them."""
    places = {name: number for number, name in enumerate(_columns(plan))}
    driven = {
        path_of(link.target): places[path_of(link.source)]
        for link in plan.system.links
        if link.is_plain
    }
    return {**driven, **places}


def _seen(plan: Plan) -> list[tuple[str, Actor]]:
    """The components that can be drawn, with their motion in the run beforehand."""
    drawings = plan.system.drawings()
    known = {f"{name}.": drawing for name, drawing in drawings.items()}
    found = [(actor.prefix[:-1], actor) for actor in find_actors(plan.seen, known)]
    columns = set(_columns(plan))
    return [
        (name, actor)
        for name, actor in found
        if all(
            f"{name}.{one}" in columns or one in drawings[name].values
            for one in _variables(drawings[name])
        )
    ]


def _variables(drawing: Drawing) -> set[str]:
    """The variables that place points, circles, curves and the frame."""
    texts = [
        *drawing.frame,
        *(text for point in drawing.points for text in (point.x, point.y)),
        *(text for circle in drawing.circles for text in circle[:3]),
        *(text for curve in drawing.curves for text in (curve.x, curve.y)),
    ]
    return set().union(*(variables_of(parse(text)) for text in texts)) - {"s"}


def _actor(name: str, seen: Actor, drawing: Drawing, sources: dict[str, int]) -> dict[str, Any]:
    names: dict[str, Any] = {}
    for variable in sorted(_variables(drawing) | drawing.of_arrows()):
        if f"{name}.{variable}" in sources:
            names[variable] = {"column": sources[f"{name}.{variable}"]}
        elif variable in drawing.values:
            names[variable] = {"value": drawing.values[variable]}
    return {
        "component": name,
        "kind": drawing.name,
        "size": seen.size,
        "names": names,
        "formulas": {
            **{point.name: _trees(point.x, point.y) for point in drawing.points},
            FRAME: _trees(*drawing.frame),
        },
        "points": [
            {"name": point.name, "shape": point.shape, "light": point.light}
            for point in drawing.points
        ],
        "rods": drawing.rods,
        "circles": [
            {**_trees(circle.x, circle.y), "radius": parse(circle.radius), "holds": circle.holds}
            for circle in drawing.circles
        ],
        "curves": [
            {
                **_trees(curve.x, curve.y),
                "s": seen.span(curve),
                "grows": curve.s is None,
                "holds": curve.holds,
            }
            for curve in drawing.curves
        ],
        "arrows": [
            {"kind": [arrow.name, arrow.unit], "at": arrow.at, **_trees(arrow.x, arrow.y)}
            for arrow in drawing.arrows
            if all(one in names for one in arrow.variables())
        ],
    }


def _trees(x: str, y: str) -> dict[str, Tree]:
    return {"x": parse(x), "y": parse(y)}


def _owners(plan: Plan) -> list[tuple[str, Drawing]]:
    """Components with a drawing, those that are seen first."""
    drawings = plan.system.drawings()
    names = dict.fromkeys([*(name for name, _ in _seen(plan)), *drawings])
    return [(name, drawings[name]) for name in names]


def _series(plan: Plan, name: str, drawing: Drawing | None, variable: str) -> dict[str, Any]:
    what = quantity(variable, drawing)
    column = f"{name}.{variable}"
    low, high = _range(plan, column)
    if low == high == 0.0:
        high = 1.5  # it may move yet: decimals are wanted
    return {
        "column": _columns(plan).index(column),
        "component": name,
        "variable": variable,
        "label": what.label,
        "name": what.name,
        "unit": what.unit,
        "scale": [low, high],
    }


def _range(plan: Plan, column: str) -> tuple[float, float]:
    """Least and greatest value in the run beforehand."""
    values = np.asarray(plan.seen[column], dtype=np.float64)
    values = values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)


def _plots(plan: Plan) -> list[dict[str, Any]]:
    """Every plot that the drawings declare, then one for each output that none declares."""
    columns = set(_columns(plan))
    owners = _owners(plan)
    plots: list[dict[str, Any]] = []
    for plot in plots_of([drawing for _, drawing in owners]):
        series = [
            _series(plan, name, drawing, variable)
            for name, drawing in owners
            for variable in plot.names
            if f"{name}.{variable}" in columns
        ]
        if series:
            ranges = (_range(plan, f"{one['component']}.{one['variable']}") for one in series)
            moving = not plot.moving or any(low < high for low, high in ranges)
            plots.append(
                {
                    "title": plot.title,
                    "unit": series[0]["unit"],
                    "shown": plot.shown and moving and len(plots) < 4,
                    "error": plot.error,
                    "series": series,
                }
            )
    return plots + _others(plan, _declared(owners), seen=bool(_seen(plan)))


def _declared(owners: list[tuple[str, Drawing]]) -> set[str]:
    return {f"{name}.{variable}" for name, drawing in owners for variable in drawing.units}


def _others(plan: Plan, known: set[str], *, seen: bool) -> list[dict[str, Any]]:
    plots: list[dict[str, Any]] = []
    for component, variable in plan.system.recorded:
        if f"{component}.{variable}" not in known:
            one = _series(plan, component, None, variable)
            one["unit"] = plan.system.variable((component, variable)).unit or ""
            title = f"{component}.{variable}"
            shown = not seen and len(plots) < 4
            plots.append(
                {
                    "title": title,
                    "unit": one["unit"],
                    "shown": shown,
                    "error": False,
                    "series": [one],
                }
            )
    return plots


def _readouts(plan: Plan) -> list[dict[str, Any]]:
    columns = set(_columns(plan))
    seen = [name for name, _ in _seen(plan)]
    owners = [(name, drawing) for name, drawing in _owners(plan) if name in seen]
    return [
        {**_series(plan, name, drawing, variable), "error": quantity(variable, drawing).error}
        for variable in readouts_of([drawing for _, drawing in owners])
        for name, drawing in owners
        if f"{name}.{variable}" in columns
    ]

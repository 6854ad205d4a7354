"""Decides what a replay shows: bodies, plots, readouts and notes, as plain data for the page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CurveboundError
from ..fmi.drawing import Drawing
from ..fmi.folder import shipped_drawings
from ..fmi.formula import parse
from .actors import Actor, Floats, find_actors, missing, split_name
from .arrows import kinds_of, packed, vectors_of
from .geometry import distances, view_of
from .packing import Packer
from .quantities import plots_of, quantity, readouts_of
from .reading import Opened, Results, opened

__all__ = ["MOST_RESULTS", "build_model"]

MOST_RESULTS = 8  # colours that can be told apart
_MOST_VALUES = 4_000_000  # embedded; more than that would make a page of over 20 MB
_MOST_OTHERS = 24  # plots of columns that nothing here knows
_OTHERS_SHOWN = 6  # of them, where there is nothing better to show


@dataclass(frozen=True)
class _Shown:
    """One result on the page."""

    label: str
    data: NDArray[Any]
    time: Floats
    clock: int  # channel of its times
    drawings: dict[str, Drawing]  # by prefix
    actors: list[Actor]

    def column(self, name: str) -> Floats:
        return np.asarray(self.data[name], dtype=np.float64)


def build_model(
    results: Results,
    title: str,
    notes: Sequence[str] = (),
    known: Sequence[Drawing] = (),
) -> tuple[dict[str, Any], Packer]:
    """The page's description (JSON-able) and its packed samples.

    Arguments as those of write_replay. Raises CurveboundError where there is nothing to show, or
    more results than colours.
    """
    known = [*known, *shipped_drawings()]
    given = opened(results, known)
    if not given:
        raise CurveboundError("There is no result to show. Give at least one.")
    if len(given) > MOST_RESULTS:
        raise CurveboundError(
            f"{len(given)} results are more than can be told apart in one picture. "
            f"Give at most {MOST_RESULTS}."
        )
    packer = Packer()
    said = list(notes)
    shown = [_show(one, packer, said, len(given)) for one in given]
    actors = [(number, actor) for number, result in enumerate(shown) for actor in result.actors]
    if not actors:
        lack = missing(shown[0].data, known)
        said.append(
            f"Nothing in these columns can be drawn, so only plots are shown: {lack}; "
            "--system names another system."
        )
    for number, actor in actors:
        said += [f"{shown[number].label}: {note}." for note in actor.notes]
    model: dict[str, Any] = {
        "title": title,
        "results": [_describe(result, packer) for result in shown],
        "actors": [_actor(number, actor, shown, packer) for number, actor in actors],
        "plots": _plots(shown, actors, packer) + _others(shown, packer, said),
        "readouts": _readouts(shown, actors, packer),
        "arrows": [
            asdict(kind)
            for kind in kinds_of(
                (_name(at, actor, shown), actor, shown[at].data) for at, actor in actors
            )
        ],
        "channels": packer.channels,
        "notes": said,
    }
    if actors:
        model["view"] = view_of([actor for _, actor in actors])
    return model, packer


def _show(result: Opened, packer: Packer, notes: list[str], results: int) -> _Shown:
    label, data, drawings = result.label, result.data, result.drawings
    names = data.dtype.names or ()
    most = _MOST_VALUES // (results * max(len(names), 1))
    if len(data) > most:
        every = -(-len(data) // most)
        notes.append(
            f"{label}: one in {every} of its {len(data):,} samples is shown, "
            "to keep the page small."
        )
        data = data[::every]
    for name in names:
        bad = ~np.isfinite(np.asarray(data[name], dtype=np.float64))
        if bad.any():
            first = float(data["time"][int(np.argmax(bad))])
            notes.append(
                f"{label}: {name} is not a finite number in {int(bad.sum()):,} of {len(data):,} "
                f"samples, first at t = {first:g} s: left blank there."
            )
    if len(data) == 1:
        notes.append(f"{label}: one sample only, so there is no motion to play.")
    time = np.asarray(data["time"], dtype=np.float64)
    return _Shown(label, data, time, packer.time(time), drawings, find_actors(data, drawings))


def _describe(result: _Shown, packer: Packer) -> dict[str, Any]:
    return {
        "label": result.label,
        "samples": len(result.time),
        "time": result.clock,
        "start": float(result.time[0]),
        "end": float(result.time[-1]),
    }


def _name(number: int, actor: Actor, shown: list[_Shown]) -> str:
    """The label of an actor: that of its result, of its component, or both."""
    component = actor.prefix.rstrip(".")
    if len(shown[number].actors) == 1:
        return shown[number].label
    return component if len(shown) == 1 else f"{shown[number].label}: {component}"


def _actor(number: int, actor: Actor, shown: list[_Shown], packer: Packer) -> dict[str, Any]:
    result = shown[number]
    drawing = actor.drawing
    return {
        "result": number,
        "label": _name(number, actor, shown),
        "kind": actor.kind,
        "time": result.clock,
        "places": {name: packer.signal(values) for name, values in actor.places.items()},
        "points": [
            {"name": point.name, "shape": point.shape, "light": point.light}
            for point in drawing.points
        ],
        "rods": drawing.rods,
        "circles": [
            {**circle._asdict(), **_trees(circle.x, circle.y), "radius": parse(circle.radius)}
            for circle in drawing.circles
        ],
        "curves": [
            {**_trees(curve.x, curve.y), "s": actor.span(curve)} for curve in drawing.curves
        ],
        "arrows": packed(vectors_of(actor, result.data), packer),
    }


def _trees(x: str, y: str) -> dict[str, Any]:
    """Two formulas as the page's script evaluates them."""
    return {"x": parse(x), "y": parse(y)}


def _series(
    result: _Shown, number: int, label: str, name: str, column: str, packer: Packer
) -> dict[str, Any]:
    what = quantity(name, result.drawings.get(column.removesuffix(name)))
    return {
        "actor": number,
        "owner": label,
        "label": what.label,
        "variable": name,
        "name": what.name,
        "unit": what.unit,
        "time": result.clock,
        "values": packer.signal(result.column(column), error=what.error),
    }


def _owners(
    shown: list[_Shown], actors: list[tuple[int, Actor]]
) -> list[tuple[_Shown, str, int, str]]:
    """(result, prefix, number of its colour, label) of every component with columns we know."""
    owners = []
    numbers = {(at, actor.prefix): i for i, (at, actor) in enumerate(actors)}
    for at, result in enumerate(shown):
        prefixes = dict.fromkeys(split_name(name)[0] for name in result.data.dtype.names or ())
        for prefix in prefixes:
            number = numbers.get((at, prefix))
            if number is not None:
                owners.append((result, prefix, number, _name(at, actors[number][1], shown)))
            else:
                mine = [i for i, (other, _) in enumerate(actors) if other == at]
                component = prefix.rstrip(".")
                label = component or result.label
                if len(shown) > 1 and component:
                    label = f"{result.label}: {component}"
                owners.append((result, prefix, mine[0] if mine else at, label))
    # Bodies first, so that what only repeats one of their columns is recognised as such.
    return sorted(owners, key=lambda owner: (id(owner[0]), owner[1]) not in {
        (id(shown[at]), prefix) for at, prefix in numbers
    })  # fmt: skip


def _plots(
    shown: list[_Shown], actors: list[tuple[int, Actor]], packer: Packer
) -> list[dict[str, Any]]:
    bodies = {(id(shown[at]), actor.prefix) for at, actor in actors}
    measured = {name for _, actor in actors for name in actor.drawing.outputs}
    owners = _owners(shown, actors)
    plots = []
    for plot in plots_of(_drawings(shown)):
        series: list[dict[str, Any]] = []
        for result, prefix, number, label in owners:
            for name in plot.names:
                column = prefix + name
                if column not in (result.data.dtype.names or ()):
                    continue
                if name in measured and (id(result), prefix) not in bodies:
                    continue
                one = _series(result, number, label, name, column, packer)
                if packer.blank(one["values"]):
                    continue
                if not any(one["values"] == other["values"] and one["time"] == other["time"]
                           and one["label"] == other["label"] and one["actor"] == other["actor"]
                           for other in series):  # fmt: skip
                    series.append(one)
        if not series or (plot.moving and not any(_moves(one, packer) for one in series)):
            continue
        plots.append(
            {
                "title": plot.title,
                "unit": series[0]["unit"],
                "shown": plot.shown or not actors,
                "error": plot.error,
                "series": series,
            }
        )
    return _distances(shown, actors, packer) + plots


def _drawings(shown: list[_Shown]) -> list[Drawing]:
    """The drawings of all components, each once."""
    every = [one for result in shown for one in result.drawings.values()]
    return list({one.name: one for one in every}.values())


def _moves(series: dict[str, Any], packer: Packer) -> bool:
    return bool(packer.channels[series["values"]]["kind"] != "constant")


def _distances(
    shown: list[_Shown], actors: list[tuple[int, Actor]], packer: Packer
) -> list[dict[str, Any]]:
    """Distance of every body from the first of its kind, the reference of the comparison."""
    series: list[dict[str, Any]] = []
    references: dict[tuple[str, int], tuple[int, Actor]] = {}
    counts: dict[tuple[int, str], int] = {}
    reference_label = ""
    for number, (at, actor) in enumerate(actors):
        rank = counts[at, actor.kind] = counts.get((at, actor.kind), -1) + 1
        key = (actor.kind, rank if len(shown) > 1 else 0)
        if key not in references:
            references[key] = (at, actor)
            continue
        reference_at, reference = references[key]
        reference_label = reference_label or _name(reference_at, reference, shown)
        times, pairs = distances(reference, shown[reference_at].time, actor, shown[at].time)
        if not len(times):
            continue
        clock = packer.time(times)
        for point, distance in pairs:
            series.append(
                {
                    "actor": number,
                    "owner": _name(at, actor, shown),
                    "label": point,
                    "unit": "m",
                    "time": clock,
                    "values": packer.signal(distance, error=True),
                }
            )
    if not series:
        return []
    title = f"Distance from {reference_label}"
    return [{"title": title, "unit": "m", "shown": True, "error": True, "series": series}]


def _others(shown: list[_Shown], packer: Packer, notes: list[str]) -> list[dict[str, Any]]:
    """A plot for each numeric column that nothing here knows, offered rather than shown."""
    plots: dict[str, dict[str, Any]] = {}
    left = 0
    for number, result in enumerate(shown):
        for column in result.data.dtype.names or ():
            prefix, variable = split_name(column)
            drawing = result.drawings.get(prefix)
            if column == "time" or (drawing is not None and variable in drawing.units):
                continue
            if column not in plots and len(plots) == _MOST_OTHERS:
                left += 1
                continue
            mine = next((i for i, r in enumerate(shown) if r is result), number)
            plot = plots.setdefault(
                column, {"title": column, "unit": "", "shown": False, "error": False, "series": []}
            )
            plot["series"].append(_series(result, mine, result.label, column, column, packer))
    if left:
        notes.append(f"{left} more columns are not offered as plots.")
    if not any(result.actors for result in shown):
        for plot in list(plots.values())[:_OTHERS_SHOWN]:
            plot["shown"] = True
    return list(plots.values())


def _readouts(
    shown: list[_Shown], actors: list[tuple[int, Actor]], packer: Packer
) -> list[dict[str, Any]]:
    """Rows of the panel: a quantity, and the channel of each actor that has it."""
    rows = []
    for name in readouts_of(_drawings(shown)):
        cells: list[dict[str, Any] | None] = []
        for at, actor in actors:
            result, column = shown[at], actor.prefix + name
            there = column in (result.data.dtype.names or ())
            cells.append(_series(result, 0, "", name, column, packer) if there else None)
        if any(cells):
            drawings = (actor.drawing for _, actor in actors)
            what = quantity(name, next((one for one in drawings if name in one.units), None))
            rows.append(
                {"label": what.name, "unit": what.unit, "error": what.error, "cells": cells}
            )
    return rows

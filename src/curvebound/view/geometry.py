"""How far two motions are apart, and the part of the plane that shows them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..fmi.drawing import FRAME
from .actors import Actor, Floats

__all__ = ["Box", "box_of", "common_samples", "distances", "follows_frame", "view_of"]

Box = tuple[float, float, float, float]  # left, bottom, right, top, in m

_MARGIN = 0.12  # of a size, around everything
_BLOWN_UP = 6.0  # times the middle 80 % of the positions: beyond that a run has left the picture
_ALWAYS_SHOWN = 3.0  # sizes beyond the middle: a start from which all comes to rest stays in it
_LEFT_BEHIND = 4.0  # times what the first actor covers: then another does not shrink it
_LEAST_COMMON = 50


def distances(
    first: Actor, first_time: Floats, other: Actor, other_time: Floats
) -> tuple[Floats, list[tuple[str, Floats]]]:
    """Distance in m between the points of two actors of one kind: (time, [(point, distance)]).

    Taken at the sample times that both have, where these are many enough, so that no
    interpolation adds to it; else `other` is interpolated at the times of `first`.
    """
    mine, theirs = common_samples(first_time, other_time)
    enough = min(_LEAST_COMMON, max(1, min(len(first_time), len(other_time)) // 2))
    pairs = zip(first.points(), other.points(), strict=True)
    if len(mine) >= enough:
        return first_time[mine], [
            (name, np.hypot(x[mine] - ox[theirs], y[mine] - oy[theirs]))
            for (name, x, y), (_, ox, oy) in pairs
        ]
    inside = (first_time >= other_time[0]) & (first_time <= other_time[-1])
    times = first_time[inside]
    return times, [
        (
            name,
            np.hypot(
                x[inside] - _between(other_time, ox, times),
                y[inside] - _between(other_time, oy, times),
            ),
        )
        for (name, x, y), (_, ox, oy) in pairs
    ]


def common_samples(
    first: Floats, other: Floats
) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], np.ndarray[tuple[int], np.dtype[np.intp]]]:
    """Indices into two ascending arrays of times where these agree but for rounding."""
    span = max(abs(float(first[-1])), abs(float(other[-1])), abs(float(first[0])), 1e-300)
    # Index of the nearest time in `other` for each in `first`.
    right = np.clip(np.searchsorted(other, first), 1, max(len(other) - 1, 1))
    right = np.minimum(right, len(other) - 1)
    left = np.maximum(right - 1, 0)
    nearest = np.where(np.abs(first - other[left]) <= np.abs(first - other[right]), left, right)
    mine = np.flatnonzero(np.abs(other[nearest] - first) <= 1e-9 * span)
    return mine, nearest[mine]


def _between(time: Floats, values: Floats, at: Floats) -> Floats:
    """Interpolation by the polynomial through the nearest six samples (Lagrange)."""
    once = np.concatenate(([True], np.diff(time) > 0.0))  # of samples at one time, the first
    time, values = time[once], values[once]
    points = min(6, len(time))
    first = np.searchsorted(time, at, side="right") - points // 2
    nodes = np.clip(first, 0, len(time) - points)[:, None] + np.arange(points)
    t = time[nodes]
    total = np.zeros(len(at))
    for i in range(points):
        weight = np.ones(len(at))
        for k in range(points):
            if k != i:
                weight *= (at - t[:, k]) / (t[:, i] - t[:, k])
        total += weight * values[nodes[:, i]]
    return total


def box_of(actors: list[Actor], *, relative: bool = False) -> Box:
    """The box that holds every position of `actors`, circles and curves of fixed range included.

    With `relative`, as seen from each actor's frame. Positions of a run that blew up are left out.
    """
    boxes = [_box(actor, relative) for actor in actors]
    return (
        min(box[0] for box in boxes),
        min(box[1] for box in boxes),
        max(box[2] for box in boxes),
        max(box[3] for box in boxes),
    )


def view_of(actors: list[Actor]) -> dict[str, Any]:
    """The parts of the plane that a page shows, as data: in the world, and as seen from the frame.

    What the first actor needs decides: another that leaves it far behind does not shrink it. Then
    `all` holds the parts that show every actor.
    """
    every = {"world": box_of(actors), "frame": box_of(actors, relative=True)}
    shown = {
        "world": _held(every["world"], box_of(actors[:1])),
        "frame": _held(every["frame"], box_of(actors[:1], relative=True)),
    }
    made: dict[str, Any] = {**shown, "follow": follows_frame(actors)}
    return made if shown == every else {**made, "all": every}


def _held(box: Box, first: Box) -> Box:
    """A box, no farther from the first actor's than that is large, where it is much larger."""
    size = max(first[2] - first[0], first[3] - first[1])
    if max(box[2] - box[0], box[3] - box[1]) <= _LEFT_BEHIND * size:
        return box
    return (
        max(box[0], first[0] - size),
        max(box[1], first[1] - size),
        min(box[2], first[2] + size),
        min(box[3], first[3] + size),
    )


def follows_frame(actors: list[Actor]) -> bool:
    """Whether the frames move so far that a picture of the whole would show nothing."""
    near, far = box_of(actors, relative=True), box_of(actors)
    return any(far[i + 2] - far[i] > 2.0 * (near[i + 2] - near[i]) for i in (0, 1))


def _box(actor: Actor, relative: bool) -> Box:
    horizontal: list[tuple[float, float]] = []
    vertical: list[tuple[float, float]] = []
    shift_x, shift_y = actor.at(FRAME) if relative else (np.zeros(1), np.zeros(1))
    for x, y, around in (
        (*actor.at(FRAME), 0.0),
        *((x, y, 0.0) for _, x, y in actor.points()),
        *actor.outlines(),
    ):
        for extents, values in ((horizontal, x - shift_x), (vertical, y - shift_y)):
            low, high = _extent(values, actor.size)
            extents.append((low - around, high + around))
    margin = _MARGIN * actor.size
    return (
        min(low for low, _ in horizontal) - margin,
        min(low for low, _ in vertical) - margin,
        max(high for _, high in horizontal) + margin,
        max(high for _, high in vertical) + margin,
    )


def _extent(values: Floats, size: float) -> tuple[float, float]:
    """Least and greatest of `values`, unless these lie far outside the middle of them."""
    good = values[np.isfinite(values)]
    if not good.size:
        return 0.0, 0.0
    low, inner_low, inner_high, high = np.percentile(good, (0.0, 10.0, 90.0, 100.0))
    reach = max(_BLOWN_UP * (inner_high - inner_low), _ALWAYS_SHOWN * size)
    return float(max(low, inner_low - reach)), float(min(high, inner_high + reach))

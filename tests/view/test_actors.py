"""What is found in a result, and the sizes that are recovered from it."""

from __future__ import annotations

import numpy as np
import pytest
from motions import bead, pendulum, renamed, table, without

from curvebound.fmi.folder import shipped_drawings
from curvebound.view import actors
from curvebound.view.actors import Actor, drawings_of, split_name
from curvebound.view.geometry import (
    _LEFT_BEHIND,
    _held,
    box_of,
    common_samples,
    distances,
    follows_frame,
)

KNOWN = shipped_drawings()


def find_actors(data: np.ndarray) -> list[Actor]:
    return actors.find_actors(data, drawings_of(data, KNOWN, {}))


def test_names() -> None:
    assert split_name("time") == ("", "time")
    assert split_name("slider.u") == ("", "slider.u")
    assert split_name("plant.slider.u") == ("plant.", "slider.u")
    assert split_name("system.left.slider.u") == ("system.left.", "slider.u")


@pytest.mark.parametrize("prefix", ["bead.", "", "any name.", "a.b."])
def test_a_bead_under_any_component_and_none(prefix: str) -> None:
    data = renamed(bead(1.0, 0.01, radius=2.5), lambda name: name.replace("bead.", prefix, 1))
    (actor,) = find_actors(data)
    assert (actor.kind, actor.prefix) == ("BeadOnWire", prefix)
    assert actor.size == pytest.approx(2.5, rel=1e-12)
    assert np.array_equal(actor.places["bead x"], data[f"{prefix}bead.x"])


def test_the_drift_does_not_count_towards_the_radius() -> None:
    data = bead(100.0, 1 / 60, project=False)[3000:]
    assert abs(data["bead.constraint.drift"][0]) > 1e-3
    assert find_actors(data)[0].size == pytest.approx(1.0, abs=1e-12)


def test_a_pendulum_and_not_the_controller_that_measures_it() -> None:
    data = pendulum(1.0, 0.01, a=-0.8, length=0.7, push=1.0)
    (actor,) = find_actors(data)
    assert (actor.kind, actor.prefix) == ("ParabolaPendulum", "plant.")
    assert actor.size == pytest.approx(0.7, rel=1e-12)
    assert actor.places["parabola.coefficient"][0] == -0.8
    alone = without(data, *(name for name in data.dtype.names if name.startswith("plant.")))
    assert [actor.kind for actor in find_actors(alone)] == ["ParabolaPendulum"]


def test_places_from_coordinates_alone() -> None:
    full = pendulum(1.0, 0.01, push=2.0)
    names = ("time", "plant.slider.u", "plant.pendulum.angle", "plant.parabola.x")
    (actor,) = find_actors(table({name: full[name] for name in names}))
    for place, name in (
        ("slider x", "slider.x"),
        ("slider y", "slider.y"),
        ("bob y", "pendulum.y"),
    ):
        assert np.abs(actor.places[place] - full[f"plant.{name}"]).max() < 1e-12
    assert len(actor.notes) == 2, "the sizes that were assumed are told"

    full = bead(1.0, 0.01, radius=2.0)
    (actor,) = find_actors(table({"time": full["time"], "bead.angle": full["bead.bead.angle"]}))
    assert np.abs(actor.places["bead x"] * 2.0 - full["bead.bead.x"]).max() < 1e-12
    assert "radius" in actor.notes[0]


def test_the_coefficient_from_positions() -> None:
    data = without(pendulum(1.0, 0.01, a=1.7, push=1.0), "plant.parabola.coefficient")
    assert find_actors(data)[0].places["parabola.coefficient"] == pytest.approx(1.7, rel=1e-12)


def test_two_bodies_in_one_result() -> None:
    one, two = bead(1.0, 0.01), pendulum(1.0, 0.01)
    both = {name: one[name] for name in one.dtype.names}
    both |= {name: two[name] for name in two.dtype.names}
    assert [actor.kind for actor in find_actors(table(both))] == ["BeadOnWire", "ParabolaPendulum"]


def test_what_is_missing_is_said() -> None:
    said = actors.missing(table({"time": [0.0], "bead.x": [1.0]}), KNOWN)
    assert "bead.x and bead.y or bead.angle; bead.y missing" in said
    # of what is not there at all nothing in particular is missing
    assert "missing" not in actors.missing(table({"time": [0.0], "engine.speed": [1.0]}), KNOWN)
    assert "slider.u" in said
    assert find_actors(table({"time": [0.0], "bead.x": [1.0]})) == []


def test_distances_on_one_grid_are_exact() -> None:
    one, two = bead(20.0, 1 / 60), bead(20.0, 1 / 60, project=False)
    time, [(point, apart)] = distances(
        find_actors(one)[0], one["time"], find_actors(two)[0], two["time"]
    )
    exact = np.hypot(
        one["bead.bead.x"] - two["bead.bead.x"], one["bead.bead.y"] - two["bead.bead.y"]
    )
    assert point == "bead"
    assert np.array_equal(time, one["time"])
    assert np.array_equal(apart, exact)


@pytest.mark.parametrize(("h", "points", "most"), [(0.02, 501, 0.0), (0.023, 1001, 1e-6)])
def test_distances_on_different_grids(h: float, points: int, most: float) -> None:
    """The same motion sampled twice: at common times 0, else no more than interpolation adds."""
    fine = bead(10.0, 1e-3)
    one = fine[::10]
    two = fine[:: round(h * 1e3)]
    time, [(_, apart)] = distances(
        find_actors(one)[0], one["time"], find_actors(two)[0], two["time"]
    )
    assert abs(len(time) - points) <= 2
    assert apart.max() <= most


def test_common_samples_but_for_rounding() -> None:
    first = np.cumsum(np.full(600, 1 / 60)) - 1 / 60
    mine, theirs = common_samples(first, np.arange(100) / 10)
    assert theirs.tolist() == list(range(100))
    assert mine.tolist() == list(range(0, 600, 6))
    assert common_samples(np.array([0.0]), np.array([0.0]))[0].tolist() == [0]


def test_the_picture_holds_the_motion_but_not_an_explosion() -> None:
    data = bead(10.0, 0.01)
    left, bottom, right, top = box_of(find_actors(data))
    assert left < -1.0 < 1.0 < right
    assert bottom < -1.0 < 1.0 < top
    data["bead.bead.x"][950:] = 1e9
    data["bead.bead.y"][950:] = np.nan
    assert box_of(find_actors(data))[2] < 20.0


def test_a_frame_that_travels_is_followed() -> None:
    data = pendulum(5.0, 0.01)
    assert not follows_frame(find_actors(data))
    for name in ("plant.parabola.x", "plant.slider.x", "plant.pendulum.x"):
        data[name] += 10 * data["time"]
    assert follows_frame(find_actors(data))
    box = box_of(find_actors(data), relative=True)
    assert box[2] - box[0] < 4.0


def test_columns_of_another_system_are_not_taken_for_one_that_is_known() -> None:
    """A bead on a parabola is not drawn on a circle."""
    data = bead(1.0, 0.01)
    foreign = table({"time": data["time"], "p.bead.x": data["bead.bead.x"],
                     "p.bead.y": data["bead.bead.y"], "p.track.slope": data["time"]})  # fmt: skip
    assert find_actors(foreign) == []


def test_a_run_tells_its_drawing_and_sizes() -> None:
    """The radius comes from the run: from a start at 3 m on a circle of 2 m no column tells it."""
    data = bead(1.0, 0.01, radius=3.0)
    drawing = next(one for one in KNOWN if one.name == "BeadOnWire")
    own = drawing._replace(values={**drawing.values, "wire.radius": 2.0}, known=True)
    (actor,) = actors.find_actors(data, drawings_of(data, [], {"bead": own}))
    assert actor.size == 2.0
    assert actor.notes == ()


def test_what_is_missing_is_that_of_the_nearer_way() -> None:
    beads = [one for one in KNOWN if one.name == "BeadOnWire"]
    data = table({"time": [0.0, 1.0], "bead.x": [0.0, 1.0]})
    assert actors.missing(data, beads) == (
        "BeadOnWire needs bead.x and bead.y or bead.angle; bead.y missing"
    )
    foreign = table({"time": [0.0, 1.0], "engine.speed": [0.0, 1.0]})
    assert actors.missing(foreign, beads) == "BeadOnWire needs bead.x and bead.y or bead.angle"


def test_a_view_follows_the_first_actor_where_others_leave_it_far_behind() -> None:
    """By its own size to each side, once all of it is many times as large either way."""
    first = (-1.0, 2.0, 1.0, 3.0)
    most = 2.0 * _LEFT_BEHIND
    for kept in ((-1.0, 2.0, most - 1.0, 3.0), (-1.0, 2.0, 1.0, 2.0 + most)):
        assert _held(kept, first) == kept
    assert _held((-1.0, 2.0, most - 0.9, 3.0), first) == (-1.0, 2.0, 3.0, 3.0)
    assert _held((-1.0, 2.0, 1.0, 2.1 + most), first) == (-1.0, 2.0, 1.0, 5.0)
    assert _held((-most, -most, most, most), first) == (-3.0, 0.0, 3.0, 5.0)

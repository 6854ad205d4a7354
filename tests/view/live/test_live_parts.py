"""The parts of a live scene by themselves: pace, hand, what is held, and runs side by side."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from motions import table

from curvebound.fmi.drawing import Drawing, Plot
from curvebound.view.live import model, recording
from curvebound.view.live.driven import Driven
from curvebound.view.live.pace import Pace
from curvebound.view.live.runs import Runs
from curvebound.view.live.spring import Hand, Spring


def test_a_goal_goes_on_from_where_the_pace_was_begun() -> None:
    pace = Pace()
    pace.set_speed(2.0)
    pace.begin(100.0, 5.0)
    assert pace.goal(100.5) == 6.0
    for asked, kept in ((0.01, 0.1), (20.0, 10.0), (0.5, 0.5)):
        pace.set_speed(asked)
        assert pace.speed == kept
    assert pace.goal(102.0) == 6.0


@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_machine_is_too_slow_from_a_tenth_of_a_second_on(speed: float) -> None:
    """Of the wall's time, however fast the scene is."""
    pace = Pace()
    pace.set_speed(speed)
    pace.begin(100.0, 5.0)
    pace.keep(101.0, 5.0, pace.goal(101.0) - 0.099 * speed)
    assert not pace.late
    assert pace.goal(101.0) == 5.0 + speed
    pace.keep(101.0, 5.5, pace.goal(101.0) - 0.101 * speed)
    assert pace.late
    assert pace.goal(101.0) == 5.5
    assert pace.goal(102.0) == 5.5 + speed
    pace.begin(103.0, 6.0)
    assert not pace.late


def test_speed_is_measured_each_half_second() -> None:
    pace = Pace()
    pace.begin(100.0, 5.0)
    assert pace.measured(100.49, 5.2) is None
    assert pace.measured(100.5, 5.2) == pytest.approx(0.4)
    assert pace.measured(100.9, 6.0) is None
    assert pace.measured(101.5, 7.2) == pytest.approx(2.0)


def grip(*, force: bool, mass: float = 2.0, velocity: Any = ("b.vx", "b.vy")) -> Any:
    return SimpleNamespace(
        force=force, mass=mass, component="plant", position=("b.x", "b.y"), velocity=velocity,
        inputs=("b.fx", "b.fy"),
    )  # fmt: skip


@pytest.mark.parametrize(("step", "rate"), [(0.001, 2.0 * math.pi), (0.1, 3.0)])
def test_a_spring_pulls_by_distance_and_is_damped(step: float, rate: float) -> None:
    spring = Spring(grip(force=True), step)
    spring.target = (1.2, 0.8)
    pull = (0.4 * rate**2, -2.0 * (rate**2 * 0.2 + 1.2 * rate * 0.5))
    assert spring.advance((1.0, 1.0), (0.0, 0.5), step) == pytest.approx(pull)
    # no more than 50 m/s2, in the same direction
    spring.target = (3001.0, 4001.0)
    assert spring.advance((1.0, 1.0), (0.0, 0.0), step) == pytest.approx((60.0, 80.0))
    assert not spring.over
    spring.let_go()
    assert not spring.over
    assert spring.advance((1.0, 1.0), (0.0, 0.0), step) == (0.0, 0.0)
    assert spring.over


def test_a_frame_that_is_let_go_is_brought_to_rest() -> None:
    """It loses speed by its rate, and the last 5 cm/s in one step."""
    step, rate = 0.1, 3.0
    spring = Spring(grip(force=False, mass=1.0), step)
    spring.target = (0.1, 0.0)
    assert spring.advance((0.0, 0.0), (0.0, 0.0), step) == pytest.approx((0.9, 0.0))
    spring.let_go()
    speed, steps = 0.0 + step * 0.9, 0
    while speed >= 0.05:
        assert spring.advance((0.0, 0.0), (speed, 0.0), step) == pytest.approx((-rate * speed, 0))
        assert not spring.over
        speed -= step * rate * speed
        steps += 1
    assert steps == 2
    assert spring.advance((0.0, 0.0), (speed, 0.0), step) == pytest.approx((-speed / step, 0.0))
    assert not spring.over
    assert spring.advance((0.0, 0.0), (0.0, 0.0), step) == (0.0, 0.0)
    assert spring.over
    # held again while it brakes
    spring.held = True
    assert spring.advance((0.0, 0.0), (0.0, 0.0), step) == pytest.approx((0.9, 0.0))


COLUMNS = ["plant.b.x", "plant.b.y", "plant.b.vx", "plant.b.vy"]


def run_at(*row: float, size: float = 0.1) -> Any:
    return SimpleNamespace(row=lambda: [7.0, *row], columns=COLUMNS, size=size)


def test_a_hand_pulls_at_one_grip_by_where_the_body_is() -> None:
    one, other = grip(force=True), grip(force=True, velocity=None)
    hand = Hand(0.1)
    assert hand.forces(run_at(0.0, 0.0, 0.0, 0.0)) == {}
    hand.pull(one, (1.0, 0.0))
    assert (hand.holds(one), hand.holds(other)) == (True, False)
    found = hand.forces(run_at(0.5, 0.25, 0.0, 0.5))
    assert found == {"plant.b.fx": pytest.approx(9.0), "plant.b.fy": pytest.approx(-8.1)}
    again = hand.copy()
    hand.pull(other, (1.0, 0.0))
    assert (hand.holds(one), hand.holds(other)) == (False, True)
    assert again.holds(one)
    # of a grip without velocity damping is none, and the first spring does nothing more
    found = hand.forces(run_at(0.5, 0.25, 0.0, 0.5))
    assert found == {"plant.b.fx": pytest.approx(9.0), "plant.b.fy": pytest.approx(-4.5)}
    hand.release()
    assert not hand.holds(other)
    assert set(hand.forces(run_at(0.5, 0.25, 0.0, 0.5)).values()) == {0.0}
    assert hand.forces(run_at(0.5, 0.25, 0.0, 0.5)) == {}
    assert again.forces(run_at(0.5, 0.25, 0.0, 0.5))["plant.b.fx"] == pytest.approx(9.0)


def test_values_are_held_from_their_time_on() -> None:
    held = Driven(1.0, 0.0)
    held.put(0.0, 2.0)
    held.put(0.5, 2.0)
    assert held.changes == []
    held.put(1.0, 3.0)
    held.put(3.0, 4.0)
    assert held.changes == [1.0, 3.0]
    times = [-1.0, 0.0, 0.999999, 1.0 - 3e-16, 1.0, 2.0, 3.0, 9.0]
    assert [held(t) for t in times] == [2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 4.0, 4.0]
    other = held.copy()
    held.cut(1.0)
    assert (held.changes, held(9.0)) == ([1.0], 3.0)
    held.cut(0.5)
    assert (held.changes, held(9.0)) == ([], 2.0)
    held.cut(-1.0)
    assert held(9.0) == 2.0
    assert [other(t) for t in times] == [2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 4.0, 4.0]


def test_runs_lag_where_their_next_step_is_due() -> None:
    runs = Runs(SimpleNamespace())  # type: ignore[arg-type]
    assert runs.beside is None
    ahead = SimpleNamespace(stepped=SimpleNamespace(alive=True, upcoming=2.0))
    behind = SimpleNamespace(stepped=SimpleNamespace(alive=True, upcoming=1.0))
    runs.every = [ahead, behind]
    assert (runs.first, runs.beside) == (ahead, behind)
    assert [runs.lag(time) for time in (0.9, 1.0, 1.5)] == [False, True, True]
    behind.stepped.alive = False
    assert [runs.lag(time) for time in (1.5, 2.0)] == [False, True]


def test_runs_show_time_outputs_and_what_is_drawn_of_controls() -> None:
    plan = SimpleNamespace(shown=["plant.b.fx"])
    runs = Runs(plan)  # type: ignore[arg-type]
    for key, closed in ((4, []), (9, [])):
        stepped = SimpleNamespace(
            alive=True, time=0.5 + key, row=lambda key=key: [0.5 + key, -1.0],
            close=lambda closed=closed: closed.append(True), save=lambda key=key: f"at {key}",
        )  # fmt: skip
        run = SimpleNamespace(
            key=key, stepped=stepped, driven={"plant.b.fx": lambda t: 10.0 * t}, closed=closed
        )
        runs.every.append(run)
    runs.show(1)
    assert {n: [list(row) for row in rows] for n, rows in runs.rows.items()} == {
        1: [[9.5, -1.0, 95.0]]
    }
    assert runs.save() == {4: "at 4", 9: "at 9"}
    runs.every[0].stepped.alive = False
    assert runs.save() == {9: "at 9"}
    first, beside = runs.every
    runs.leave_alone()
    assert (runs.every, first.closed, beside.closed) == ([first], [], [True])
    runs.close()
    assert (runs.every, first.closed) == ([], [True])


def plan_of_outputs(columns: dict[str, Any], **drawings: Any) -> Any:
    """A plan with nothing but outputs, as far as plots look at it; `columns`: by path."""
    system = SimpleNamespace(
        recorded=[tuple(name.split(".", 1)) for name in columns],
        drawings=lambda: drawings,
        variable=lambda port: SimpleNamespace(unit="m/s" if port[1].startswith("speed") else None),
    )
    seen = table({"time": np.arange(3.0), **columns})
    return SimpleNamespace(system=system, seen=seen, shown=[])


def test_of_what_nobody_knows_the_first_four_are_shown() -> None:
    columns = {f"engine.{name}": np.arange(3.0) for name in ("speed", "a", "b", "c", "d", "e")}
    plots = model._plots(plan_of_outputs(columns))
    assert [(plot["title"], plot["shown"]) for plot in plots] == [
        (name, number < 4) for number, name in enumerate(columns)
    ]
    assert [plot["unit"] for plot in plots] == ["m/s"] + [""] * 5
    assert [one["column"] for plot in plots for one in plot["series"]] == list(range(6))


def test_a_drawing_says_which_plots_are_shown_four_at_most_and_what_moves() -> None:
    rests, rises, sinks = [0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [3.0, np.nan, 2.0]
    columns = {"plant.rests": rests, "plant.rises": rises, "plant.held": [2.0] * 3,
               "plant.sinks": sinks}  # fmt: skip
    plots = (
        Plot("offered", ("held",), shown=False),
        *(Plot(name, (name,), moving=True) for name in ("rests", "rises", "sinks")),
        Plot("held", ("held",)),
    )
    drawing = Drawing(
        name="arm", plots=plots, units={"rests": "m", "rises": "m", "sinks": "m", "held": "m"}
    )
    found = {plot["title"]: plot for plot in model._plots(plan_of_outputs(columns, plant=drawing))}
    # four, counted with those that are offered only
    expected = {"offered": False, "rests": False, "rises": True, "sinks": True, "held": False}
    assert {title: plot["shown"] for title, plot in found.items()} == expected
    scales = {title: found[title]["series"][0]["scale"] for title in found if title != "offered"}
    # something that may move yet is written with decimals
    assert scales == {"rests": [0.0, 1.5], "rises": [0.0, 2.0], "held": [2.0, 2.0],
                      "sinks": [2.0, 3.0]}  # fmt: skip


def test_what_changes_is_recorded_as_a_table_and_the_rest_as_start_values(tmp_path: Path) -> None:
    names = ("b.fx", "b.fy", "n")
    driven = {
        f"plant.{name}": Driven(value, 0.0) for name, value in zip(names, (1, 3, 2), strict=True)
    }
    driven["plant.b.fx"].put(0.5, 2.0)
    driven["plant.b.fx"].put(0.75, 5.0)
    plant = SimpleNamespace(start={})
    scene = SimpleNamespace(
        start_time=0.0, stop_time=1.0, step=0.25, components={"plant": plant},
        inputs=dict.fromkeys(driven),
    )  # fmt: skip
    kinds = {"n": "Integer"}
    system = SimpleNamespace(
        stops=[], variable=lambda port: SimpleNamespace(kind=kinds.get(port[1], "Real"))
    )
    done: Any = recording._Done(scene, system, driven, np.zeros(0), [])  # type: ignore[arg-type]
    table = done._tables()
    assert table.dtype.names == ("time", "plant.b.fx")
    assert table["time"].tolist() == [0.0, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0]
    assert table["plant.b.fx"].tolist() == [1.0, 1.0, 1.0, 2.0, 2.0, 5.0, 5.0]
    assert plant.start == {"b.fy": 3.0, "n": 2}
    assert isinstance(plant.start["n"], int)
    assert list(scene.inputs) == ["plant.b.fx"]
    del driven["plant.b.fx"]
    scene.inputs = dict.fromkeys(driven)
    assert done._tables() is None
    assert scene.inputs == {}
    for file in ("a_1.csv", "a_2.py"):
        (tmp_path / file).write_text("")
    assert recording._free(tmp_path, "a").name == "a_3.py"
    assert recording._free(tmp_path, "b c").name == "b_c_1.py"

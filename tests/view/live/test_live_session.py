"""A live scene without its browser: real time, changes, going back, beside, recording."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from stepping import Page, opened

from curvebound.cosim import load_scene, read_csv, scene_names
from curvebound.cosim.instance import Instance
from curvebound.cosim.prepared import Prepared
from curvebound.cosim.scene_parts import Adaptive
from curvebound.view.live.model import describe
from curvebound.view.live.plan import Plan
from curvebound.view.live.recording import recording

PlanOf = Callable[[str], Plan]


@pytest.mark.parametrize("name", scene_names())
def test_it_steps_in_real_time_with_the_bits_of_a_run(
    plan_of: PlanOf, name: str, instances: list[Instance]
) -> None:
    plan = plan_of(name)
    json.dumps(describe(plan), allow_nan=False)
    with opened(plan) as page:
        page.send("play")
        page.pictures(31)
        assert page.session.reached == pytest.approx(0.5, abs=plan.scene.step * 1.01)
        page.send("pause")
        page.pictures(5)
        rows = {float(row[0]): row for row in page.rows[0]}
        stop = page.session.reached
    scene = plan.scene.copy()
    scene.record_every = 1
    with Prepared(scene) as prepared:
        data = prepared.run(stop_time=stop).data
    assert data["time"][-1] == stop
    found = [row for row in data.tolist() if row[0] in rows]
    assert len(found) == len(rows) > 20
    for row in found:
        assert np.array_equal(rows[row[0]], np.array([float(value) for value in row]))


@pytest.mark.parametrize("speed", [0.1, 0.5, 10.0])
def test_speed(plan_of: PlanOf, speed: float) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        page.send("speed", value=speed)
        page.send("play")
        page.pictures(121)
        assert page.session.reached == pytest.approx(2.0 * speed, abs=0.011)
        page.send("speed", value=1e6)
        page.send("speed", value=-1)
        assert page.session.pace.speed == 0.1


def test_single_steps_and_reset(plan_of: PlanOf) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        for _ in range(3):
            page.send("step")
        page.pictures()
        assert [row[0] for row in page.rows[0]] == [0.0, 0.01, 0.02, 0.03]
        page.send("reset")
        page.pictures()
        assert [row[0] for row in page.rows[0]] == [0.0]


def test_a_machine_that_is_too_slow_is_told_and_time_goes_slower(
    plan_of: PlanOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        stepped = page.session.first
        quick = stepped.step

        def slow() -> float:
            page.clock.now += 0.1
            return quick()

        monkeypatch.setattr(stepped, "step", slow)
        page.send("play")
        page.pictures(40)
        pace = [one for one in page.events if one["event"] == "pace"]
        assert all(one["late"] for one in pace)
        assert pace[-1]["speed"] == pytest.approx(0.01 / (0.1 + 1 / 60), rel=0.3)


def test_sliders_are_offered_as_declared(plan_of: PlanOf) -> None:
    plan = plan_of("inverted_balance")
    gain = plan.controls["drive.feedback.slider_u"]
    assert (gain.unit, gain.description, gain.value) == (
        "1/s2",
        "feedback gain of slider.u",
        -55.3053,
    )
    assert gain.low < -55.3053 < gain.high
    force = plan.controls["plant.slider.fx"]
    assert (force.unit, force.low, force.high, force.added) == ("N", -10.0, 10.0, False)
    assert plan.controls["plant.pendulum.fx"].added  # the scene's table is there already
    assert plan.controls["drive.waveform.kind"].items == {
        "none": 1,
        "sine": 2,
        "chirp": 3,
        "step": 4,
    }
    assert plan.controls["drive.limit.acceleration"].minimum == 0.0
    assert "plant.parabola.ax" not in plan.controls  # the drive's
    assert plan.settings["plant.slider.mass"].minimum == 0.0
    assert not plan.settings.keys() & plan.controls.keys()
    assert [grip.point for grip in plan.grips] == ["slider", "bob"]
    assert [grip.point for grip in plan_of("bead_on_wire").grips] == ["bead", "frame"]


def test_a_slider_acts_and_is_taken_back(plan_of: PlanOf) -> None:
    with opened(plan_of("pendulum_small")) as page:
        page.send("play")
        page.pictures(30)
        twin = page.session.reached
        page.send("set", path="plant.slider.fx", value=8)
        page.pictures(30)
        pushed = page.value("plant.slider.u")
        assert page.state["undo"] == 1
        assert page.state["values"]["plant.slider.fx"] == 8.0
        page.send("undo")
        page.pictures()
        assert page.state["values"]["plant.slider.fx"] == 0.0
        assert page.rows[0][-1][0] <= twin + 0.03
        page.pictures(29)
        free = page.value("plant.slider.u")
        assert abs(pushed - free) > 0.1
    with opened(plan_of("pendulum_small")) as page:
        page.send("play")
        page.pictures(59)
        while page.session.reached < twin + 0.45:
            page.pictures()
        end = page.rows[0][-1]
    with opened(plan_of("pendulum_small")) as page:
        page.send("play")
        page.pictures(10)
        page.send("set", path="plant.slider.fy", value=3)
        page.pictures(20)
        page.send("undo")
        while page.session.reached < end[0]:
            page.pictures()
        row = next(row for row in page.rows[0] if row[0] == end[0])
        assert np.array_equal(row, end), "as if the change had never been"


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("plant.nothing", 1, "nothing that can be changed"),
        ("plant.slider.mass", 1, "nothing that can be changed"),
        ("drive.limit.acceleration", -1, "outside its domain; at least 0"),
        ("drive.waveform.kind", 9, "no item"),
        ("drive.waveform.kind", 1.5, "no item"),
        ("plant.slider.fx", True, "no number"),
    ],
)
def test_values_outside_the_domain_are_refused(
    plan_of: PlanOf, path: str, value: float, said: str
) -> None:
    with opened(plan_of("inverted_balance")) as page:
        page.send("set", path=path, value=value)
        page.pictures()
        assert any(said in text for text in page.said("refused") + page.said("error"))
        assert page.state["undo"] == 0


def test_what_if_from_here(plan_of: PlanOf) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        page.send("back")
        page.send("play")
        page.pictures(30)
        page.send("mark")
        here = page.session.reached
        ends = []
        for force in (0.0, 5.0, 0.0):
            page.send("set", path="bead.bead.fx", value=force)
            page.pictures(1)
            while page.session.reached < here + 0.4:
                page.pictures()
            ends.append(next(row for row in page.rows[0] if row[0] >= here + 0.395))
            page.send("back")
            assert page.session.reached == here
        assert any("No state is marked" in text for text in page.said("error"))
        assert np.array_equal(ends[0], ends[2])
        assert not np.array_equal(ends[0], ends[1])


def test_the_page_is_told_what_acts(plan_of: PlanOf) -> None:
    """Sliders and springs together, from the communication point on from which they act."""
    with opened(plan_of("pendulum_small")) as page:
        bob = [grip.point for grip in page.session.plan.grips].index("bob")
        page.send("play")
        page.pictures(10)
        since = page.session.first.upcoming
        page.send("set", path="plant.pendulum.fx", value=3.0)
        page.pictures(10)
        forces = {row[0]: drawn["plant.pendulum.fx"] for row, drawn in
                  zip(page.rows[0], page.acting, strict=True)}  # fmt: skip
        assert len(forces) > 15
        for time, force in forces.items():
            assert force == (3.0 if time >= since else 0.0), time
        page.send("pull", grip=bob, x=1.0, y=1.0)
        page.pictures(10)
        driven = page.session.runs.first.driven
        assert page.acting[-1]["plant.pendulum.fy"] != 0.0
        for path, value in page.acting[-1].items():
            assert value == driven[path](page.rows[0][-1][0])


def test_a_body_follows_the_hand(plan_of: PlanOf) -> None:
    with opened(plan_of("pendulum_small")) as page:
        bob = [grip.point for grip in page.session.plan.grips].index("bob")
        page.send("play")
        for _ in range(240):
            page.send("pull", grip=bob, x=0.6, y=-0.4)
            page.pictures()
        # in the spring's pull, not exactly there: the bob has its weight
        assert abs(page.value("plant.pendulum.x") - 0.6) < 0.3
        assert page.session.runs.first.driven["plant.pendulum.fx"].held(page.session.reached) != 0.0
        page.send("release")
        page.pictures(3)
        assert page.session.runs.first.driven["plant.pendulum.fx"].held(page.session.reached) == 0.0
        assert page.state["undo"] == 1, "one pull is one change"
        page.send("pull", grip=99, x=0, y=0)
        page.send("pull", grip=0.5, x=0, y=0)
        page.pictures()
        assert len(page.said("refused")) == 2


@pytest.mark.parametrize("name", ["bead_on_wire", "shaken_wire"])
def test_a_frame_stays_where_it_was_put(plan_of: PlanOf, name: str) -> None:
    plan = plan_of(name)
    with opened(plan) as page:
        frame = [grip.point for grip in plan.grips].index("frame")
        page.send("play")
        for _ in range(180):
            page.send("pull", grip=frame, x=1.0, y=0.0)
            page.pictures()
        assert page.value("bead.wire.x") == pytest.approx(1.0, abs=0.02)
        page.send("release")
        page.pictures(60)
        at = page.value("bead.wire.x")
        assert abs(page.value("bead.wire.vx")) < 1e-12
        page.pictures(60)
        assert page.value("bead.wire.x") == pytest.approx(at, abs=1e-12)
        if name == "shaken_wire":  # the scene's own motion is as it was
            assert abs(page.value("bead.wire.y")) < 0.2
        changes = len(page.session.runs.first.driven["bead.wire.ax"].changes)
        page.pictures(60)
        assert len(page.session.runs.first.driven["bead.wire.ax"].changes) == changes


def test_a_variant_beside(plan_of: PlanOf, instances: list[Instance]) -> None:
    with opened(plan_of("pumped_swing")) as page:
        page.send("play")
        page.pictures(60)
        page.send("set", path="plant.slider.fx", value=1)
        page.pictures(20)
        page.send("variant", name="detuned")
        page.pictures(5)
        assert page.rows[1][0][0] < 0.1, "its past is computed anew"
        assert page.rows[1][-1][0] == page.rows[0][-1][0]
        page.pictures(60)
        assert page.rows[1][-1][0] == page.rows[0][-1][0]
        assert page.value("plant.slider.u", 1) != page.value("plant.slider.u", 0)
        last = page.rows[0][-1]
        page.send("undo")
        page.pictures(3)
        assert page.rows[1][-1][0] == page.rows[0][-1][0] < last[0]
        page.send("alone")
        page.pictures(3)
        page.send("variant", name="nothing")
        page.pictures()
        assert "no variant" in page.said("error")[-1]


def test_the_same_again_beside_has_the_same_bits(plan_of: PlanOf) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        page.send("play")
        page.pictures(30)
        for x in (0.2, 0.5, 0.9):
            page.send("pull", grip=0, x=x, y=0)
            page.pictures(5)
        page.send("beside", label="twin", settings={})
        page.pictures(40)
        for one, other in zip(page.rows[0][-30:], page.rows[1][-30:], strict=True):
            assert np.array_equal(one, other)


def test_settings_restart_and_what_fails_changes_nothing(plan_of: PlanOf) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        page.send("play")
        page.pictures(10)
        settings = {
            "bead.bead.angle_start": "90deg / 2",
            "bead.solver.method": "implicit",
            "step": 0.02,
        }
        page.send("restart", settings=settings)
        page.pictures(10)
        assert page.rows[0][0][0] == 0.0
        assert page.rows[0][0][1 + page.session.first.columns.index("bead.bead.angle")] == (
            pytest.approx(math.pi / 4)
        )
        assert page.rows[0][1][0] == 0.02
        before = page.session.first
        for wrong in (
            {"bead.bead.mass": -1},
            {"bead.bead.mass": "heavy"},
            {"bead.nothing": 1},
            {"step": 0},
            {"algorithm": "guess"},
            {"bead.solver.method": "exact"},
        ):
            page.send("restart", settings=wrong)
            page.pictures(2)
            assert page.session.first is before
        assert len(page.said("error")) == 6
        page.send("original")
        page.pictures(2)
        assert page.session.runs.first.settings == {}


def test_a_step_that_fails_is_said_and_undone(plan_of: PlanOf) -> None:
    with opened(plan_of("swaying_parabola")) as page:
        page.send("play")
        page.pictures(30)
        page.send("set", path="drive.waveform.duration", value=0)  # not below its minimum, but out
        page.pictures(10)
        assert "waveform.duration" in page.said("error")[-1]
        assert not page.state["alive"]
        assert not page.state["playing"]
        page.send("play")
        page.send("step")
        page.pictures(3)
        page.send("undo")
        page.pictures(10)
        assert page.state["alive"]
        page.send("play")
        page.pictures(30)
        assert page.session.reached > 0.9
        rows = [row[0] for row in page.rows[0]]
        assert rows == sorted(set(rows))


def done(page: Page, bob: int) -> None:
    """Some of everything that can be done."""
    page.send("play")
    page.pictures(20)
    page.send("set", path="plant.slider.fx", value=2.5)
    page.pictures(10)
    for k in range(25):
        page.send("pull", grip=bob, x=0.3 + 0.02 * k, y=0.1 * math.sin(k))
        page.pictures()
    page.send("release")
    page.pictures(10)
    page.send("set", path="plant.slider.fx", value=-1)
    page.pictures(10)
    page.send("undo")
    page.send("set", path="drive.waveform.frequency", value=0.5)
    page.pictures(20)


@pytest.mark.parametrize(
    ("algorithm", "hold"),
    [
        ("strang", "zero"),
        ("midpoint", "zero"),
        ("jacobi", "first"),
        pytest.param("gauss_seidel", "zero", marks=pytest.mark.slow),
        pytest.param("gauss_seidel", "first", marks=pytest.mark.slow),
        pytest.param("jacobi", "zero", marks=pytest.mark.slow),
    ],
)
def test_a_recording_replays_bit_for_bit(tmp_path: Path, algorithm: str, hold: str) -> None:
    scene = load_scene("swaying_parabola")
    scene.algorithm = algorithm
    scene.hold = hold
    plan = Plan(scene)
    with opened(plan) as page:
        bob = [grip.point for grip in plan.grips].index("bob")
        page.session.do_restart({"plant.slider.mass": "2"})
        page.pictures()
        done(page, bob)
        page.send("beside", label="light", settings={"plant.pendulum.length": 0.5})
        page.pictures(3)
        page.send("pause")
        page.pictures(2)
        saved = recording(page.session.runs, tmp_path)()
        assert saved.exact
        assert saved.scene == tmp_path / "swaying_parabola_live_1.py"
        table = read_csv(saved.result)
        rows = {row[0]: row for row in page.rows[0]}
        names = page.session.first.columns
        assert len(table) >= len(rows) > 90
        for row in table:
            if row["time"] in rows:
                expected = rows[row["time"]]
                assert np.array_equal([float(row[name]) for name in names], expected[1:])
        again = load_scene(saved.scene).with_variant("light").run()
        found = [float(again[name][-1]) for name in names]
        assert np.array_equal(found, page.rows[1][-1][1:])
        assert recording(page.session.runs, tmp_path)().scene.name == "swaying_parabola_live_2.py"


@pytest.mark.parametrize(
    "name",
    ["inverted_balance", "shaken_wire", pytest.param("vibrated_upright", marks=pytest.mark.slow)],
)
def test_what_the_scene_drives_is_recorded_too(plan_of: PlanOf, name: str, tmp_path: Path) -> None:
    plan = plan_of(name)
    grip = plan.grips[-1]
    with opened(plan) as page:
        page.send("speed", value=4)
        page.send("play")
        page.pictures(20)
        for _ in range(60):
            x, y = (page.value(f"{grip.component}.{name}") for name in grip.position)
            page.send("pull", grip=len(plan.grips) - 1, x=x + 0.02, y=y)
            page.pictures()
        page.send("release")
        page.pictures(30)
        saved = recording(page.session.runs, tmp_path)()
        assert saved.exact
        assert len(read_csv(saved.result)) > 100


def test_a_hand_has_its_limit(plan_of: PlanOf) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        page.send("play")
        page.send("pull", grip=0, x=1e6, y=1e9)
        page.pictures(20)
        driven = page.session.runs.first.driven
        held = [driven[f"bead.bead.{name}"].held(1e9) for name in ("fx", "fy")]
        assert math.hypot(*held) == pytest.approx(50.0)  # N on 1 kg
        assert page.state["alive"]


def test_nothing_to_record_is_said(plan_of: PlanOf, tmp_path: Path) -> None:
    with (
        opened(plan_of("bead_on_wire")) as page,
        pytest.raises(Exception, match="Nothing has moved"),
    ):
        recording(page.session.runs, tmp_path)


def test_an_hour_of_changes_keeps_little(plan_of: PlanOf) -> None:
    with opened(plan_of("bead_on_wire")) as page:
        page.send("play")
        for k in range(60):
            page.clock.now += 1.0
            page.session._anew()
            page.send("set", path="bead.bead.fx", value=k % 7)
            page.pictures(2)
        assert page.state["undo"] == 20
        kept = page.session.first._instances["bead"]._saved
        assert len(kept) <= 20


def test_macro_steps_that_a_scene_chooses_itself_are_told(plan_of: PlanOf) -> None:
    scene = load_scene("bead_on_wire")
    scene.adaptive = Adaptive(1e-6)
    plan = Plan(scene)
    told = f"The scene chooses its macro steps; here they are all of its step, {scene.step:g} s."
    assert plan.notes == [told]
    assert plan.scene.adaptive is None
    assert scene.adaptive is not None
    assert plan_of("bead_on_wire").notes == []
